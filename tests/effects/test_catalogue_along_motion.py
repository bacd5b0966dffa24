"""Along a motion an effect is absent where it says so, linear if declared, right in any units."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from effects.along import (
    INERTIA,
    NAMES,
    body_of,
    encoded,
    motion_along,
    signals,
    typical,
    unled,
    with_needs,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.effects import (
    EFFECTS,
)
from teleopdesign.realise.along_motion import residual_along

S = sp.Symbol("s")


@pytest.mark.parametrize("factor", ["friction_drift", "position_dependent_friction"])
def test_a_factor_scales_the_coulomb_level_and_not_what_others_add(factor):
    plain, whole = body_of("coulomb", "stribeck"), body_of("coulomb", "stribeck", factor)
    expression = EFFECTS[factor].expression()
    coulomb = EFFECTS["coulomb"].expression()
    assert sp.simplify(whole.level() - plain.level() - coulomb * (expression - 1)) == 0


def test_a_users_factor_that_needs_no_effect_scales_the_whole_level():
    scaled = replace(EFFECTS["friction_drift"], needs=frozenset())
    whole = body_of("coulomb", "stribeck").with_effect(scaled)
    plain = body_of("coulomb", "stribeck").level()
    assert sp.simplify(whole.level() - plain * scaled.expression()) == 0


# absence


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_at_its_absent_values_changes_nothing_along_a_motion(name):
    x, u, f = signals()
    motion = motion_along(encoded(x), u, f, resolution=1e-6)
    around = [n for n in ("coulomb", "viscous", *with_needs(name)) if n != name]
    around = list(dict.fromkeys(around))
    without = residual_along(body_of(*around), motion).residual.value
    there = residual_along(body_of(*around, name, absent=(name,)), motion).residual.value
    # the order of sums may differ by rounding, nothing else
    np.testing.assert_allclose(there, without, rtol=0, atol=1e-13 * np.abs(without).max())
    full = residual_along(body_of(*around, name), motion).residual.value
    assert np.abs(full - without).max() > 1e-3 * np.abs(without).max(), "at typical values it shows"


def in_time(name):
    """False where a hidden state is sampled: it lags a sample, however small its parameters."""
    return not EFFECTS[name].states or EFFECTS[name].role == "actuation"


@pytest.mark.parametrize(
    "name", [n for n in NAMES if all(v == 0 for v in EFFECTS[n].absent.values()) if in_time(n)]
)
def test_a_trace_of_an_effect_changes_a_trace(name):
    """No jump between absent and present: a model can be improved from an effect at zero."""
    x, u, f = signals()
    motion = motion_along(encoded(x), u, f, resolution=1e-6)
    effect, names = EFFECTS[name], with_needs(name)
    around = [n for n in names if n != name]
    trace = {f"{name}.{p}": 1e-6 * typical(name, p) for p in effect.absent}
    without = residual_along(body_of(*around), motion).residual.value
    little = residual_along(body_of(*names, values=trace), motion).residual.value
    # 1e-6 of a typical strength; a hundredfold margin for what changes faster than in proportion
    assert np.abs(little - without).max() < 1e-4 * np.abs(without).max()


# linear effects


@pytest.mark.parametrize("name", [n for n in NAMES if EFFECTS[n].linear])
@settings(max_examples=10)
@given(a=st.floats(-3, 3), b=st.floats(-3, 3))
def test_a_linear_effect_superposes(name, a, b):
    names = with_needs(name)

    def left(*forces):
        return residual_along(body_of(*names), motion_along(*forces)).residual.value

    one, other = signals(1), signals(2)
    both = left(*(a * p + b * q for p, q in zip(one, other, strict=True)))
    apart = a * left(*one) + b * left(*other)
    size = np.abs(left(*one)).max() + np.abs(left(*other)).max()
    np.testing.assert_allclose(both, apart, rtol=0, atol=1e-9 * size)


@pytest.mark.parametrize("frequency", [2.0, 15.0])
@pytest.mark.parametrize("name", [n for n in NAMES if EFFECTS[n].linear])
def test_the_linear_form_is_the_law_along_a_sine(name, frequency):
    """Residual along x = sin(wt), command = sin(wt): G u - (m s^2 + Z) x at s = jw."""
    effect = EFFECTS[name]
    body = unled(body_of(*with_needs(name)))
    t = np.arange(4000) * 1e-3
    wave = np.exp(2j * np.pi * frequency * t)
    motion = motion_along(0.01 * wave.imag, wave.imag)
    along = residual_along(body, motion)
    numbers = {s: typical(name, n) for n, s in effect.symbols().items()}
    form = complex(effect.linear_form(S).subs({**numbers, S: 2j * sp.pi * frequency}).evalf())
    impedance = -INERTIA * (2 * np.pi * frequency) ** 2
    transfer = 1.0 + 0j
    if effect.role == "actuation":
        transfer = form
    else:
        impedance = impedance + form
    hold = np.sinc(frequency * 1e-3) * np.exp(-1j * np.pi * frequency * 1e-3)
    expected = ((transfer * hold - 0.01 * impedance) * wave).imag
    most = 3e-3 if effect.role == "structure" else 1e-3
    inside = slice(700, -700)  # s; ends feel the continuation of the record
    # a staircase has images about the sample rate, of relative size (w h)^2/12 < 1e-3 at 15 Hz; a
    # tip's drive is linear between rows, and its resonance near by triples that
    np.testing.assert_allclose(
        along.residual.value[inside], expected[inside], rtol=0, atol=most * np.abs(expected).max()
    )


# units


def factors(force, position, time):
    """What each quantity is multiplied with when its units are."""
    return {
        "force": force,
        "position": position,
        "time": time,
        "velocity": position / time,
        "acceleration": position / time**2,
        "inertia": force * time**2 / position,
        "damping": force * time / position,
        "stiffness": force / position,
        "drag": force * time**2 / position**2,
        "cubic_stiffness": force / position**3,
        "per_square_of_position": 1.0 / position**2,
        "frequency": 1.0 / time,
        "angle": 1.0,
        "dimensionless": 1.0,
        "temperature": 1.0,
        "temperature_coefficient": 1.0,
    }


@pytest.mark.parametrize(
    ("force", "position", "time"),
    # each alone, and all at once; s goes down only: see the number of samples below
    [(8.0, 1.0, 1.0), (1.0, 2.0**10, 1.0), (0.5, 2.0**-7, 0.25)],
)
@pytest.mark.parametrize("name", NAMES)
def test_an_effect_gives_the_same_answer_in_other_units(name, force, position, time):
    """Every parameter has the quantity that its law needs: the residual scales like a force."""
    if EFFECTS[name].counterparts:
        position = 1.0  # an angle has no other unit
    if name == "shear_thinning":
        position = time  # a force at the unit of speed, whatever that is
    # 0.4 s: shorter than the continuation at the ends, which is a fixed time
    x, u, f = signals(samples=400)
    step = 1e-6
    names = with_needs(name)
    by = factors(force, position, time)
    body = body_of(*names)
    values = {n: v.value * by[body.parameter(n).quantity] for n, v in body.parameters.items()}
    one = residual_along(body, motion_along(encoded(x, step), u, f, resolution=step))
    other = residual_along(
        body.with_values(values),
        motion_along(
            position * encoded(x, step),
            force * u,
            force * f,
            sample_time=1e-3 * time,
            bandwidth=60.0 / time,
            resolution=position * step,
        ),
    )
    np.testing.assert_array_equal(one.motion.direction, other.motion.direction)
    expected = force * one.residual.value
    # rounding, through exponentials of arguments of the order of a hundred
    np.testing.assert_allclose(
        other.residual.value, expected, rtol=0, atol=1e-9 * np.abs(expected).max()
    )
