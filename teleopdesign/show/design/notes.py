"""Warnings on a design, as sentences made from its numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...base.units import unit_of
from ...design.quasi_static import slow_body
from ...diagnose.criteria import CRITERIA
from ...diagnose.noise_floor import say_floors
from ...realise.friction_interval import FrictionInterval
from ..registry import shows

if TYPE_CHECKING:
    from ...design import CasePrediction, Design

#: relative difference of two predictions of a force up to which no note is made
CLOSE = 0.1


@shows("notes")
def notes_on(design: Design) -> tuple[str, ...]:
    """The notes of a design; those on its model come first."""
    makers = (_model, _friction, _sensors, _list_left_out, _compare_predictions)
    return tuple(line for make in makers for line in make(design))


def _model(design: Design) -> Iterator[str]:
    if design.left > CRITERIA.adequate:
        yield (
            f"The model leaves {say_floors(design.left)} noise floors unexplained (verdict "
            f"{design.verdict}): standard errors hold within the model only, so the least level "
            "may be lower than these errors state, and the fraction "
            f"{design.assumptions.fraction:g} is the only margin against this."
        )
    if design.friction is not None and design.friction.unknown:
        names = ", ".join(design.friction.unknown)
        yield f"No standard error is known of {names}: taken as exact."


def _friction(design: Design) -> Iterator[str]:
    friction, unit = design.friction, unit_of("force", design.body.axis)
    if friction is None:
        yield "The model has no friction level: there is nothing to cancel."
        return
    if design.cancellation is None:
        yield _explain_no_proposal(friction, design.reach.travel, unit)
        return
    if not design.reach.both_ways:
        yield (
            "The records move the device in one direction only: friction in the other direction is "
            "taken from the model, without a record of it."
        )
    lowest, highest = friction.lowest.estimate, friction.highest.estimate
    if highest > 1.001 * lowest and not design.follows_level:
        yield (
            f"Friction lies between {lowest:.4g} and {highest:.4g} {unit} over {friction.over}: "
            f"its lowest level is cancelled, so that up to {highest - lowest:.3g} {unit} more than "
            "the margin is left."
        )
    bias = design.body.parameters.get("bias.force")
    if bias is not None and abs(bias.value) > 0:
        lower = max(friction.lowest.low - abs(bias.value), 0.0)
        yield (
            f"A constant force of {bias.value:.3g} {unit} is taken as gravity or an offset, which "
            "stores energy. No record distinguishes it from friction with two levels, one for each "
            f"direction. Then the lower level is {lower:.3g} {unit}, and motion in one direction "
            "only would need a level below that."
        )
    if design.cancellation.controller.stages[0].law.smoothing:
        yield (
            f"The records cannot show presliding shorter than {design.reach.unresolved:.3g} "
            f"{unit_of('position', design.body.axis)}. With such presliding, a smoothed "
            "cancellation is a negative damper in small motion: lower its level where "
            "the device hums at rest."
        )
    if friction.presliding is not None:
        yield (
            "Friction is a spring before it slides: a smoothed Coulomb cancellation is not "
            "proposed, because in small motion it is a negative damper, which such a spring does "
            "not stop."
        )
    if design.body.has("transmission_compliance") or design.body.has("backlash"):
        yield (
            "Only the friction on the motor side of the compliance is cancelled; a compensator "
            "level f_D within this friction is passive with any load beyond the compliance (P53)."
        )


def _explain_no_proposal(friction: FrictionInterval, travel: float, unit: str) -> str:
    if not friction.slides_within(travel):
        why = (
            f"friction does not come near its level within the recorded travel, half of which is "
            f"{friction.bristle_lengths(travel):.2g} bristle lengths: the level is a guess"
        )
    elif friction.lowest.low <= 0:
        why = (
            f"the least level within the interval is {friction.lowest.low:.3g} {unit} (at "
            f"{friction.where_lowest}), so that no level is certain to be passive"
        )
    elif friction.presliding is not None and friction.presliding.low <= 0:
        why = (
            "the presliding stiffness cannot be distinguished from zero, so no stiffness is "
            "certain to be passive (P43)"
        )
    else:
        why = (
            "friction is a spring in small motion, and no damping is identified that makes up for "
            "the delay of a cancellation there (P49)"
        )
    return f"No cancellation is proposed: {why}."


def _sensors(design: Design) -> Iterator[str]:
    if not design.reach.measures_force:
        yield (
            "No interaction force is a channel of this experiment: H needs a force sensor between "
            "hand and device; without such a sensor, only the case MBC can be built."
        )


def _list_left_out(design: Design) -> Iterator[str]:
    slow = {e.name for e in slow_body(design.body).effects}
    more = [e.name for e in design.body.effects if e.name not in slow]
    if gone := design.prediction.left_out:
        yield (
            f"Linear theory leaves out: {gone} (friction is a damper and spring of the same first "
            "harmonic)."
        )
    if design.prediction.rigid:
        yield (
            f"{design.prediction.rigid} cannot be simulated at these values: the simulation takes "
            "the device as rigid, with the inertia of both sides."
        )
    if more:
        yield f"Slow motion leaves out: {', '.join(more)}."


def _compare_predictions(design: Design) -> Iterator[str]:
    """Notes on cases where the quasi-static prediction and the simulation differ."""
    unit = unit_of("force", design.body.axis)
    known: list[CasePrediction] = []
    for case, p in design.prediction.cases.items():
        if p in known:  # without a cancellation two cases are the same as two others
            continue
        known.append(p)
        if p.failed:
            yield f"{case}: not simulated: {p.failed}."
            continue
        if p.apart <= CLOSE * p.simulated:
            continue
        reversing = p.at_reversals > 0.5
        where = "near reversals" if reversing else "away from reversals"
        share = 100 * (p.at_reversals if reversing else 1 - p.at_reversals)
        linear = ""
        if not math.isclose(p.linear, p.simulated, rel_tol=CLOSE):
            linear = f" Linear theory is off by {100 * (p.linear / p.simulated - 1):+.0f} %."
        yield (
            f"{case}: simulation and slow motion are {p.apart:.3g} {unit} rms apart, "
            f"{100 * p.apart / p.simulated:.0f} % of the simulated error, {share:.0f} % of the "
            f"squared difference {where} (below 0.3 of the peak speed).{linear}"
        )
