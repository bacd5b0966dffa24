"""A model: bodies with effects at places, read from an experiment, changed by making a new one."""

from dataclasses import replace

import pytest
from effects.along import axis_of
from measurement.rod_example import write_rod

from teleopdesign import EFFECTS, Effect, Model, ModelError, Parameter, Value
from teleopdesign import load_experiment as load
from teleopdesign.effects import CONTACT_ROLES


@pytest.fixture
def experiment(tmp_path):
    return load(write_rod(tmp_path / "rod"))


@pytest.fixture
def model(experiment):
    return Model.from_experiment(experiment)


def test_a_model_reads_values_in_si_units_and_keeps_what_is_fixed(tmp_path):
    folder = write_rod(tmp_path / "rod")
    file = folder / "experiment.toml"
    text = file.read_text().replace(
        'value = 0.15, unit = "kg", fixed = false', 'value = 150, unit = "g", fixed = true'
    )
    file.write_text(text.replace("viscous = {}", "stribeck = {}\nviscous = {}"))
    model = Model.from_experiment(load(folder))
    assert model.parameters["device.inertia"].value == pytest.approx(0.15)
    assert model.parameters["device.inertia"].fixed
    assert model.parameters["device.coulomb.level"].value == 0.5
    assert not model.parameters["device.coulomb.level"].fixed
    assert model.parameters["device.viscous.damping"].value == 0.0, "absent until it is fitted"
    assert model.parameters["device.stribeck.extra_static_level"].value == 0.0
    assert model.effects == (("coulomb", "device"), ("stribeck", "device"), ("viscous", "device"))
    assert model.unit("device.coulomb.level") == "N"
    assert model.declared("device.coulomb.level") == EFFECTS["coulomb"].parameters["level"]


def test_a_model_never_changes(model):
    more = model.with_effect("stribeck")
    assert more.body("device").has("stribeck") and not model.body("device").has("stribeck")
    other = model.with_values({"device.coulomb.level": 0.7})
    assert other.parameters["device.coulomb.level"].value == 0.7
    assert model.parameters["device.coulomb.level"].value == 0.5
    model.parameters["device.coulomb.level"] = Value(1.0)  # a copy
    assert model.parameters["device.coulomb.level"].value == 0.5
    with pytest.raises(TypeError):
        model.body("device").parameters["coulomb.level"] = Value(1.0)
    with pytest.raises(AttributeError):
        model.bodies = {}


@pytest.mark.parametrize(
    "name", sorted(n for n, e in EFFECTS.items() if e.role not in CONTACT_ROLES)
)
def test_an_effect_added_and_taken_away_leaves_the_model_as_it_was(name, model):
    base = model if not model.body("device").has(name) else model.without_effect(name)
    base = replace(base, bodies={"device": replace(base.body("device"), axis=axis_of(name))})
    for need in sorted(EFFECTS[name].needs, key=lambda n: len(EFFECTS[n].needs)):
        if not base.body("device").has(need):
            base = base.with_effect(need)
    more = base.with_effect(name, at="device")
    assert {f"device.{name}.{p}" for p in EFFECTS[name].parameters} <= set(more.parameters)
    for parameter, value in EFFECTS[name].absent.items():
        assert more.parameters[f"device.{name}.{parameter}"].value == value
    less = more.without_effect(name)
    assert less.parameters == base.parameters and less.effects == base.effects


def test_an_effect_of_the_user_takes_part(model):
    effect = Effect(
        role="force",
        law=lambda now, p: p.drag * now.velocity,
        parameters={"drag": Parameter("damping", "any")},
        absent={"drag": 0.0},
    ).named("own", "Own.")
    more = model.with_effect(effect, values={"drag": 2.0})
    assert more.parameters["device.own.drag"].value == 2.0
    assert "device.own.drag = 2 N*s/m" in repr(more)


def test_plain_numbers_keep_what_is_fixed(model):
    fixed = model.with_values({"device.inertia": Value(0.2, fixed=True)})
    assert fixed.with_values({"device.inertia": 0.3}).parameters["device.inertia"].fixed
    assert "(fixed)" in repr(fixed)


MISTAKES = {
    "unknown effect": (
        lambda m: m.with_effect("stribek"),
        r'with_effect: no effect "stribek"; did you mean "stribeck"\?',
    ),
    "unknown place": (
        lambda m: m.with_effect("stribeck", at="devise"),
        r'no body "devise", has device; did you mean "device"\?',
    ),
    "unknown parameter": (
        lambda m: m.with_effect("stribeck", values={"static_level": 1.0}),
        'stribeck: no parameter "static_level"',
    ),
    "there already": (
        lambda m: m.with_effect("coulomb"),
        'effect "coulomb" is there already at device',
    ),
    "needs another": (
        lambda m: m.without_effect("coulomb").with_effect("stribeck"),
        '"stribeck" needs "coulomb" beside it',
    ),
    "taken away under another": (
        lambda m: m.with_effect("stribeck").without_effect("coulomb"),
        '"stribeck" needs "coulomb"',
    ),
    "not there": (lambda m: m.without_effect("spring"), 'has no effect "spring"'),
    "value at an unknown place": (
        lambda m: m.with_values({"slave.inertia": 1.0}),
        'no parameter "slave.inertia"',
    ),
    "out of bounds": (
        lambda m: m.with_values({"device.coulomb.level": -1.0}),
        "coulomb.level = -1 N is outside 0 .. inf",
    ),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_line(mistake, model):
    change, expected = MISTAKES[mistake]
    with pytest.raises(ModelError, match=expected) as caught:
        change(model)
    assert len(str(caught.value).splitlines()) == 1


def test_two_bodies_need_a_place(model):
    pair = Model({"master": model.body("device"), "slave": model.body("device")})
    with pytest.raises(ModelError, match="at = one of master, slave must be given"):
        pair.with_effect("spring")
    more = pair.with_effect("spring", at="slave")
    assert more.effects[-1] == ("spring", "slave")
    assert not more.body("master").has("spring")
