"""Every law and rate of the catalogue against its equation, written out a second time in numbers.

The equations are those at the head of each file. A sign, a power or a factor that is wrong in the
file is wrong nowhere else, so that only a second writing of it can tell.
"""

from math import copysign, exp, pi, sin
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from scipy.interpolate import CubicSpline, interp1d

from teleopdesign.effects import BLOCK_EFFECTS, EFFECTS, SIGNALS

KNOWN = {**EFFECTS, **BLOCK_EFFECTS}


def sgn(x):
    return copysign(1.0, x) if x else 0.0


def load_dependent(s, p):
    slow = exp(-(s.velocity**2) / (p.stribeck_velocity**2 + 1e-18))
    shares = {s.acting_force: 1 - p.output_share, s.carried_force: p.output_share}
    load = sum(
        share * abs(f) * (1 + p.driving_difference * sgn(f) * s.direction)
        for f, share in shares.items()
    )
    return p.coefficient * load * (1 + p.extra_at_rest * slow)


def gap(s, p):
    """What gives beyond half of the gap, by its stiffness, and the damping there."""
    beyond = max(abs(s.stretch) - p.gap / 2, 0.0) * sgn(s.stretch)
    return p.stiffness * beyond + (p.damping * s.stretch_rate if beyond else 0.0)


def wave(s, p):
    return sin(2 * pi * s.position / p.period + p.phase)


#: effect -> its law on signals s (its states among them), parameters p and those of others, o
LAWS = {
    "actuator_dead_zone": lambda s, p, o: sgn(s.command) * max(abs(s.command) - p.half_width, 0.0),
    "actuator_gain": lambda s, p, o: p.gain * s.command,
    "actuator_lag": lambda s, p, o: s.output,
    "actuator_saturation": lambda s, p, o: min(max(s.command, -p.limit), p.limit),
    "added_inertia": lambda s, p, o: p.inertia * s.acceleration,
    "bias": lambda s, p, o: p.force,
    "cogging": lambda s, p, o: p.amplitude * wave(s, p),
    "cogging_harmonic": lambda s, p, o: p.amplitude * wave(s, p),
    "coulomb": lambda s, p, o: p.level,
    "coulomb_asymmetry": lambda s, p, o: p.half_difference * s.direction,
    "coupling": lambda s, p, o: p.inertia * s.other_acceleration,
    "friction_drift": lambda s, p, o: 1 - p.fraction * (1 - exp(-s.time / p.time_constant)),
    "friction_memory": lambda s, p, o: s.film,
    "gravity": lambda s, p, o: p.amplitude * sin(s.position + p.phase),
    "hardening_spring": lambda s, p, o: p.stiffness * (s.position - p.neutral) ** 3,
    "load_dependent_friction": lambda s, p, o: load_dependent(s, p),
    "maxwell_slip": lambda s, p, o: s.force_1 + s.force_2 + s.force_3 + s.force_4,
    "position_dependent_friction": lambda s, p, o: 1 + p.amplitude * wave(s, p),
    "position_dependent_gain": lambda s, p, o: (
        s.command - s.command * p.fall * (s.position - p.centre) ** 2
    ),
    "presliding": lambda s, p, o: (
        p.stiffness * s.bristle + p.bristle_damping * bristle_rate(s.bristle, s, p.stiffness)
    ),
    "free_force": lambda s, p, o: through_values(
        CubicSpline, s.position, np.linspace(p.lower, max(p.upper, p.lower + 1e-9), 8), p
    ),
    "free_friction": lambda s, p, o: through_values(
        interp1d, abs(s.velocity), p.upper * np.linspace(0.0, 1.0, 8) ** 2, p
    ),
    "quadratic_drag": lambda s, p, o: p.drag * s.velocity**2 * sgn(s.velocity),
    "shear_thinning": lambda s, p, o: (
        p.drag * s.velocity * (s.velocity**2 + 1e-10) ** ((p.exponent - 1) / 2)
    ),
    "smoothed_coulomb": lambda s, p, o: (
        p.level * s.velocity / (p.smoothing_velocity + abs(s.velocity))
    ),
    "stops": lambda s, p, o: (
        p.stiffness * (max(s.position - p.upper, 0.0) + min(s.position - p.lower, 0.0))
    ),
    "spring": lambda s, p, o: p.stiffness * s.position,
    "stribeck": lambda s, p, o: p.extra_static_level / exp((s.velocity / p.stribeck_velocity) ** 2),
    "tip_friction": lambda s, p, o: p.level,
    "torque_ripple": lambda s, p, o: s.command * (1 + p.amplitude * wave(s, p)),
    "viscous": lambda s, p, o: p.damping * s.velocity,
    "viscous_asymmetry": lambda s, p, o: p.half_difference * abs(s.velocity),
    "viscous_temperature": lambda s, p, o: (
        o["viscous_damping"] * s.velocity * (exp(-p.coefficient * (s.temperature - 293.15)) - 1)
    ),
    "contact_damping": lambda s, p, o: p.damping * s.velocity,
    "contact_hardening": lambda s, p, o: p.depth * (s.penetration / p.depth) ** p.power,
    "impact_damping": lambda s, p, o: (
        o["environment_stiffness"] * s.penetration * s.velocity / p.reference_velocity
    ),
    "contact_hysteresis": lambda s, p, o: p.stiffness * s.bristle,
    "arm": lambda s, p, o: grip(s, p),
    "environment": lambda s, p, o: p.stiffness * s.penetration + p.damping * s.velocity,
}


def through_values(interpolation, at, places, p):
    """Value at a place, by scipy; constant beyond both ends."""
    values = [getattr(p, f"value_{i}") for i in range(1, 9)]
    return float(interpolation(places, values)(min(max(at, places[0]), places[-1])))


def bristle_rate(bristle, s, stiffness):
    return s.velocity - stiffness / s.level * abs(s.velocity) * bristle


def grip(s, p):
    return p.grip_stiffness * (s.position - s.arm_position) + p.grip_damping * (
        s.velocity - s.arm_velocity
    )


#: effect -> the rates of its hidden states
RATES = {
    "actuator_lag": lambda s, p: {"output": (s.command - s.output) / p.time_constant},
    "friction_memory": lambda s, p: {"film": (abs(s.velocity) - s.film) / p.time_constant},
    "presliding": lambda s, p: {"bristle": bristle_rate(s.bristle, s, p.stiffness)},
    "arm": lambda s, p: {
        "arm_position": s.arm_velocity,
        "arm_velocity": (
            (grip(s, p) - p.stiffness * s.arm_position - p.damping * s.arm_velocity) / p.inertia
        ),
    },
}
#: laws that no number alone states: a delay is of another time; a coupling is asked for below
OTHERS = {"actuation_delay", "backlash", "transmission_compliance"}


def drawn(rng, symbols):
    """Values of symbols: signals of either sign, parameters, depths and times above zero."""
    values = {s: float(rng.uniform(0.3, 2.0)) for s in sorted(symbols, key=str)}
    either = {"position", "velocity", "acceleration", "command", "acting_force", "bristle"}
    for symbol in values:
        if symbol.name in either or symbol.name.startswith("other_"):
            values[symbol] *= float(rng.choice([-1.0, 1.0]))
    values[SIGNALS["direction"]] = sgn(values.get(SIGNALS["velocity"], 1.0))
    values[SIGNALS["temperature"]] = float(rng.uniform(280.0, 320.0))
    return values


def spaces(effect, values):
    """The drawn values as signals with hidden states, parameters, and parameters of others."""
    states = effect.state_symbols()
    signals = SimpleNamespace(
        **{n: values[s] for n, s in {**SIGNALS, **states}.items() if s in values}
    )
    parameters = SimpleNamespace(
        **{n: values[s] for n, s in effect.symbols().items() if s in values}
    )
    return signals, parameters, {s.name: v for s, v in values.items()}


def test_every_law_is_written_out_here():
    assert set(LAWS) | OTHERS >= set(KNOWN)
    with_states = {n for n in KNOWN if n not in OTHERS and KNOWN[n].states}
    assert with_states == {*RATES, "maxwell_slip", "contact_hysteresis"}


@pytest.mark.parametrize("name", sorted(set(LAWS) & set(KNOWN)))
def test_a_law_is_the_equation_of_its_file(name):
    effect, rng = KNOWN[name], np.random.default_rng(1)
    law, rates = effect.expression(), effect.rates()
    symbols = {
        *law.free_symbols,
        *effect.symbols().values(),
        *effect.state_symbols().values(),
        *(s for rate in rates.values() for s in rate.free_symbols),
        *(SIGNALS[n] for n in ("velocity", "position", "level")),
    }
    for number in range(7):
        values = drawn(rng, symbols)
        if not number:  # where a law leaves a part out for a value, it is no other value
            values |= dict.fromkeys(effect.symbols().values(), 1.0)
        s, p, o = spaces(effect, values)
        numbers = {symbol: sp.Float(value) for symbol, value in values.items()}
        assert float(law.xreplace(numbers)) == pytest.approx(
            LAWS[name](s, p, o), rel=1e-12, abs=1e-300
        )
        for state, rate in RATES.get(name, lambda s, p: {})(s, p).items():
            assert float(rates[state].xreplace(numbers)) == pytest.approx(rate, rel=1e-12), state


@pytest.mark.parametrize(
    ("name", "coupling"),
    [
        ("backlash", gap),
        (
            "transmission_compliance",
            lambda s, p: p.stiffness * s.stretch + p.damping * s.stretch_rate,
        ),
    ],
)
def test_the_force_between_two_sides_is_the_equation_of_its_file(name, coupling):
    rng = np.random.default_rng(2)
    for stretch in (-0.7, -0.2, 0.2, 0.7):
        p = SimpleNamespace(gap=1.0, stiffness=rng.uniform(1, 9), damping=rng.uniform(1, 9))
        s = SimpleNamespace(stretch=stretch, stretch_rate=rng.uniform(-1, 1))
        force = sp.sympify(KNOWN[name].coupling(s, p))
        assert float(force) == pytest.approx(coupling(s, p), rel=1e-12)


def test_elements_stick_by_their_stiffness_and_slip_at_their_levels():
    effect = KNOWN["maxwell_slip"]
    stops = effect.stops()
    parameters = {n: 0.1 * (i + 1) for i, n in enumerate(effect.symbols())}
    values = {symbol: parameters[n] for n, symbol in effect.symbols().items()}
    levels = {i: parameters[f"level_{i}"] for i in (2, 3, 4)}
    coulomb = 2.0 * sum(levels.values())
    levels[1] = 0.5 * coulomb
    values |= {SIGNALS["velocity"]: 2.0, sp.Symbol("coulomb_level", real=True): coulomb}
    for i, level in levels.items():
        rate, stop = stops[f"force_{i}"]
        assert float(rate.subs(values)) == pytest.approx(2.0 * parameters[f"stiffness_{i}"])
        for grown in (1.0, 3.0):  # under more load, every element slips at as much more
            values[SIGNALS["level"]] = grown * coulomb
            assert float(stop.subs(values)) == pytest.approx(grown * level)
