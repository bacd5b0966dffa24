"""Diagrams as TOML: what is written is read as the same, and a mistake is told in one line."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from diagrams.random_diagrams import diagrams
from diagrams.several_axes import two_armed_teleoperator, two_rods
from hypothesis import assume, given, settings

from teleopdesign.base.errors import ExperimentError, ModelError
from teleopdesign.blocks import CONTACT
from teleopdesign.cli import main
from teleopdesign.controllers import from_control
from teleopdesign.diagrams import (
    ANY,
    SHIPPED,
    Diagram,
    Junction,
    Moving,
    haptic_interface,
    load_shipped,
    position_symbol,
    read_diagram,
    write_diagram,
)
from teleopdesign.diagrams.toml_writing import diagram_text
from teleopdesign.effects import EFFECTS, catalogue

FREE = """\
[diagram]
name = "one body on a spring"
measured = ["x"]

[outside]
f = "force"

[blocks.M]
kind = "moving"
motion = "x"
command = "u"
loads = { f = 1, f_k = 1 }
driver = "f"
axis = "prismatic"
inertia = { value = 150, unit = "g" }
[blocks.M.effects.coulomb]
level = 0.5

[blocks.Z]
kind = "attached"
motion = "x"
force = "f_k"

[blocks.C]
kind = "control"
input = "x"
output = "u"
motion = "x"
law = "smoothed_coulomb"
parameters = { level = 0.5, smoothing_velocity = 0.01 }
"""
JOINED = """\
[diagram]
name = "a crank that two hands hold"
measured = ["q"]

[outside]
f = "force"

[blocks.M]
kind = "moving"
motion = "q"
command = "u"
loads = { t = 1 }
driver = "f"
axis = "revolute"
inertia = 0.02
[blocks.M.effects.environment]
stiffness = 500
damping = 1
contact_position = 0.3

[blocks.Z]
kind = "linked"
motions = ["x", "y"]
forces = ["f_x", "f_y"]
stiffness = [[300, -40], [-40, 200]]

[kinematics]
x = "0.1*cos(q)"
y = { expression = "0.1*sin(q)", axis = "prismatic" }

[junctions]
u = {}
t = { f = 1, f_x = "-0.1*sin(q)", f_y = "0.1*cos(q)" }

[pose]
q = 0.4
"""
WRITTEN_OUT = ("admittance-device", "four-channel", "wave-variables")
SHORT = """\
[diagram]
kind = "haptic interface"

[blocks.Z_M]
axis = "prismatic"
inertia = 0.15
[blocks.Z_M.effects.viscous]
damping = 2.0

[blocks.Z_H]

[blocks.H]
analog = true
[[blocks.H.series]]
law = "velocity_schedule"
parameters = { gain = 5, scheduling_velocity = 0.08 }
[[blocks.H.series]]
law = "low_pass"
parameters = { bandwidth = 20 }
"""


@pytest.fixture
def reading(tmp_path):
    """Reads a text as a diagram."""

    def read(text):
        file = tmp_path / "loop.toml"
        file.write_text(text, encoding="utf-8")
        return read_diagram(file)

    return read


# 25 wirings: every part and most forms of weights occur
@pytest.mark.slow
@settings(max_examples=25)
@given(diagram=diagrams(geometry=True))
def test_what_is_written_is_read_as_the_same_diagram(tmp_path_factory, diagram):
    file = tmp_path_factory.getbasetemp() / "random.toml"
    try:
        write_diagram(diagram, file)
    except (
        ModelError
    ) as error:  # such as 1/(3 (pi - 0.785)), whose factors are read in another order
        assert "has no form in a file" in str(error)
        assume(False)
    assert read_diagram(file) == diagram


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_diagram_is_written_by_its_blocks_and_read_as_the_same(name, reading):
    """One that is no `kind` of its own has its wiring written out."""
    text = diagram_text(load_shipped(name))
    assert ("[junctions]" in text) == (name in WRITTEN_OUT)
    assert reading(text) == load_shipped(name)


def test_the_short_form_is_wired_as_the_package_does(reading):
    diagram = reading(SHORT)
    blocks = {b.name: b for b in diagram.blocks}
    assert blocks["H"].analog
    same = haptic_interface(
        blocks["Z_M"].body, hand=ANY, force_feedback=blocks["H"].controller, analog=("H",)
    )
    assert diagram == same


@pytest.mark.parametrize(
    ("text", "old", "new", "words"),
    [
        (FREE, "loads", "load", 'loop.toml: blocks.M: unknown key "load"'),
        (FREE, "f_k = 1", 'f_k = "1"', 'loop.toml: blocks.M.loads.f_k: found "1", expected a num'),
        (FREE, 'kind = "moving"', "", 'loop.toml: blocks.M: no key "kind"'),
        (FREE, "coulomb]", "coulom]", 'blocks.M.effects: no effect "coulom"; did you mean "coul'),
        (FREE, "level = 0.5\n\n", "level = -0.5\n\n", "M.effects.coulomb.level: -0.5 N is out"),
        (FREE, '"g"', '"mm"', 'blocks.M.inertia.unit: found "mm", expected a mass'),
        (FREE, "150", "nan", "loop.toml: blocks.M.inertia.value: found nan"),
        (FREE, "velocity = 0.01", "velocity = -1", "loop.toml: blocks.C.parameters: smoothed_coul"),
        (FREE, '["x"]', '["y"]', "loop.toml: one body on a spring: measured: nothing makes sign"),
        (JOINED, "0.1*cos(q)", "0.1*cosh(q)", 'kinematics.x: found function "cosh", expected sin'),
        (JOINED, "0.1*cos(q)", "0.1*cos(r)", 'nothing makes signal "r"'),
        (JOINED, "0.1*cos(q)", "cos(q)/0", "loop.toml: kinematics.x: has no finite real value"),
        (JOINED, '"-0.1*sin(q)"', "true", "junctions.t.f_x: found true, expected a number"),
        (JOINED, "[[300, -40], ", "[[300], ", "blocks.Z.stiffness: found 2 rows of 1 and 2, expec"),
        (JOINED, '["f_x", "f_y"]', '["f_x"]', "Z: 2 rows, found 2 motions and 1 forces"),
        (JOINED, "q = 0.4", "q = inf", "loop.toml: pose.q: found inf"),
        (SHORT, "bandwidth = 20", "gain = 20", 'blocks.H.series[2].parameters: unknown key "gain"'),
        (SHORT, "analog", 'law = "lead"\nanalog', "blocks.H.law: found beside series"),
        (SHORT, "[blocks.Z_H]", "[blocks.Z_H", "loop.toml: not valid TOML"),
    ],
)
def test_a_mistake_is_reported_in_one_line(reading, text, old, new, words):
    assert old in text
    with pytest.raises(ExperimentError) as caught:
        reading(text.replace(old, new, 1))
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_geometry_and_what_joins_several_motions_are_read(reading):
    q = position_symbol("q")
    diagram = reading(JOINED)
    assert diagram.position("x") == 0.1 * sp.cos(q)
    assert diagram.here(diagram.junctions[1].terms["f_x"]) == pytest.approx(-0.1 * np.sin(0.4))
    assert diagram.block("Z").body.stiffness == ((300.0, -40.0), (-40.0, 200.0))
    assert diagram.block("M").body.effect("environment") is CONTACT
    assert reading(diagram_text(diagram)) == diagram


def test_parallel_rods_and_arms_are_read_as_they_were_written(reading):
    for diagram in (two_rods(), two_armed_teleoperator()):
        assert reading(diagram_text(diagram)) == diagram


def test_what_has_no_form_in_a_file_is_reported_in_one_line(tmp_path):
    control = pytest.importorskip("control")
    diagram = load_shipped("world-haptics-2005")
    filtered = diagram.with_block("C", from_control(control.tf([1.0], [0.1, 1.0])))
    with pytest.raises(ModelError, match='C: law "state_space" is none of the package'):
        write_diagram(filtered, tmp_path / "odd.toml")
    q = position_symbol("q")
    stepped = Junction("x", {"q": sp.Heaviside(q)})
    body = Moving("M", ANY, "q", "u", {}, "u")
    wiring = Diagram("odd", (body,), (stepped,), {"u": "force"}, measured=())
    with pytest.raises(ModelError, match='junction x: q: found function "Heaviside".* no form in'):
        write_diagram(wiring, tmp_path / "odd.toml")
    named = replace(body, motion="pi")
    turned = Junction("x", {"u": position_symbol("pi")})
    with pytest.raises(ModelError, match='junction x: u: "pi" has no form in a file'):
        write_diagram(replace(wiring, blocks=(named,), junctions=(turned,)), tmp_path / "odd.toml")
    assert not (tmp_path / "odd.toml").exists()


def test_an_effect_of_the_user_takes_part_in_a_file(tmp_path, capsys):
    path = tmp_path / "magnet.py"
    path.write_text(
        '"""A magnet."""\n'
        "from teleopdesign.effects import Effect, Parameter\n"
        'EFFECT = Effect(role="force", law=lambda now, p: p.pull * now.position, linear=True,\n'
        '    parameters={"pull": Parameter("stiffness", "its pull")}, absent={"pull": 0.0})\n'
    )
    file = tmp_path / "loop.toml"
    file.write_text(FREE.replace("effects.coulomb]\nlevel", "effects.magnet]\npull"))
    known = catalogue([path])
    diagram = read_diagram(file, effects=known)
    write_diagram(diagram, tmp_path / "copy.toml", effects=known)
    assert read_diagram(tmp_path / "copy.toml", effects=known) == diagram
    assert main(["derive", str(file), "--effect", str(path)]) == 0
    assert main(["derive", str(file)]) == 2
    assert 'no effect "magnet"' in capsys.readouterr().err


def test_an_effect_that_a_reader_would_not_find_is_not_written(tmp_path):
    diagram = load_shipped("world-haptics-2005")
    changed = EFFECTS["presliding"].without("bristle_damping")
    body = diagram.block("Z_M").body.with_effect(changed, {"stiffness": 1e4})
    with pytest.raises(ModelError, match='Z_M: effect "presliding" is not the one'):
        write_diagram(diagram.with_block("Z_M", body), tmp_path / "odd.toml")
