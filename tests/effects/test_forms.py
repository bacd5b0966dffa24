"""The residual along a motion: against an independent simulation, and against its own tangents."""

import math
from dataclasses import replace

import numpy as np
import pytest
import truth_simulator
from effects.along import (
    INERTIA,
    LEVEL,
    NAMES,
    body_of,
    encoded,
    motion_along,
    signals,
    typical,
    unled,
    with_needs,
)
from excitation import fit_record
from truth_effects import PUBLIC

from teleopdesign.blocks import Value
from teleopdesign.effects import EFFECTS, SIGNALS, make_rubbing_structure
from teleopdesign.realise.along_motion import residual_along
from teleopdesign.realise.scan import coupled_scan
from teleopdesign.realise.traced import Along, Traced

STEP = 1e-6  # m, of the encoder
RATE = 1000.0
INSIDE = slice(250, -250)  # 0.25 s at each end, as in the force error

#: N/m, the typical one is for a bristle; kg, a tip lighter than the rest, for impacts of one that
#: is heavier amplify every difference
VALUES = {"spring.stiffness": 200.0, "backlash.tip_inertia": 0.03}
#: those that the simulator knows too
COMMON = [n for n in NAMES if n in PUBLIC and n != "friction_memory"]


def true_values(*names):
    """Parameters of the truth simulator for the body that `modelled` makes."""
    values = {"inertia": INERTIA, "level": LEVEL}
    needed = [n for name in names for n in with_needs(name)]
    if "environment" in needed:
        values |= {
            "has_contact": 1.0,
            "contact_stiffness": typical("environment", "stiffness"),
            "contact_position": typical("environment", "contact_position"),
        }
    for one in needed:
        for parameter, (known, _) in PUBLIC.get(one, {}).items():
            values[known] = VALUES.get(f"{one}.{parameter}", typical(one, parameter))
    if "contact_power" in values:  # there the stiffness is per metre to the power
        depth = typical("contact_hardening", "depth")
        values["contact_stiffness"] *= depth ** (1.0 - values["contact_power"])
    values["inertia"] += values.pop("added_inertia", 0.0)
    values["inertia"] -= values.get("tip_inertia", 0.0)  # the package counts both sides
    values["has_tip"] = float("tip_inertia" in values)
    values["tip_bristle"] = values.get("tip_level", 0.0) / (0.3 * STEP)
    return values


def modelled(*names):
    """The body at the values that are simulated; what the simulator does not know is zero."""
    unknown = {
        f"{name}.{n}": 0.0
        for name in set(names) & set(PUBLIC) & set(EFFECTS)
        for n, p in EFFECTS[name].parameters.items()
        if p.optional and n not in PUBLIC[name]
    }
    values = {n: v for n, v in VALUES.items() if n.split(".")[0] in names}
    return body_of(*names, values=unknown | values)


def simulated(*names, step=STEP):
    """Readings of a device with these effects and Coulomb friction under a position controller.

    Coulomb friction is a bristle whose give, 0.3 encoder steps, cannot be seen.
    step: m, of the encoder
    """
    x, v = fit_record(np.random.default_rng(5), RATE, 6.0, "normal", 16.0)
    drive = truth_simulator.Drive.zero(len(x))
    drive.reference[:, 0], drive.reference_velocity[:, 0] = 0.01 * x, 0.01 * v
    drive.direct[:, 0] = signals(3, len(x))[2]
    values = true_values(*names) | {"kp": INERTIA * 40.0**2, "kd": 1.5 * INERTIA * 40.0}
    soft = values.pop("presliding", None)
    hard = (LEVEL + values.get("extra_static_level", 0.0)) / (0.3 * step)
    values["bristle_stiffness"] = soft or hard
    values["bristle_damping"] = (
        values.get("bristle_damping", 0.0) if soft else 0.3 * math.sqrt(hard * INERTIA)
    )
    run = truth_simulator.simulate([truth_simulator.body(**values)], drive, RATE, 50)
    return motion_along(
        encoded(run.rows("x")[:, 0], step),
        run.command[:, 0],
        run.rows("interaction")[:, 0],
        resolution=step,
    )


def relative(residual, motion):
    """Force error of a residual."""
    measured = motion.lowpassed(motion.at_rows(motion.command) + motion.interaction)
    left = motion.lowpassed(residual.residual.value)
    return float(np.linalg.norm(left[INSIDE]) / np.linalg.norm(measured[INSIDE]))


@pytest.mark.parametrize("name", COMMON)
def test_the_true_model_leaves_next_to_nothing_of_an_independent_simulation(name):
    motion = simulated(name)
    names = list(dict.fromkeys(["coulomb", *with_needs(name)]))
    true = relative(residual_along(modelled(*names), motion), motion)
    others = [n for n in names if n != name]
    without = relative(residual_along(modelled(*others), motion), motion)
    # 1 um read off leaves 0.15 kg (2 pi 60 Hz)^2 0.3 um = 6 mN rms at most, 0.3 to 0.9 % of the
    # force with the samples at which a reversal is told
    assert true < 0.015
    assert without > 5 * true


@pytest.mark.parametrize(
    ("structure", "contact"),
    [  # each pair is a simulation of its own to compile
        ("transmission_compliance", ()),
        ("backlash", ("contact_hardening",)),
        pytest.param("transmission_compliance", ("contact_hardening",), marks=pytest.mark.slow),
        pytest.param("backlash", (), marks=pytest.mark.slow),
    ],
)
def test_what_a_device_touches_it_touches_with_its_tip(structure, contact):
    touched = ("environment", *contact)
    motion = simulated(*touched, structure)
    true = relative(residual_along(modelled("coulomb", *touched, structure), motion), motion)
    rigid = relative(residual_along(modelled("coulomb", *touched), motion), motion)
    assert true < 0.015
    assert rigid > 5 * true


def test_a_tip_that_dry_friction_holds_rests_and_lets_the_spring_wind_up():
    """A slow ramp of the body against a tip of 0.2 N: it goes when the spring has 0.2 N."""
    held = {"transmission_compliance.tip_inertia": 0.05, "transmission_compliance.stiffness": 1e3,
            "transmission_compliance.damping": 1.0, "tip_friction.level": 0.2}  # fmt: skip
    effect = unled(body_of("transmission_compliance", "tip_friction", values=held))
    body = effect.effects[0]
    held_tip = make_rubbing_structure(body, effect.tip_level())
    t = np.arange(1000) * 1e-3
    x = 4e-4 * t  # m; the spring has 0.2 N after 0.5 s
    zero = Traced(np.zeros_like(x), np.zeros((0, len(x))))
    signals = {SIGNALS["position"]: Traced(x, zero.tangent), SIGNALS["acceleration"]: zero}
    signals |= {SIGNALS["velocity"]: Traced(np.full_like(x, 4e-4), zero.tangent)}
    signals |= {SIGNALS["interaction_force"]: zero}
    hidden = coupled_scan(held_tip, Along(signals, effect.numbers(), (), 1e-3))
    tip = hidden[held_tip.state_symbols()["tip_position"]].value
    stuck = t < 0.49
    stretch = 1e3 * (x - tip)
    # it starts with the body's velocity, 4e-4 m/s, which friction of 4 m/s^2 stops in 0.1 ms
    assert np.abs(tip[stuck]).max() < 1e-3 * x[stuck].max() + 2e-7
    np.testing.assert_allclose(stretch[t > 0.9].mean(), 0.2, rtol=0.02)


def test_noise_that_swings_a_lightly_damped_tip_is_led_out_of_it(monkeypatch):
    """At 22 Hz, with a band of 60 Hz, what an encoder of 10 um leaves swings on in the tip."""
    structure = "transmission_compliance"
    monkeypatch.setitem(VALUES, f"{structure}.damping", 0.5)  # a fiftieth of the critical one
    motion = simulated(structure, step=1e-5)
    body = modelled("coulomb", structure)
    led, free = (relative(residual_along(b, motion), motion) for b in (body, unled(body)))
    wrong = replace(body, parameters={**body.parameters, f"{structure}.stiffness": Value(1.5e3)})
    assert led < 0.6 * free  # measured: 0.51
    assert relative(residual_along(wrong, motion), motion) > 3 * led


PARAMETERS = [(name, p) for name in NAMES for p in EFFECTS[name].parameters]


@pytest.mark.parametrize("seed", [1])
@pytest.mark.parametrize(
    ("name", "parameter"), [*PARAMETERS, (None, "inertia")], ids=lambda v: str(v)
)
def test_tangents_are_the_slopes_of_the_residual(name, parameter, seed):
    x, u, f = signals(seed)
    motion = motion_along(encoded(x, STEP), u, f, resolution=STEP)
    # with what makes states and levels interact, so that tangents pass through each other
    around = ["coulomb", "viscous", "actuator_lag", *(with_needs(name) if name else ())]
    names = list(dict.fromkeys(around))
    full = f"{name}.{parameter}" if name else parameter
    body = body_of(*names)
    value = body.parameters[full].value
    # 0.1 s: forty time constants of a state whose start is not asked for its slope
    steady_rows = slice(100, None)
    # small enough that clipped samples stay clipped; large enough against rounding (1e-16/1e-6)
    h = 1e-6 * value

    def left(at):
        return residual_along(body.with_values({full: at}), motion).residual.value[steady_rows]

    slope = (left(value + h) - left(value - h)) / (2 * h)
    tangent = residual_along(body, motion, [full]).residual.tangent[0, steady_rows]
    assert np.linalg.norm(slope) > 0
    # second order of h is 1e-12; rounding 1e-9 of the residual; a sample or two may change sides
    assert np.linalg.norm(tangent - slope) < 1e-3 * np.linalg.norm(slope)
