"""Diagrams as TOML: what is written is read as the same, and a mistake is told in one line."""

import pytest
from diagrams.random_diagrams import diagrams
from hypothesis import given, settings

from teleopdesign.diagrams import (
    ANY,
    SHIPPED,
    haptic_interface,
    read_diagram,
    shipped,
    write_diagram,
)
from teleopdesign.diagrams.toml_writing import diagram_text
from teleopdesign.effects import EFFECTS
from teleopdesign.errors import ExperimentError, ModelError

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


@settings(max_examples=100, deadline=None)
@given(diagram=diagrams())
def test_what_is_written_is_read_as_the_same_diagram(tmp_path_factory, diagram):
    file = tmp_path_factory.getbasetemp() / "random.toml"
    write_diagram(diagram, file)
    assert read_diagram(file) == diagram


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_diagram_is_written_by_its_blocks_and_read_as_the_same(name, reading):
    text = diagram_text(shipped(name))
    assert 'kind = "' in text and "[junctions]" not in text
    assert reading(text) == shipped(name)


def test_a_value_may_carry_its_unit(reading):
    diagram = reading(FREE)
    assert diagram.values["M.inertia"] == pytest.approx(0.15, rel=1e-15)
    assert diagram.block("Z").body is ANY and diagram.block("Z").sign == -1


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
        (FREE, "loads", "load", 'did you mean "loads"'),
        (FREE, "f_k = 1", 'f_k = "1"', 'loop.toml: blocks.M.loads.f_k: found "1", expected a num'),
        (FREE, '"moving"', '"movin"', 'blocks.M.kind: found "movin", expected moving, attached'),
        (FREE, 'kind = "moving"', "", 'loop.toml: blocks.M: no key "kind"'),
        (FREE, "coulomb]", "coulom]", 'blocks.M.effects: no effect "coulom"; did you mean "coul'),
        (FREE, "level = 0.5\n\n", "levl = 0.5\n\n", "did you mean"),
        (FREE, "level = 0.5\n\n", "level = -0.5\n\n", "loop.toml: blocks.M: body: coulomb.level ="),
        (FREE, '"g"', '"mm"', 'blocks.M.inertia.unit: found "mm", expected a mass'),
        (FREE, "150", "nan", "loop.toml: blocks.M.inertia.value: found nan"),
        (FREE, '"prismatic"', '"x"', 'blocks.M.axis: found "x", expected prismatic, revolute'),
        (FREE, "smoothed_", "smooth_", 'blocks.C.law: found "smooth_coulomb"'),
        (
            FREE,
            ", smoothing_velocity = 0.01",
            "",
            'blocks.C.parameters: no key "smoothing_velocity"',
        ),
        (FREE, "velocity = 0.01", "velocity = -1", "loop.toml: blocks.C.parameters: smoothed_coul"),
        (FREE, 'f = "force"', 'f = "forc"', 'outside.f: found "forc"'),
        (FREE, '["x"]', '"x"', 'diagram.measured: found "x", expected a list of signals'),
        (FREE, '["x"]', '["y"]', "loop.toml: one body on a spring: measured: nothing makes sign"),
        (FREE, 'force = "f_k"', 'force = "f_k"\nsign = 2', "blocks.Z.sign: found 2, expected 1 or"),
        (FREE, "[outside]", "[outsid]", 'unknown key "outsid", expected'),
        (SHORT, '"haptic interface"', '"haptic"', 'diagram.kind: found "haptic", expected haptic'),
        (SHORT, "blocks.Z_H", "blocks.Z_h", 'unknown key "Z_h", expected Z_M, Z_H, C, H, K'),
        (SHORT, "bandwidth = 20", "gain = 20", 'blocks.H.series[2].parameters: unknown key "gain"'),
        (SHORT, "analog", 'law = "lead"\nanalog', "blocks.H.law: found beside series"),
        (SHORT, "low_pass", "velocity_schedule", "unknown key"),
        (SHORT, "analog = true", "analog = 1", "blocks.H.analog: found a whole number, expected"),
        (SHORT, "[blocks.Z_H]", "[blocks.Z_H", "loop.toml: not valid TOML"),
    ],
)
def test_a_mistake_is_told_in_one_line(reading, text, old, new, words):
    assert old in text
    with pytest.raises(ExperimentError) as caught:
        reading(text.replace(old, new, 1))
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_missing_file_and_an_unknown_name_are_told(tmp_path):
    with pytest.raises(ExperimentError, match="none.toml: cannot be read"):
        read_diagram(tmp_path / "none.toml")
    with pytest.raises(ModelError, match='did you mean "haptic-interface"'):
        shipped("haptic-interfac")


def test_an_effect_that_a_reader_would_not_find_is_not_written(tmp_path):
    diagram = shipped("world-haptics-2005")
    changed = EFFECTS["presliding"].without("bristle_damping")
    body = diagram.block("Z_M").body.with_effect(changed, {"stiffness": 1e4})
    with pytest.raises(ModelError, match='Z_M: effect "presliding" is not the one'):
        write_diagram(diagram.with_block("Z_M", body), tmp_path / "odd.toml")
