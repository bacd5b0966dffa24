"""Robots' descriptions, studies, their results, simulators' files and completions run nothing."""

import argparse
import re
import resource
import subprocess
import sys
import xml.etree.ElementTree as ET

import h5py
import pytest
from clock import in_time
from security.diagram_file import one_line
from security.hostile import CODE, MARK, pairs, quoted

from teleopdesign.arms import read_urdf
from teleopdesign.base.errors import ExperimentError, TeleopDesignError
from teleopdesign.commands.completion import say_what_follows
from teleopdesign.model import Model
from teleopdesign.studies import read_study, read_study_file

ROBOT = """<robot name={robot}>
 <link name={base}/>
 <link name={tip}><inertial><mass value={mass}/><origin xyz={place}/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
 <joint name={joint} type={kind}><parent link={base}/><child link={tip}/><axis xyz={axis}/></joint>
</robot>"""
GOOD = {
    "robot": "r",
    "base": "b",
    "tip": "t",
    "mass": "1",
    "place": "0 0 1",
    "joint": "j",
    "kind": "revolute",
    "axis": "0 0 1",
}
PRINTED = [t for t in CODE if t and t.isprintable()][::2]


def robot(**changed):
    words = {k: ET.Element("x", v=v) for k, v in {**GOOD, **changed}.items()}
    quotes = {k: ET.tostring(e, encoding="unicode")[5:-3] for k, e in words.items()}
    return ROBOT.format(**quotes)


@pytest.mark.parametrize(("place", "text"), pairs(GOOD, PRINTED))
def test_a_word_of_a_robot_is_a_text_or_refused_in_one_line(guard, tmp_path, place, text):
    path = tmp_path / "r.urdf"
    path.write_text(robot(**{place: text}), encoding="utf-8")
    joint = text if place == "joint" else "j"
    with in_time():
        try:
            chain = read_urdf(path, "r.urdf", [joint])
        except ExperimentError as error:
            assert one_line(error).startswith("r.urdf: ")
        else:
            assert place in ("robot", "base", "tip", "joint") and len(chain.links) == 1


ENTITIES = (
    "<!DOCTYPE r [" + "".join(f'<!ENTITY e{k + 1} "{f"&e{k};" * 10}">' for k in range(9)) + "]>"
)
BOMBS = {
    "entities": '<?xml version="1.0"?>' + ENTITIES + "<robot>&e9;</robot>",
    "a file": '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="&x;"/>',
    "a parameter": '<!DOCTYPE r [<!ENTITY % p SYSTEM "http://localhost/x">%p;]><robot/>',
    "another robot": '<robot xmlns:xi="http://www.w3.org/2001/XInclude">'
    '<xi:include href="/etc/passwd" parse="text"/></robot>',
    "a macro": '<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:property name="x" '
    f'value="${{__import__(\'os\').system(\'touch {MARK}\')}}"/></robot>',
    "deep": "<robot>" + "<a>" * 14_000 + "</a>" * 14_000 + "</robot>",
    "wide": "<robot>" + "<link/>" * 14_000 + "</robot>",
    "attributes": "<robot " + " ".join(f'a{k}=""' for k in range(11_000)) + "/>",
    "long": f'<robot name="{"x" * 99_000}"/>',
    "an instruction": f'<?xml-stylesheet href="$(touch {MARK})"?><robot/>',
    "joints": "<robot>" + "".join(
        f'<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="l{k}"/>'
        f'<child link="l{k + 1}"/></joint>' for k in range(900)
    ) + '<link name="l900"/></robot>',
}  # fmt: skip


@pytest.mark.parametrize("name", BOMBS)
def test_a_robot_of_a_hundred_kilobytes_takes_neither_time_nor_memory(guard, tmp_path, name):
    path = tmp_path / "r.urdf"
    path.write_text(BOMBS[name])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with in_time(), pytest.raises(ExperimentError) as caught:
        read_urdf(path, "r.urdf", ["j"])
    one_line(caught.value)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < before + 1e6  # kB


STUDY = """[study]
model = "d.toml"
[axes]
"M.inertia" = { from = 0.2, to = 1.2, points = 3, scale = "linear" }
[simulation]
duration = 0.2
computer = "continuous"
[measures]
hand = { measure = "peak", signal = "x" }
"""
ENTRIES = ('"d.toml"', '"M.inertia"', "0.2,", "1.2", "3,", '"linear"', "= 0.2\n", '"continuous"',
           "hand", '"peak"', '"x"')  # fmt: skip


@pytest.mark.parametrize(("entry", "text"), pairs(ENTRIES, CODE[:14]))
def test_an_entry_of_a_study_is_refused_in_one_line(guard, tmp_path, capsys, entry, text):
    from security.diagram_file import diagram_file

    (tmp_path / "d.toml").write_text(diagram_file())
    path = tmp_path / "s.toml"
    end = entry[-1] if entry[-1] in ",\n" else ""
    start = "= " if entry.startswith("= ") else ""
    spoilt = STUDY.replace(entry, start + quoted(text) + end, 1)
    assert spoilt != STUDY
    path.write_text(spoilt, encoding="utf-8")
    with in_time():
        try:
            read_study_file(path)
        except TeleopDesignError as error:
            one_line(error)
        else:  # a name is a text as good as any until it is looked for in the diagram
            assert entry in ('"M.inertia"', "hand", '"x"', '"continuous"')


LARGE = {
    "points": STUDY.replace("points = 3", "points = 1_000_000_000_000"),
    "values": STUDY.replace(STUDY.split("= ", 2)[2].split("\n")[0], str([0.1] * 10_000)),
    "axes": STUDY.replace("[simulation]", "".join(f'"a{k}.b" = [1, 2]\n' for k in range(4000))
                          + "[simulation]"),
    "nested": "[study]\nmodel = " + "[" * 40_000 + "]" * 40_000,
    "number": STUDY.replace("0.2,", "9" * 90_000 + ","),
    "folders": STUDY.replace('"d.toml"', quoted("**/" * 3000 + "*")),
}  # fmt: skip


@pytest.mark.parametrize("name", LARGE)
def test_a_study_of_a_hundred_kilobytes_is_read_or_refused_at_once(guard, tmp_path, name):
    path = tmp_path / "s.toml"
    path.write_text(LARGE[name])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with in_time(), pytest.raises(TeleopDesignError) as caught:
        read_study_file(path)
    one_line(caught.value)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < before + 1e6


@pytest.fixture
def guard_of_results(guard, monkeypatch):
    """The guard; the process that reads a file first is not started, and what it would run is ours.

    Nothing of a file but its path goes to that process.
    """

    def run(command, **options):
        program, flag, code, _ = command
        assert (program, flag) == (sys.executable, "-c") and not options.get("shell")
        assert code.startswith("\nimport sys, h5py\n") and MARK not in code
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(subprocess, "run", run)
    return guard


def result_file(path, size=3, **attributes):
    h5netcdf = pytest.importorskip("h5netcdf")
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"x": size}
        chunks = (min(size, 10**6),)
        for name in ("x", "failure"):
            file.create_variable(name, ("x",), "f8", chunks=chunks)
        file.attrs.update({"study": "1", "model": "m", "axes": '["x"]', **attributes})
    return path


@pytest.mark.parametrize(
    ("key", "text"),
    pairs(
        ("axes", "study", "model", "units", "coordinates", "calendar"),
        [t for t in CODE if "\x07" not in t][:14],
    ),
)
def test_an_attribute_of_a_result_is_a_text(guard_of_results, tmp_path, key, text):
    path = result_file(tmp_path / "s.nc", **{key: text})
    with in_time():
        try:
            study = read_study(path)
        except ExperimentError as error:
            assert key == "axes" and one_line(error)
        else:
            assert study.axes == ("x",) and repr(study) and study.data.attrs.get(key, text) == text


def test_a_result_that_says_more_than_it_holds_is_refused_before_it_is_read(tmp_path):
    """Blocks that were never written take six kilobytes for eighty gigabytes."""
    path = result_file(tmp_path / "s.nc", size=10**10)
    assert path.stat().st_size < 1e5
    with in_time(), pytest.raises(ExperimentError, match="found 1.6e.11 bytes of data"):
        read_study(path)


def test_objects_in_a_result_are_never_unpickled(guard_of_results, tmp_path):
    path = result_file(tmp_path / "s.nc")
    with h5py.File(path, "a") as file:
        file.attrs["axes"] = "cos\nsystem\n(S'touch x'\ntR."
    with in_time(), pytest.raises(ExperimentError, match="axes: expected a list"):
        read_study(path)


@pytest.mark.parametrize("form", ["mjcf", "urdf"])
@pytest.mark.parametrize("text", PRINTED, ids=range(len(PRINTED)))
def test_a_name_in_a_simulators_file_stays_a_name(guard, tmp_path, form, text):
    from measurement.rod_example import write_rod

    from teleopdesign.measurement import load_experiment
    from teleopdesign.realise.simulator_files import FORMS, as_simulator_file

    model = Model.from_experiment(load_experiment(write_rod(tmp_path / "rod")))
    assert form in FORMS
    content = as_simulator_file(model, form, name=text).text
    root = ET.fromstring(content)
    assert text in root.attrib.values()
    assert not [e.tag for e in root.iter() if MARK in str(e.tag)]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
@pytest.mark.parametrize("text", PRINTED, ids=range(len(PRINTED)))
def test_a_help_text_in_a_completion_is_quoted(guard, shell, text):
    """Names of effects are checked where they are read; a help text may hold anything."""
    shtab = pytest.importorskip("shtab")
    parser = argparse.ArgumentParser(prog="teleopdesign")
    command = parser.add_subparsers().add_parser("diagnose", help=text.replace("%", "%%"))
    command.add_argument("--only", choices=("coulomb",), help=text.replace("%", "%%"))
    say_what_follows(parser, ("coulomb",))
    script = shtab.complete(parser, shell)
    outside = _outside_quotes(script)
    assert f"touch {MARK}" not in outside, script


def _outside_quotes(script):
    """What a shell would run: all but single quotes, and double ones that expand nothing."""
    inert = r"""'[^']*'|"(?:[^"`\\$]|\\.|\$(?!\())*"|^\s*#.*$"""
    return re.sub(inert, "", script, flags=re.M)
