"""What pyproject.toml asks for is imported somewhere, and every import is asked for."""

import ast
import re
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest
from syntax_trees import parsed, syntax_trees

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
#: distribution -> module, where the two have other names
MODULES = {
    "myst-parser": "myst_parser",
    "numba-cuda": "numba_cuda",
    "scikit-learn": "sklearn",
}
#: tools that are run, not imported
TOOLS = {"import-linter", "mypy", "pytest-xdist", "ruff", "scipy-stubs"}
#: what another library is asked for by a text: themes and readers of sphinx
NAMED = {"furo", "myst-parser", "sphinx"}


def names(requirements):
    """Distributions of a list of requirements, without versions and extras."""
    distributions = [re.match(r"[A-Za-z0-9-]+", r)[0] for r in requirements]
    return {n for n in distributions if n != PROJECT["name"]}


def imported(trees):
    """Top-level modules that these syntax trees import, by name or by import_module."""
    modules = set()
    for tree in trees:
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                modules |= {a.name for a in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                modules.add(node.module)
            elif isinstance(node, ast.Call) and node.args:
                first = node.args[0]
                if isinstance(first, ast.Constant) and isinstance(first.value, str):
                    name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                    if name in ("import_module", "find_spec", "importorskip"):
                        modules.add(first.value)
    return {name.partition(".")[0] for name in modules}


# read when a test asks, not when tests are collected: every process of a run collects
@cache
def imported_by_the_package():
    return imported(syntax_trees().values())


@cache
def imported_anywhere():
    beside = (parsed(ROOT / folder) for folder in ("studies", "tests", "docs", "benchmarks"))
    return imported_by_the_package().union(*(imported(trees.values()) for trees in beside))


CORE = names(PROJECT["dependencies"])
EXTRAS = {extra: names(wanted) for extra, wanted in PROJECT["optional-dependencies"].items()}


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(CORE))
def test_a_core_dependency_is_imported_by_the_package(name):
    assert MODULES.get(name, name) in imported_by_the_package()


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set().union(*EXTRAS.values()) - TOOLS - NAMED))
def test_a_dependency_of_an_extra_is_imported_somewhere(name):
    assert MODULES.get(name, name) in imported_anywhere()


@pytest.mark.slow
def test_the_package_imports_only_what_it_asks_for():
    modules = {MODULES.get(n, n) for n in CORE.union(*EXTRAS.values())}
    # markupsafe comes with jinja2, whose documentation says to import it from there; llvmlite with
    # numba, in the one version that it works with
    known = {*modules, *sys.stdlib_module_names, "teleopdesign", "markupsafe", "llvmlite"}
    assert known >= imported_by_the_package()
