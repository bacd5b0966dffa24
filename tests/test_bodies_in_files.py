"""A body is the same table, by the same rules, in an experiment, a diagram's file and an answer."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from measurement.rod_example import write_rod

from teleopdesign import load_experiment
from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.toml import Table
from teleopdesign.base.units import QUANTITIES, to_si
from teleopdesign.blocks import BLOCK_EFFECTS, Body, Value, with_block_effects
from teleopdesign.blocks.described import body_of
from teleopdesign.diagnose.model_data import body_data, model_from
from teleopdesign.diagrams import read_diagram
from teleopdesign.diagrams.toml_writing import body_lines
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.description import body_from
from teleopdesign.model import Model

AXES = ("prismatic", "revolute")
ALL = with_block_effects(EFFECTS)


def in_an_experiment(lines, folder):
    """The device of the rod's experiment, described by these lines."""
    case = folder / f"{len(list(folder.iterdir()))}"
    case.mkdir()
    file = write_rod(case / "rod") / "experiment.toml"
    text = file.read_text()
    begin, end = text.index("[model.device]"), text.index("[channels]")
    text = text[:begin] + "\n".join(["[model.device]", *lines, ""]) + text[end:]
    file.write_text(text.replace('"N"', '"N*m"').replace('"mm"', '"deg"') if "revolute" in
                    lines[0] else text)  # fmt: skip
    return Model.from_experiment(load_experiment(file.parent)).body("device")


def in_a_diagram(lines, folder):
    head = ['[diagram]\nkind = "haptic interface"', "[blocks.Z_M]"]
    file = folder / "loop.toml"
    file.write_text("\n".join([*head, *lines]), encoding="utf-8")
    return read_diagram(file).block("Z_M").body


PLACES = {"model.device": in_an_experiment, "blocks.Z_M": in_a_diagram}


def same(one, other):
    """Whether two bodies are the same, an error that is not known being like another."""

    def numbers(body):
        return {n: (v.value, v.fixed, repr(v.stderr)) for n, v in body.parameters.items()}

    return one.axis == other.axis and one.effects == other.effects and numbers(one) == numbers(
        other
    )  # fmt: skip


def with_needs(name):
    """The effect with those that it needs beside it, in an order that a body may have."""
    effects = []
    for need in sorted(ALL[name].needs):
        effects += with_needs(need)
    return [*effects, ALL[name]]


def body_with(name, axis, number=0.3):
    effects = list(dict.fromkeys(with_needs(name)))
    values = {"inertia": Value(0.15, fixed=True, stderr=0.01)}
    for effect in effects:
        for key, p in effect.parameters.items():
            inside = min(max(number, p.lower), p.upper)
            values[f"{effect.name}.{key}"] = Value(inside, stderr=0.25 * abs(inside))
    return Body(axis, values, tuple(effects))


@pytest.mark.parametrize(
    ("name", "axis"), [(n, a) for n in sorted(ALL) for a in AXES if a not in ALL[n].counterparts]
)
def test_what_is_written_of_a_body_is_read_as_the_same_body(name, axis, tmp_path):
    body = body_with(name, axis)
    at_a_contact = any(e.role.startswith("contact") or e.name in BLOCK_EFFECTS
                       for e in body.effects)  # fmt: skip
    assert same(in_a_diagram(body_lines("blocks.Z_M", body), tmp_path), body)
    data = json.loads(json.dumps({"device": body_data(body)}))
    assert same(model_from(data, EFFECTS, "models").bodies["device"], body)
    if not at_a_contact and not any(e.channels() for e in body.effects):
        assert same(in_an_experiment(body_lines("model.device", body), tmp_path), body)


BARE = ['axis = "prismatic"', "inertia = 0.15", "[{at}.effects.coulomb]", "level = 0.5"]


def lines_with(at, old="", new=""):
    return [line.replace(old, new).replace("{at}", at) if old else line.replace("{at}", at)
            for line in BARE]  # fmt: skip


@pytest.mark.parametrize("at", PLACES)
def test_a_plain_number_is_in_si_and_a_unit_is_converted(at, tmp_path):
    plain = PLACES[at](lines_with(at), tmp_path)
    assert plain.parameters["coulomb.level"].value == 0.5
    written = '{ value = 500, unit = "mN", stderr = 20, fixed = true }'
    value = PLACES[at](lines_with(at, "level = 0.5", f"level = {written}"), tmp_path).parameters[
        "coulomb.level"
    ]
    assert value.value == pytest.approx(0.5, rel=1e-12)
    assert value.stderr == pytest.approx(0.02, rel=1e-12) and value.fixed


@pytest.mark.parametrize("at", PLACES)
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("level = 0.5", 'level = { value = 1, unit = "kg" }',
         'effects.coulomb.level.unit: found "kg", expected a force such as "N" or "mN"; '
         'as a weight it is in "kgf"'),
        ("level = 0.5", "level = -1", "effects.coulomb.level: -1 N is outside 0 .. inf"),
        ("level = 0.5", "levl = 0.5",
         'effects.coulomb: no parameter "levl", has level; did you mean "level"?'),
        ("inertia = 0.15", "", ": no inertia given"),
        ('"prismatic"', '"prismatc"', 'axis: found "prismatc", expected prismatic, revolute; '
         'did you mean "prismatic"?'),
        ("coulomb", "coulom", 'effects: no effect "coulom"; did you mean "coulomb"? (see '
         "`teleopdesign effects`)"),
    ],
)  # fmt: skip
def test_a_mistake_is_the_same_sentence_in_every_file(at, old, new, message, tmp_path):
    file = {"model.device": "rod/experiment.toml", "blocks.Z_M": "loop.toml"}[at]
    with pytest.raises(ExperimentError) as caught:
        PLACES[at](lines_with(at, old, new), tmp_path)
    dot = "" if message.startswith(":") else "."
    assert str(caught.value) == f"{file}: {at}{dot}{message}"


def test_open_parameters_are_for_experiments_alone(tmp_path):
    """A fit finds what is left open; a diagram has none."""
    lines = ['axis = "prismatic"', "inertia = 1", "[{at}.effects.viscous]"]
    body = in_an_experiment([x.replace("{at}", "model.device") for x in lines], tmp_path)
    assert body.parameters["viscous.damping"].value == 0.0 and body.effects[0].name == "viscous"
    with pytest.raises(ExperimentError, match='effects.viscous: no key "damping", expected a num'):
        in_a_diagram([x.replace("{at}", "blocks.Z_M") for x in lines], tmp_path)


PARAMETERS = [
    (name, key, axis) for name in sorted(EFFECTS) for key in EFFECTS[name].parameters
    for axis in AXES if axis not in EFFECTS[name].counterparts
]  # fmt: skip


@given(st.sampled_from(PARAMETERS), st.floats(1e-6, 1e6), st.integers(0, 1))
def test_every_parameter_takes_every_unit_of_its_quantity(which, number, index):
    name, key, axis = which
    parameter = EFFECTS[name].parameters[key]
    unit = QUANTITIES[parameter.quantity][AXES.index(axis)].units[index]
    meant = to_si(number, unit, quantity=parameter.quantity, axis=axis)
    given_effects = {e.name: {} for e in dict.fromkeys(with_needs(name))}
    given_effects[name] = {key: {"value": number, "unit": unit}}
    table = Table({"axis": axis, "inertia": 1.0, "effects": given_effects}, "file", "body")
    described = body_from("body", table)
    if parameter.lower <= meant <= parameter.upper:
        assert body_of(described, ALL).parameters[f"{name}.{key}"].value == meant
    else:
        with pytest.raises(ExperimentError, match="is outside"):
            body_of(described, ALL)
    wrong = "kg" if parameter.quantity != "inertia" or axis == "revolute" else "N"
    given_effects[name] = {key: {"value": number, "unit": wrong}}
    with pytest.raises(ExperimentError, match=f'{key}.unit: found "{wrong}", expected'):
        body_of(body_from("body", table), ALL)
