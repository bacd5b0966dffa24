"""Claims on the passivity of the compensated device, each with its proof or evidence.

Search for energy that the compensated device releases, over sinusoids of many sizes and speeds.

The hand moves the device along a prescribed sinusoid. The energy that the hand puts in over a
steady cycle is negative where the device releases energy. The simulation has all identified
effects, encoder, sampling and delay. The result is evidence for the simulated motions, and no proof
for others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from ..base.errors import GrowsWithoutBound, ModelError
from ..base.sentences import join_names, round_down, round_near, round_up
from ..base.units import unit_of
from ..blocks import Body, Value
from ..controllers import Controller
from ..diagrams import Diagram, haptic_interface
from ..effects import delayed
from ..frequency.frozen_friction import without_friction
from ..passivity import (
    Claim,
    Evidence,
    Unknown,
    any_environment,
    bounded_compensation,
    dahl_compensation,
    delayed_small_motion,
    hand_port,
    positive_real,
)
from ..passivity.identified import effects_left_open, extend_to_device
from ..passivity.linear.impedance import exact, impedance
from ..passivity.theorems.lugre import add_bristle_damping
from ..realise.damping_interval import damping_interval
from ..realise.friction_interval import FrictionInterval, value_interval
from ..realise.lti import S
from ..realise.reach import Reach
from ..realise.tips import led_motion
from ..simulate import Sampling
from .assumptions import StatedMotion
from .cancellation import ProposedController
from .device import Device
from .prediction import steady_cycle


def compliant_claim(device: Device, chosen: ProposedController) -> Claim | None:
    """Claim on passivity of the cancellation through the identified compliance; None without one.

    Friction is that of the motor side, as in the effect; friction of the link is taken as zero and
    would only help.
    """
    body, gain, friction = device.body, device.gain, device.friction
    values = {n: v.value for n, v in body.parameters.items()}
    tip = values.get("transmission_compliance.tip_inertia", 0.0)
    # the equation of the motor side: what moves behind the compliance has a separate one
    motor = float(body.equation().inertia.subs(body.numbers()))
    law = chosen.controller.stages[0].law
    if friction is None or tip <= 0 or motor <= 0 or not law.bristle_stiffness:
        return None
    numbers = chosen.controller.names()

    def near(value: float) -> str:
        return _decimal(round_near(value, digits=6))

    def most(name: str) -> str:
        return _decimal(round_up(numbers[f"{law.name}.{name}"] * gain, digits=6))

    return any_environment(
        motor_level=_decimal(round_down(friction.lowest.low, digits=4)),
        link_level=0,
        transmission_stiffness=near(values["transmission_compliance.stiffness"]),
        transmission_damping=near(values["transmission_compliance.damping"]),
        compensator_level=most(law.bound),
        compensator_stiffness=most(law.bristle_stiffness),
        motor_inertia=near(motor),
        link_inertia=near(tip),
    )


def cancellation_claims(device: Device, chosen: ProposedController) -> list[Claim]:
    """Claims on friction and its cancellation, at the worst ends of all intervals."""
    friction = device.friction
    assert friction is not None
    # what actuation makes of a command is in its gain and in how late it is
    actuation = [e.name for e in device.body.effects if e.role == "actuation"]
    open_ones = effects_left_open(device.body, device.reach, errors=device.stated.errors)
    left = {name: why for name, why in open_ones.items() if name not in actuation}
    if not chosen.controller.stages[0].law.bound:
        claims = [_claim_of_all_levels(friction, device.stated.fraction)]
    else:
        claims = _friction_claims(device, chosen, friction)
    return [extend_to_device(c, over=friction.over, left=left) for c in claims]


def _claim_of_all_levels(friction: FrictionInterval, fraction: float) -> Claim:
    """Claim on a cancellation that follows the level: its readings are late, and filtered.

    What it commands belongs to another moment, so the claim is for any level at any moment.
    """
    least = round_down(friction.lowest.low, digits=4)
    most = round_up(fraction * friction.highest.high, digits=6)
    claim = bounded_compensation(coulomb_level=_decimal(least), bound=_decimal(most))
    if claim.status == "proved":
        return claim
    why = "it follows a level, and a late or filtered reading may carry it above the friction then"
    return replace(claim, verdict=Unknown(why))


def _friction_claims(
    device: Device, chosen: ProposedController, friction: FrictionInterval
) -> list[Claim]:
    """Claims on friction and its cancellation alone."""
    # a command is held for a sample: on average half of it late, and at most all of it
    body, gain, late, errors = device.body, device.gain, device.held_delay, device.stated.errors
    law, numbers = chosen.controller.stages[0].law, chosen.controller.names()
    level = round_up(numbers[f"{law.name}.{law.bound}"] * gain, digits=6)
    least = round_down(friction.lowest.low, digits=4)
    if not law.bristle_stiffness or friction.presliding is None:
        return [bounded_compensation(coulomb_level=_decimal(least), bound=_decimal(level))]
    stiffness = round_up(numbers[f"{law.name}.{law.bristle_stiffness}"] * gain, digits=6)
    presliding = _decimal(round_down(friction.presliding.low, digits=4))
    most = _decimal(round_up(friction.highest.high, digits=4))
    pair = dahl_compensation(
        coulomb_level=_decimal(least),
        highest_level=most,
        compensator_level=_decimal(level),
        compensator_stiffness=_decimal(stiffness),
        presliding_stiffness=presliding,
    )
    pair = replace(pair, statement=f"{pair.statement}{CONTINUOUS}")
    damped = body.parameters.get("presliding.bristle_damping", Value(0.0, fixed=True))
    bristle = value_interval(damped, errors=errors)
    viscous = damping_interval(body, device.reach, errors=errors).least
    claims = [
        add_bristle_damping(
            pair,
            coulomb_level=_decimal(least),
            highest_level=most,
            stiffness=presliding,
            bristle_damping=_decimal(round_up(bristle.high, digits=4)),
            viscous_damping=_decimal(round_down(viscous.low, digits=4)),
        )
    ]
    if late > 0:
        claims.append(
            delayed_small_motion(
                damping=_decimal(round_down(device.damping, digits=4)),
                compensator_stiffness=_decimal(stiffness),
                delay=_decimal(late),
                presliding_stiffness=presliding,
            )
        )
    return claims


def feedback_claim(body: Body, force_feedback: Controller) -> Claim:
    """Claim on passivity of the device's linear part under continuous, undelayed feedback.

    It names what it leaves out. The coefficients of its impedance have six digits, as they are
    printed.
    """
    plain = without_friction(body)
    beside = [e for e in plain.effects if e.role in ("actuation", "structure", "contact")]
    laws = {e.name: (e.expression(), *e.rates().values()) for e in beside}
    late = {n for n, of_effect in laws.items() if any(x.atoms(delayed) for x in of_effect)}
    gone = [e.name for e in beside if not e.linear or e.name in late]
    for name in gone:
        plain = plain.without_effect(name)
    port, left_out = hand_port(haptic_interface(plain, force_feedback=force_feedback))
    gone += [name.rpartition(".")[2] for name in left_out]
    above, below = (
        sp.Poly([exact(round_near(float(c), digits=6)) for c in poly.all_coeffs()], S)
        for poly in (port.p, port.q)
    )
    rounded = impedance(above.as_expr() / below.as_expr())
    claim = positive_real(replace(rounded, unseen=port.unseen))
    without = join_names(["friction", "sampling", "delay", *gone])
    return replace(claim, statement=f"without {without} {claim.statement}")


def _decimal(value: float) -> str:
    """The number as decimal text, so that a claim holds for exactly the printed number."""
    return f"{value:.12g}"


#: end of a statement that the samples of a computer are no part of
CONTINUOUS = " in continuous time"
#: amplitudes and frequencies of the simulated motions, over those of the stated motion
SIZES, FREQUENCIES = (0.1, 0.3, 1.0), (1.0, 3.0, 10.0, 30.0)


@dataclass(frozen=True)
class CycleEnergy:
    """Energy that the hand puts in per cycle of a motion, J; -inf: signals grow without bounds."""

    motion: StatedMotion
    energy: float


def motions_around(motion: StatedMotion, reach: Reach) -> Iterator[StatedMotion]:
    """The stated motion, smaller and faster ones, up to the recorded speed."""
    for size in SIZES:
        for faster in FREQUENCIES:
            one = replace(
                motion, amplitude=size * motion.amplitude, frequency=faster * motion.frequency
            )
            if one.peak_speed <= reach.peak_speed:
                yield one


def energy_taken(diagram: Diagram, motion: StatedMotion, sampling: Sampling) -> CycleEnergy | None:
    """Energy that the hand puts in over a steady cycle, from a simulation; None: it has no step."""
    try:
        cycle = steady_cycle(diagram, motion, sampling)
    except GrowsWithoutBound:
        return CycleEnergy(motion, float("-inf"))
    except ModelError:
        return None
    power = cycle["E"].values * cycle[f"{led_motion(diagram, 'L')}_velocity"].values
    return CycleEnergy(motion, float(np.mean(power) / motion.frequency))


def energy_claim(
    diagram: Diagram, motion: StatedMotion, reach: Reach, sampling: Sampling, *, axis: str
) -> Claim:
    """Evidence, not proof, on whether the device takes energy along every simulated motion."""
    tested = [energy_taken(diagram, m, sampling) for m in motions_around(motion, reach)]
    trials = [t for t in tested if t is not None]
    statement = "the device takes energy from the hand"
    if not trials:
        return Claim(statement, Unknown("no step of a simulation resolves any of the motions"))
    supplying = [t for t in trials if t.energy < 0]
    # where it releases energy, the slowest such motion says from where on
    shown = min(supplying, key=lambda t: t.motion.frequency) if supplying else _least_energy(trials)
    size, unit = shown.motion.amplitude, unit_of("position", axis)
    frequencies = [t.motion.frequency for t in trials]
    words = "releases energy along" if supplying else "takes least along"
    if np.isinf(shown.energy):
        words = "lets signals grow beyond all bounds along"
    searched = (
        f"{len(trials)} sinusoids, {min(frequencies):.3g} to {max(frequencies):.3g} Hz, simulated "
        f"with sampling, delay and encoder; it {words} {size:.3g} {unit} at "
        f"{shown.motion.frequency:.3g} Hz"
    )
    if len(supplying) > 1:
        searched += f" and {len(supplying) - 1} more"
    if len(trials) < len(tested):
        searched += f"; no step resolves {len(tested) - len(trials)} more"
    margin = shown.energy if np.isfinite(shown.energy) else float("nan")
    return Claim(statement, Evidence(not supplying, searched, margin, "J a cycle"))


def _least_energy(trials: list[CycleEnergy]) -> CycleEnergy:
    return min(trials, key=lambda t: t.energy / t.motion.amplitude)
