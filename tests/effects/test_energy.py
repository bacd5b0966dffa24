"""What an effect declares to do with energy is proved over all its parameters, or attacked."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
import sympy as sp
from effects.along import KNOWN, NAMES, body_of, motion_along, typical, with_needs
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.blocks import Body, Value
from teleopdesign.effects import EFFECTS, SIGNALS, Effect, load_effect
from teleopdesign.realise.along_motion import residual_along
from teleopdesign.realise.extremes import least_value

SPEED = sp.Symbol("speed", positive=True)
LEVELS = ("friction_level", "friction_factor", "tip_level")
STATIC = [n for n in NAMES if not EFFECTS[n].states and EFFECTS[n].role in ("force", *LEVELS)]
CONTACTS = [n for n in NAMES if EFFECTS[n].role in ("contact", "contact_shape")]
STRUCTURES = [n for n in NAMES if EFFECTS[n].role == "structure"]
#: on the velocity of the tip, not of the body
AT_TIPS = [n for n in NAMES if EFFECTS[n].role == "tip_level"]
ON_COMMANDS = [n for n in NAMES if EFFECTS[n].role == "actuation"]


def declaring(energy, names=NAMES):
    return [n for n in names if EFFECTS[n].energy == energy]


def against(effect, way):
    """Force against a motion in that direction, or a share of one, on symbols."""
    law = effect.expression().subs({SIGNALS["velocity"]: way * SPEED, SIGNALS["direction"]: way})
    return way * law if effect.role == "force" else law


def everywhere(effect):
    """Every signal, and every value of the parameters within their bounds."""
    ranges = {s: (-inf, inf) for s in SIGNALS.values()} | {SPEED: (0.0, inf)}
    ranges[SIGNALS["time"]] = (0.0, inf)
    effects = [effect, *(KNOWN[n] for n in effect.needs)]
    parameters = {s: e.parameters[n] for e in effects for n, s in e.symbols().items()}
    return ranges | {s: (p.lower, p.upper) for s, p in parameters.items()}


def never_helps(effect):
    """Proved by interval arithmetic: its power against the motion is nowhere below zero."""
    return all(least_value(against(effect, w), everywhere(effect)).bound >= 0 for w in (-1, 1))


def is_conservative(effect):
    """A force of position alone, constant against both directions, or an inertia."""
    law = effect.expression()
    if effect.role in LEVELS:
        law = sp.expand(law * SIGNALS["direction"]).subs(SIGNALS["direction"] ** 2, 1)
    if effect.role == "contact_shape":
        return law.free_symbols & set(SIGNALS.values()) == {SIGNALS["penetration"]}
    inertia = sp.diff(law, SIGNALS["acceleration"])
    rest = sp.expand(law - inertia * SIGNALS["acceleration"])
    used = rest.free_symbols & set(SIGNALS.values())
    return used <= {SIGNALS["position"]} and not inertia.free_symbols & set(SIGNALS.values())


@pytest.mark.parametrize("name", declaring("dissipates", STATIC))
def test_what_dissipates_opposes_motion_at_every_speed(name):
    assert never_helps(EFFECTS[name])


@pytest.mark.parametrize("name", declaring("stores"))
def test_what_stores_has_a_potential(name):
    assert is_conservative(EFFECTS[name])


@pytest.mark.parametrize("name", declaring("supplies", STATIC))
def test_what_supplies_is_neither(name):
    assert not never_helps(EFFECTS[name])
    assert not is_conservative(EFFECTS[name])


def test_all_that_acts_on_commands_is_declared_as_a_supply():
    """It changes the force of a controller, of which no law of the body is a bound."""
    assert set(ON_COMMANDS) <= set(declaring("supplies"))


@pytest.mark.parametrize(
    ("name", "claim"),
    [("viscous_asymmetry", never_helps), ("spring", never_helps), ("viscous", is_conservative)],
)
def test_a_false_declaration_is_not_proved(name, claim):
    assert not claim(EFFECTS[name])


def random_walk(seed, samples=400, sample_time=1e-3):
    """A motion that is told at every sample: speeds over four decades, rests, reversals."""
    rng = np.random.default_rng(seed)
    legs = rng.integers(3, 60, size=samples)
    speed = 10 ** rng.uniform(-4, 0, size=samples) * rng.choice([-1, 1], size=samples)
    velocity = np.repeat(speed, legs)[:samples]
    velocity[0] = 1e-4
    position = np.cumsum(velocity) * sample_time
    motion = motion_along(position, np.zeros(samples), resolution=1e-9)
    return replace(
        motion,
        position=position,
        velocity=velocity,
        acceleration=np.zeros(samples),
        direction=np.sign(velocity).astype(np.int8),
    )


@st.composite
def values_of(draw, name):
    """Values of all parameters over three decades about the typical, within their bounds."""
    return {
        f"{n}.{p}": float(
            np.clip(typical(n, p) * 10 ** draw(st.floats(-1.5, 1.5)), q.lower, q.upper)
        )
        for n in with_needs(name)
        for p, q in KNOWN[n].parameters.items()
    }


@pytest.mark.parametrize(
    "name", [n for n in declaring("dissipates") if n not in CONTACTS + STRUCTURES + AT_TIPS]
)
@settings(max_examples=25)
@given(data=st.data(), seed=st.integers(0, 2**31))
def test_the_work_done_against_it_never_falls_below_zero(name, data, seed):
    """From a start at rest no energy comes back that was not put in, hidden states included.

    A hidden state is taken at the end of each sample's way, where a friction that relaxes towards
    the direction of motion is largest: the sum is an upper bound of the work, and above zero.
    """
    drawn = data.draw(values_of(name))
    motion = random_walk(seed)
    names = with_needs(name)
    bare = residual_along(body_of(), motion).residual.value
    force = bare - residual_along(body_of(*names, values=drawn), motion).residual.value
    work = np.cumsum(force * motion.velocity) * motion.sample_time
    assert work.min() >= -1e-12 * np.abs(work).max()  # rounding
    if not EFFECTS[name].states:
        assert np.all(force * motion.velocity >= 0.0), "opposes the motion at every sample"


def closed_path(seed, samples=20001):
    """Position and velocity along a random closed path of 1 s, 1 cm wide."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, samples)
    k, a, phi = np.arange(1, 6), rng.normal(0, 0.004, 5), rng.uniform(0, 2 * np.pi, 5)
    angle = 2 * np.pi * k[:, None] * t + phi[:, None]
    return t, a @ np.sin(angle), (2 * np.pi * k * a) @ np.cos(angle)


def work_around(law, numbers, seed):
    """Work done against a force of position and velocity around a closed path, and its size."""
    t, x, v = closed_path(seed)
    call = sp.lambdify([SIGNALS["position"], SIGNALS["velocity"]], law.subs(numbers), "numpy")
    with np.errstate(invalid="ignore"):  # a piece that is not taken is evaluated all the same
        power = np.broadcast_to(call(x, v), x.shape) * v
    return np.trapezoid(power, t), np.trapezoid(np.abs(power), t)


def coupling(effect):
    """Force of a structure whose tip is held, on position and velocity."""
    held = dict.fromkeys([*effect.state_symbols().values(), SIGNALS["interaction_force"]], 0)
    return effect.expression().subs(held | {SIGNALS["acceleration"]: 0})


@pytest.mark.parametrize("name", STRUCTURES)
@settings(max_examples=25)
@given(data=st.data(), seed=st.integers(0, 2**31))
def test_a_structure_takes_energy_around_a_closed_path(name, data, seed):
    drawn = data.draw(values_of(name))
    numbers = {s: drawn[f"{name}.{n}"] for n, s in EFFECTS[name].symbols().items()}
    work, size = work_around(coupling(EFFECTS[name]), numbers, seed)
    assert EFFECTS[name].energy == "dissipates"
    assert work >= -1e-3 * size  # edges of a gap between samples


@pytest.mark.slow
@pytest.mark.parametrize("name", CONTACTS)
@settings(max_examples=25)
@given(data=st.data(), seed=st.integers(0, 2**31))
def test_a_contact_takes_no_less_than_it_declares(name, data, seed):
    drawn = data.draw(values_of(name)) | {"environment.damping": 0.0}
    body = Body("prismatic", {"inertia": Value(0.1)})
    for n in with_needs(name):
        parameters = {p: drawn[f"{n}.{p}"] for p in KNOWN[n].parameters}
        body = body.with_effect(KNOWN[n], parameters)
    work, size = work_around(body.contact(), body.numbers(), seed)
    assert work >= -1e-3 * size  # the touch between samples
    if EFFECTS[name].energy == "stores":
        assert work <= 1e-3 * size


# a user's file


SOURCE = '''"""Own: a force.

    F = K x
"""

from teleopdesign.effects import Effect, Parameter

EFFECT = Effect(
    role="force",{energy}
    law=lambda now, p: p.stiffness * now.position,
    parameters={{"stiffness": Parameter("stiffness", "K")}},
    absent={{"stiffness": 0.0}},
)
'''


def test_a_users_effect_that_does_not_say_counts_as_one_that_supplies(tmp_path):
    file = tmp_path / "own.py"
    file.write_text(SOURCE.format(energy=""))
    assert load_effect(file).energy == "supplies"
    file.write_text(SOURCE.format(energy='\n    energy="stores",'))
    assert load_effect(file).energy == "stores"
    file.write_text(SOURCE.format(energy='\n    energy="store",'))
    with pytest.raises(ModelError, match='energy: found the text "store", expected'):
        load_effect(file)
    assert Effect(role="force", law=lambda now, p: 0, parameters={}, absent={}).energy == "supplies"
