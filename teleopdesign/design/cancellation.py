"""The motion-based cancellation C that the identified friction allows.

The cancelled level stays below the least level that friction may have, so that friction and
cancellation together dissipate energy: P37 to P39 for ideal Coulomb friction, whatever the law, P43
and P44 for friction that is a spring before it slides.

A proposed controller, with a reason for each of its numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from ..base.sentences import round_down, round_up
from ..base.shown import Shown
from ..base.units import unit_after_number, unit_of
from ..controllers import CANCEL, Controller, controller, laws_that_declare
from .device import Device


@dataclass(frozen=True)
class Reason:
    """The reason for the value (SI) of a parameter "law.parameter" of a proposed controller."""

    parameter: str
    value: float
    unit: str
    why: str

    def __str__(self) -> str:
        unit = unit_after_number(self.unit)
        return f"{self.parameter} = {self.value:.4g}{unit}: {self.why}"


@dataclass(frozen=True)
class ProposedController(Shown):
    """A controller and the reasons for its numbers.

    controller: stages in series, parameters in SI;  reasons: one for each chosen parameter
    """

    controller: Controller
    reasons: tuple[Reason, ...]

    @property
    def law(self) -> str:
        """Name of the first law of the controller."""
        return self.controller.stages[0].law.name

    @property
    def words(self) -> str:
        """The law, and the effects that it cancels: "cancel (cogging, coulomb)"."""
        if self.law != CANCEL:
            return self.law
        names = (n.split(".")[1] for n in self.controller.names() if n.count(".") > 1)
        return f"{CANCEL} ({', '.join(dict.fromkeys(names))})"


#: part of the largest passive stiffness that a Dahl cancellation takes on a presliding device
STIFFNESS_FRACTION = 0.9


def cancelled_level(device: Device) -> Reason | None:
    """The level to cancel, as a commanded force; None where no level is certain.

    It is None if the least level may be zero, or if the records never reach the level.
    """
    if (friction := device.friction) is None:
        return None
    assumptions, gain, sure = device.stated, device.gain, friction.lowest.low
    if sure <= 0 or not friction.slides_within(device.reach.travel):
        return None
    unit = unit_of("force", device.body.axis)
    value = round_down(assumptions.fraction * sure / gain)
    least = f"the least level within {assumptions.errors:g} standard errors, {sure:.4g}"
    why = f"{assumptions.fraction:g} of {least} {unit} (at {friction.where_lowest}"
    known = device.body.parameters.get("coulomb.level")
    why += ")" if known is None else f"; the identified Coulomb level is {known.value:.4g} {unit})"
    if gain != 1.0:
        why += f", over the {gain:.4g} {unit} that acts of a commanded {unit}"
    return Reason("level", value, unit, why + ", so that f_D <= f_C (P37 to P39)")


def dahl_cancellation(level: Reason, device: Device) -> ProposedController | None:
    """A Dahl cancellation with that level; None where presliding allows no stiffness."""
    reach, axis, counts = device.reach, device.body.axis, device.stated.counts
    acting = level.value * device.gain
    unit = unit_of("position", axis)
    lengths = {
        f"{counts:g} encoder steps of {reach.step:.3g} {unit}": counts * reach.step,
        f"{reach.unresolved:.3g} {unit}, below which the records show no presliding, so that P43 "
        "holds with one": reach.unresolved,
    }
    longest = max(lengths, key=lengths.__getitem__)
    limits = {f"a bristle length f_D/sigma_D of {longest}": acting / lengths[longest]}
    if (friction := device.friction) is not None and friction.presliding is not None:
        softest, most = friction.presliding.low, friction.highest.high
        late, damping = device.held_delay, device.damping
        if softest <= 0 or (late > 0 and damping <= 0) or math.isinf(most):
            return None
        passive = softest * math.sqrt(acting / most)
        why = f"{STIFFNESS_FRACTION:g} of the stiffest with sigma_D^2/f_D <= sigma_p^2/f_C over "
        stiff, force, damped = (unit_of(q, axis) for q in ("stiffness", "force", "damping"))
        why += f"the whole interval, sigma_p >= {softest:.4g} {stiff}, f_C <= {most:.4g} {force} "
        why += "(P43, P44)"
        limits = {why: STIFFNESS_FRACTION * passive}
        from ..passivity.theorems.delays import SINC_LEAST

        if late > 0:
            needed = damping / (float(SINC_LEAST) * late)
            limits[
                f"damping of at least 0.2172 sigma_D tau in small motion, {damping:.4g} {damped} "
                f"at {1e3 * late:.3g} ms (P49)"
            ] = needed
    why = min(limits, key=limits.__getitem__)
    stiffness = round_down(limits[why] / device.gain)
    law = laws_that_declare("bristle_stiffness")[0]
    made = controller(law.name, {law.bound: level.value, law.bristle_stiffness: stiffness})
    named = f"{law.name}.{law.bristle_stiffness}"
    reason = Reason(named, stiffness, unit_of("stiffness", axis), why)
    return ProposedController(made, (_name_reason(law.name, level), reason))


def smoothed_cancellation(level: Reason, device: Device) -> ProposedController:
    """A smoothed Coulomb cancellation with that level."""
    from ..realise.kernel import velocity_smoothing

    axis, share, step = device.body.axis, device.stated.count_force, device.reach.step
    period, filtered = device.sampling.period, device.sampling.velocity_bandwidth
    unit = unit_of("velocity", axis)
    count = step / period * velocity_smoothing(filtered, period)
    value = round_up(count * (1 / share - 1), digits=2)
    why = (
        f"one encoder step of {step:.3g} {unit_of('position', axis)} in a sample of "
        f"{1e3 * period:g} ms, through the {filtered:.3g} Hz velocity filter, is "
        f"{count:.3g} {unit}: it moves the force by no more than {share:g} of the level"
    )
    law = laws_that_declare("smoothing")[0]
    made = controller(law.name, {law.bound: level.value, law.smoothing: value})
    reason = Reason(f"{law.name}.{law.smoothing}", value, unit, why)
    return ProposedController(made, (_name_reason(law.name, level), reason))


def smoothing_name(names: Iterable[str], *, block: str = "") -> str | None:
    """The name of the parameter that smooths a law's step at rest; None if there is none.

    names: such as "law.parameter", after `block` if that is stated
    """
    declared = {f"{block}{law.name}.{law.smoothing}" for law in laws_that_declare("smoothing")}
    declared.add(f"{block}{CANCEL}.smoothing_velocity")
    return next((name for name in names if name in declared), None)


def _name_reason(law: str, level: Reason) -> Reason:
    return Reason(f"{law}.{level.parameter}", level.value, level.unit, level.why)
