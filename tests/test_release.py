"""What a release states in several files is the same in all of them."""

import importlib.util
import re
import tomllib
from pathlib import Path

import pytest

import teleopdesign

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
WORKFLOW = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def dependencies():
    """The script that writes what the package stands on."""
    path = ROOT / "release" / "dependencies.py"
    spec = importlib.util.spec_from_file_location("dependencies", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def pinned(name):
    lines = (ROOT / "release" / name).read_text(encoding="utf-8").splitlines()
    return dict(line.split("==") for line in lines if "==" in line and not line.startswith("#"))


def test_the_version_is_the_same_everywhere():
    version = PROJECT["version"]
    cited = re.search(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text(), re.M)[1]
    newest = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)[1]
    assert {version, cited, teleopdesign.__version__} == {version}
    assert newest in (version, "Unreleased")


def test_the_lowest_versions_are_those_that_are_declared(dependencies):
    assert (ROOT / "release" / "lowest.txt").read_text(encoding="utf-8") == dependencies.lowest()


def test_every_dependency_has_a_lowest_version(dependencies):
    core = {re.match(r"[A-Za-z0-9_.-]+", p)[0] for p in PROJECT["dependencies"]}
    assert core <= set(dependencies.bounds())


def test_the_versions_of_development_meet_the_declared_bounds(dependencies):
    from packaging.utils import canonicalize_name
    from packaging.version import Version

    locked = pinned("lock.txt")
    for name, lowest in dependencies.bounds().items():
        assert Version(locked[canonicalize_name(name)]) >= Version(lowest), name


def test_the_licence_of_every_dependency_that_users_install_is_listed(dependencies):
    page = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^\| ([a-z0-9-]+) \| \d", page, re.M))
    from packaging.utils import canonicalize_name

    assert {canonicalize_name(n) for n in dependencies.bounds()} <= listed
    assert "not stated" not in page


def test_the_workflow_runs_what_must_hold_on_every_declared_python():
    assert "- run: .ci/run\n" in WORKFLOW
    declared = {c[-4:] for c in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", c)}
    assert declared == set(re.findall(r'"(3\.\d+)"', WORKFLOW))
    make = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"- run: make (\w+)", WORKFLOW):
        assert re.search(rf"^{target}:", make, re.M), target


def test_the_paper_cites_what_its_bibliography_has():
    paper = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    known = set(re.findall(r"^@\w+\{(\w+),", (ROOT / "paper" / "paper.bib").read_text(), re.M))
    cited = set(re.findall(r"@([A-Za-z]\w+)", paper.partition("\n---\n")[2]))
    assert cited == known
