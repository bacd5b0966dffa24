"""Parameters over twelve decades: a right force or a refusal, never a wrong one in silence."""

from functools import cache

import mpmath as mp
import numpy as np
import pytest
from devices import body
from effects.along import EFFECTS, INERTIA, NAMES, body_of, typical, with_needs
from exact.machines import Stroke
from exact.simulated import pair
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import SIGNALS
from teleopdesign.simulate import Trajectory, simulate

#: twelve decades about the typical value
DECADES = st.floats(-6.0, 6.0).map(lambda e: 10.0**e)
#: laws that a prescribed motion alone determines
ALGEBRAIC = [
    n
    for n in NAMES
    if EFFECTS[n].role in ("force", "friction_level")
    and not EFFECTS[n].states
    and not EFFECTS[n].channels()
    and not EFFECTS[n].free  # held to scipy in tests/effects/test_equations.py
    and SIGNALS["interaction_force"] not in EFFECTS[n].expression().free_symbols
]
#: of the force's own terms: double precision through powers, exponentials and a difference
LAW = 1e-9
#: of a number: some units in its last place
ROUNDING = mp.mpf("1e-15")
#: of the level: what the guard of the step leaves (10 steps a reload: 2e-4)
BRISTLE = 1e-3
#: of the amplitude, at once and for each radian: at 20 steps a period RK4 is late by
#: 0.3^4/120 = 7e-5 of a radian in each (docs/trust.md)
AT_ONCE, EACH_RADIAN = 1e-4, 1e-4


@cache
def device(name):
    return haptic_interface(body_of(*with_needs(name)))


def exact_terms(made, now, values):
    """Forces that act against the motion, in 50 digits: inertia, each force law, friction."""
    terms = [values["Z_M.inertia"] * now["acceleration"]]
    signals = {SIGNALS[n]: x for n, x in now.items()}
    level = mp.mpf(0)
    for effect in made.block("Z_M").body.effects:
        symbols = effect.symbols()
        numbers = {symbols[n]: values[f"Z_M.{effect.name}.{n}"] for n in symbols}
        law = effect.expression()
        if law.has(SIGNALS["carried_force"]):  # per force that the friction itself takes
            law = law.subs(SIGNALS["carried_force"], -SIGNALS["direction"])
        value = mp.mpf(law.subs({**signals, **numbers}).evalf(50))
        if effect.expression().has(SIGNALS["carried_force"]):
            # no actuator acts: friction takes all that is carried, L = -sgn v (level + m L). Near
            # m = 1 the gear locks, and slides no more within the motion
            assume(value < 0.5)
            value *= level / (1 - value)
        if effect.role == "friction_level":
            level += value
        else:
            terms.append(value)
    return [*terms, level * mp.sign(now["velocity"])]


def force_and_rounding(made, now):
    """The force in 50 digits, and what roundings of each number to 16 digits may do to it."""
    values = {n: mp.mpf(v) for n, v in made.values.items()}
    terms = exact_terms(made, now, values)
    force, rounding = mp.fsum(terms), LAW * mp.fsum(abs(x) for x in terms)
    for name, value in values.items():
        other = exact_terms(made, now, values | {name: value * (1 + ROUNDING)})
        rounding += abs(mp.fsum(other) - force)
    for name, value in now.items():
        other = exact_terms(made, now | {name: value * (1 + ROUNDING)}, values)
        rounding += abs(mp.fsum(other) - force)
    return force, rounding


@pytest.mark.slow
@pytest.mark.parametrize("name", ALGEBRAIC)
@settings(max_examples=30)  # fifty digits are slow; 14 laws
@given(data=st.data())
def test_the_force_of_a_law_is_that_of_fifty_digits(name, data):
    """Along a motion of constant velocity, long enough for a bristle to slide."""
    mp.mp.dps = 50
    made = device(name)
    effect = EFFECTS[name]
    scaled = {}
    for n, parameter in effect.parameters.items():
        value = typical(name, n) * data.draw(DECADES, label=n)
        if parameter.lower <= value <= parameter.upper:
            scaled[f"Z_M.{name}.{n}"] = value
    speed = data.draw(st.sampled_from([-1.0, 1.0])) * 10.0 ** data.draw(st.floats(-1.0, 1.0))
    start = data.draw(st.floats(-0.1, 0.1))
    motion = Trajectory(lambda t: start + speed * t, lambda t: speed + 0.0 * t, lambda t: 0.0 * t)
    try:
        made = made.with_values(scaled)
        simulation = simulate(
            made, duration=0.004, motion={"L": motion}, computer="continuous", jit=False
        )
    except ModelError:
        return
    t = mp.mpf(float(simulation["L"]["time"].values[-1]))
    now = {
        "time": t,
        "position": mp.mpf(float(simulation["L"].values[-1])),
        "velocity": mp.mpf(speed),
        "direction": mp.sign(speed),
        "acceleration": mp.mpf(0),
        "acting_force": mp.mpf(0),
    }
    # R_V is what the hand adds to move the body so
    force, rounding = force_and_rounding(made, now)
    assert abs(mp.mpf(float(simulation["R_V"].values[-1])) - force) <= rounding


@pytest.mark.slow
@given(level=DECADES, stiffness=DECADES, travel=st.floats(-4.0, 1.0).map(lambda e: 10.0**e))
def test_a_bristle_over_twelve_decades_follows_dahl_or_is_refused(level, stiffness, travel):
    times = 1e-3 * np.arange(101)
    stroke = Stroke(level=level, stiffness=1e5 * stiffness, large=travel, small=0.4 * travel)
    both = pair(stroke)
    try:
        simulation = simulate(both.diagram, duration=0.1, **both.arguments)["Z_M_friction"].values
    except ModelError:
        return
    assert np.abs(simulation - both.exact(times)["friction"]).max() <= BRISTLE * level


def oscillation(mass, stiffness, damping, force, times):
    """Of a mass on a spring and damper from rest under a constant force, in forty digits."""
    with mp.workdps(40):
        m, k, b = mp.mpf(mass), mp.mpf(stiffness), mp.mpf(damping)
        root = mp.sqrt(mp.mpc(b * b - 4 * m * k))
        p, q = (-b + root) / (2 * m), (-b - root) / (2 * m)
        rest = mp.mpf(force) / k
        if p == q:
            return [float(rest * (1 - (1 - p * t) * mp.exp(p * t))) for t in map(mp.mpf, times)]
        return [
            float((rest * (1 - (p * mp.exp(q * t) - q * mp.exp(p * t)) / (p - q))).real)
            for t in map(mp.mpf, times)
        ]


@pytest.mark.slow
@given(mass=DECADES, stiffness=DECADES, damping=DECADES)
def test_a_mass_on_a_spring_over_twelve_decades_moves_right_or_is_refused(mass, stiffness, damping):
    device = body(INERTIA * mass, spring__stiffness=1e3 * stiffness, viscous__damping=2.0 * damping)
    times = 1e-3 * np.arange(11)
    try:
        simulation = simulate(
            haptic_interface(device), duration=0.01, inputs={"R_V": 1.0}, computer="continuous"
        )["L"].values
    except ModelError:
        return
    m, k, b = INERTIA * mass, 1e3 * stiffness, 2.0 * damping
    end, radians = times[-1], (k / m) ** 0.5 * times[-1]
    amplitude = min(2.0 / k, end**2 / (2 * m), end / b)
    error = np.abs(simulation - oscillation(m, k, b, 1.0, times)).max()
    assert error <= (AT_ONCE + EACH_RADIAN * radians) * amplitude
