"""A user's control law, from its file to a diagram, a file of the diagram, claims and commands."""

import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError, ModelError
from teleopdesign.cli import main
from teleopdesign.controllers import catalogue, controller, load_controller

FILE = '''"""A sign function with a round edge."""

import sympy as sp

from teleopdesign.controllers import ControlLaw, ControllerState
from teleopdesign.effects import Parameter


def law(now, p):
    return p.level * now.velocity / sp.sqrt(p.edge**2 + now.speed**2)


CONTROLLER = ControlLaw(
    law=law,
    linear=True,
    bound="level",
    parameters={"level": Parameter("force", "F"), "edge": Parameter("velocity", "v")},
)
'''
VALUES = {"level": 0.4, "edge": 0.02}


@pytest.fixture
def law_file(tmp_path):
    path = tmp_path / "round_edge.py"
    path.write_text(FILE)
    return path


@pytest.fixture
def loop(law_file):
    rod = td.Body("prismatic", {"inertia": 0.15})
    rod = rod.with_effect(td.EFFECTS["coulomb"], {"level": 0.5})
    hand = td.Body("prismatic", {"inertia": 0.2})
    hand = hand.with_effect(td.EFFECTS["viscous"], {"damping": 4.0})
    return td.haptic_interface(
        rod, hand=hand, cancellation=controller(load_controller(law_file), VALUES)
    )


@pytest.fixture
def diagram_file(loop, law_file, tmp_path):
    path = tmp_path / "mine.toml"
    td.write_diagram(loop, path, laws=catalogue([law_file]))
    return path


def test_a_diagram_in_a_file_is_the_same_where_the_reader_knows_its_law(
    loop, law_file, diagram_file
):
    assert td.read_diagram(diagram_file, laws=catalogue([law_file])) == loop
    assert "sqrt" not in diagram_file.read_text()  # a file names laws and holds no code


def test_a_law_that_the_reader_does_not_know_is_refused_and_not_run(diagram_file, law_file):
    law_file.write_text("raise SystemExit('it ran')\n")
    with pytest.raises(ExperimentError, match=r"blocks\.C\.law: found .round_edge., expected"):
        td.read_diagram(diagram_file)


def test_another_law_of_that_name_is_not_written(loop, law_file, tmp_path):
    law_file.write_text(FILE.replace("0.4", "0.5") + "\n# changed\n")
    with pytest.raises(ModelError, match='C: law "round_edge" is none of the package: name your'):
        td.write_diagram(loop, tmp_path / "other.toml", laws=catalogue([law_file]))


def test_the_file_of_a_user_counts_before_a_law_of_that_name_in_the_package(tmp_path):
    path = tmp_path / "coulomb.py"
    path.write_text(FILE)
    assert catalogue([path])["coulomb"] is load_controller(path)
    assert catalogue()["coulomb"] is td.CONTROLLERS["coulomb"]


@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        (("now.speed", "now.sped"), 'law: now has no "sped"; did you mean "speed"'),
        (("p.edge", "p.edgy"), 'law: p has no "edgy"; did you mean "edge"'),
        (("p.edge", "sp.Symbol('k')"), "law uses k"),
        (("now.speed**2", "now.velocity**2"), "declares linear = True, but is not linear"),
        (("p.level * now", "1 / 0 * now"), "law: ZeroDivisionError"),
        (('{"level":', '{"now x":'), "now x"),
    ],
    ids=["signal", "parameter", "stranger", "linear", "raises", "name"],
)
def test_a_wrong_law_is_one_line_with_its_file(law_file, wrong, line):
    law_file.write_text(FILE.replace(*wrong).replace('bound="level",', ""))
    with pytest.raises(ModelError, match="round_edge.py: ") as caught:
        load_controller(law_file)
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)


def test_commands_read_the_law_from_its_file(diagram_file, law_file, tmp_path, capsys):
    law, out = ["--law", str(law_file)], tmp_path / "t.json"
    assert main(["derive", str(diagram_file), "--speed", "0.02", "--json", str(out), *law]) == 0
    assert main(["passivity", str(diagram_file), *law]) == 0
    assert "any compensator within 0.4 N is passive" in capsys.readouterr().out
    assert main(["passivity", str(diagram_file)]) == 2
    assert 'found "round_edge"' in capsys.readouterr().err
