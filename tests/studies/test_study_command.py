"""`teleopdesign study`: a study from a TOML or a Python file, and one line for what is wrong."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.cli import main
from teleopdesign.studies import from_toml, read_study, read_study_file

DIAGRAM = """
[diagram]
kind = "haptic interface"
[blocks.Z_M]
axis = "prismatic"
inertia = 0.15
effects.coulomb.level = 1.0
effects.viscous.damping = 1.0
[blocks.C]
law = "dahl"
parameters = { level = 0.8, stiffness = 2e4 }
"""


def made_short(example):
    """The example of the docstring, on the diagram above, with fewer points and less time."""
    for old, new in (
        (
            '"late.toml"                 # a diagram\'s file, or a shipped diagram',
            '"interface.toml"',
        ),
        ("points = 6", "points = 3"),
        ("duration = 2.0", "duration = 0.2"),
        ("frequency = 2.0", "frequency = 5.0"),
    ):
        assert example.count(old) == 1, old
        example = example.replace(old, new)
    return example


STUDY = made_short(from_toml.__doc__.partition("\n\n")[2])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "interface.toml").write_text(DIAGRAM)
    (tmp_path / "s.toml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_toml_study_is_the_study_of_its_diagram(folder, capsys):
    assert main(["study", "s.toml", "--workers", "1", "--out", "s.nc", "--figure", "s.png"]) == 0
    output = capsys.readouterr()
    assert "3 C.dahl.level x 2 computer.delay" in output.out
    assert "6 of 6 points" in output.err
    direct = td.study(
        td.read_diagram("interface.toml"),
        {"C.dahl.level": np.linspace(0.2, 1.2, 3), "computer.delay": [0.0, 1e-3]},
        measures={"force_error": "force_error", "hand": td.measure("peak", signal="R_M")},
        duration=0.2,
        motion={"L": td.sine(amplitude=0.01, frequency=5.0)},
    )
    dataset = read_study("s.nc")
    for name in ("force_error", "hand"):
        np.testing.assert_array_equal(dataset[name].values, direct[name].values)
    assert (folder / "s.png").stat().st_size > 10_000


def test_samples_computer_inputs_and_states_come_from_the_file_too(folder):
    text = STUDY.replace('"computer.delay" = [0, 1e-3]', '"Z_M.inertia" = 0.2')
    text = text.replace("motion.L = { amplitude = 0.01, frequency = 5.0 }", "")
    text = text.replace("duration = 0.2", "duration = 0.1\ncomputer = { period = 5e-4 }")
    text += """
[simulation.inputs]
R_V = { amplitude = 2.0, frequency = 3.0, offset = 0.5 }
R_D = 0.1
[simulation.initial]
L = 1e-3
[samples]
method = "sobol"
points = 4
seed = 7
[samples.ranges]
"Z_M.coulomb.level" = { mean = 1.0, standard_deviation = 0.1 }
"C.dahl.stiffness" = { from = 1e3, to = 1e5, scale = "log" }
"computer.delay" = { from = 0, to = 1e-3, step = 5e-4 }
"""
    (folder / "s.toml").write_text(text)
    settings = read_study_file("s.toml")
    assert settings["computer"] == td.Sampling(period=5e-4)
    assert settings["inputs"]["R_V"](np.array([0.0, 1 / 12])) == pytest.approx([0.5, 2.5])
    dataset = td.study(**{**settings, "measures": {"x": td.measure("peak", signal="L")}}, workers=1)
    assert dataset["x"].dims == ("C.dahl.level", "sample")
    assert not dataset.failures
    assert set(np.round(dataset["computer.delay"].values / 5e-4)) <= {0, 1, 2}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[study]", "[stdy]", 'unknown key "stdy".*did you mean "study"'),
        ('model = "interface.toml"', "", "expected model .* or experiments"),
        ("interface.toml", "absent.toml", "absent.toml: cannot be read"),
        ('model = "interface.toml"', 'experiments = ["none"]', "no folder with an experiment.toml"),
        ("C.dahl.level", "C.dahl.levl", 'did you mean "C.dahl.level"'),
        ("points = 3", "points = 1.5", "found 1.5, expected a whole number"),
        ("from = 0.2", 'from = 0, scale = "log"', "log scale needs from and to above 0"),
        ("[0, 1e-3]", "[]", "axes.computer.delay: found a list, expected numbers"),
        ("duration = 0.2", "duration = 0", "expected a finite number above 0"),
        ("force_error = {}", "force_eror = {}", 'did you mean "force_error"'),
        ("[measures]", "[measures", "not valid TOML"),
        ("[measures]\nforce_error = {}", "[measures]\nforce_error = 1", "expected a table"),
    ],
)
def test_a_bad_toml_study_is_one_line_and_status_two(folder, capsys, old, new, message):
    import re

    assert old in STUDY
    (folder / "s.toml").write_text(STUDY.replace(old, new))
    status = main(["study", "s.toml", "--workers", "1"])
    out, error = capsys.readouterr()
    if status == 0:  # what only a simulation can know is a reason of its points
        error = out
    else:
        assert status == 2 and error.count("\n") == 1
        assert error.startswith("teleopdesign: ")
    assert re.search(message, error), error
