"""Claims on the passivity of the compensated device, each with its proof or evidence."""

from __future__ import annotations

import re
from dataclasses import replace

from ..base.rounding import round_down, round_near, round_up
from ..blocks import Body, Value
from ..controllers import Controller
from ..diagrams import haptic_interface
from ..passivity import (
    Claim,
    Evidence,
    Proof,
    Refutation,
    any_environment,
    bounded_compensation,
    dahl_compensation,
    delayed_small_motion,
    hand_port,
    positive_real,
)
from ..passivity.identified import effects_left_open, extend_to_device
from ..passivity.theorems.lugre import add_bristle_damping
from ..realise.damping_interval import damping_interval, small_motion_damping
from ..realise.friction_interval import FrictionInterval, value_interval
from ..realise.reach import Reach
from .chosen import ProposedController
from .linear import without_friction


def compliant_claim(
    body: Body, chosen: ProposedController, friction: FrictionInterval, *, gain: float
) -> Claim | None:
    """Claim on passivity of the cancellation through the identified compliance; None without one.

    Friction is that of the motor side, as in the effect; friction of the link is taken as zero and
    would only help.
    """
    values = {n: v.value for n, v in body.parameters.items()}
    tip = values.get("transmission_compliance.tip_inertia", 0.0)
    # the equation of the motor side: what moves behind the compliance has a separate one
    motor = float(body.equation().inertia.subs(body.numbers()))
    law = chosen.controller.stages[0].law
    if tip <= 0 or motor <= 0 or not law.bristle_stiffness:
        return None
    numbers = chosen.controller.names()
    level, stiffness = (
        numbers[f"{law.name}.{law.bound}"],
        numbers[f"{law.name}.{law.bristle_stiffness}"],
    )
    return any_environment(
        motor_level=_decimal(round_down(friction.lowest.low, digits=4)),
        link_level=0,
        transmission_stiffness=_decimal(
            round_near(values["transmission_compliance.stiffness"], digits=6)
        ),
        transmission_damping=_decimal(
            round_near(values["transmission_compliance.damping"], digits=6)
        ),
        compensator_level=_decimal(round_up(level * gain, digits=6)),
        compensator_stiffness=_decimal(round_up(stiffness * gain, digits=6)),
        motor_inertia=_decimal(round_near(motor, digits=6)),
        link_inertia=_decimal(round_near(tip, digits=6)),
    )


def cancellation_claims(
    body: Body,
    chosen: ProposedController,
    friction: FrictionInterval,
    reach: Reach,
    *,
    gain: float,
    late: float,
    errors: float,
) -> list[Claim]:
    """Claims on friction and its cancellation, at the worst ends of all intervals.

    gain: acting force per commanded force;  late: delay of the cancellation's force, s
    errors: half width of the intervals in standard errors
    """
    # what actuation makes of a command is in its gain and in how late it is
    actuation = [e.name for e in body.effects if e.role == "actuation"]
    open_ones = effects_left_open(body, reach, errors=errors)
    left = {name: why for name, why in open_ones.items() if name not in actuation}
    claims = _friction_claims(body, chosen, friction, reach, gain=gain, late=late, errors=errors)
    return [extend_to_device(c, over=friction.over, left=left) for c in claims]


def _friction_claims(
    body: Body,
    chosen: ProposedController,
    friction: FrictionInterval,
    reach: Reach,
    *,
    gain: float,
    late: float,
    errors: float,
) -> list[Claim]:
    """Claims on friction and its cancellation alone."""
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
    damped = body.parameters.get("presliding.bristle_damping", Value(0.0, fixed=True))
    bristle = value_interval(damped, errors=errors)
    viscous = damping_interval(body, reach, errors=errors).least
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
                damping=_decimal(round_down(small_motion_damping(body, errors=errors), digits=4)),
                compensator_stiffness=_decimal(stiffness),
                delay=_decimal(late),
                presliding_stiffness=presliding,
            )
        )
    return claims


def feedback_claim(body: Body, force_feedback: Controller) -> Claim:
    """Claim on passivity of the device's linear part under continuous, undelayed feedback."""
    plain = without_friction(body)
    for effect in [e for e in plain.effects if e.role in ("actuation", "structure", "contact")]:
        plain = plain.without_effect(effect.name)
    port, _ = hand_port(haptic_interface(plain, force_feedback=force_feedback))
    claim = positive_real(port)
    return replace(claim, statement=f"without friction, sampling and delay {claim.statement}")


#: what a unit of claims is called on a revolute axis
_REVOLUTE = {"N s/m": "N*m*s/rad", "N/m": "N*m/rad", "N": "N*m"}


def use_units_of(axis: str, claim: Claim) -> Claim:
    """The claim with the units of an axis; claims are stated for a prismatic axis."""
    if axis == "prismatic":
        return claim

    def turned(text: str) -> str:
        return re.sub(r"\bN s/m\b|\bN/m\b|\bN\b", lambda m: _REVOLUTE[m[0]], text)

    verdict = claim.verdict
    if isinstance(verdict, Proof | Evidence):
        verdict = replace(verdict, unit=turned(verdict.unit))
    elif isinstance(verdict, Refutation):
        verdict = replace(verdict, method=turned(verdict.method))
    return Claim(turned(claim.statement), verdict)


def _decimal(value: float) -> str:
    """The number as decimal text, so that a claim holds for exactly the printed number."""
    return f"{value:.12g}"
