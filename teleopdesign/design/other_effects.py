"""What C cancels beside a constant friction level: the effects that the diagnosis found.

Forces that store energy (gravity, springs, cogging, a constant force) are cancelled by their own
laws, gains and ripple of the actuator are divided out, and a smoothed cancellation follows the
friction level over place, load, speed and direction. All are one control law, `cancel`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import sympy as sp

from ..base.sentences import round_down
from ..base.units import unit_of
from ..blocks import Body, compose_equation
from ..controllers import Controller, cancel
from ..effects import SIGNALS, depends_on_position, depends_on_time, period
from ..frequency.frozen_friction import FRICTION
from ..passivity import Claim, Evidence
from ..realise.simulated import without_absent
from .cancellation import ProposedController, Reason
from .device import Device

_X, _ACTING = SIGNALS["position"], SIGNALS["acting_force"]
LEVEL = ("friction_level", "friction_factor")
SMOOTHING = "smoothing_velocity"
Values = Mapping[str, Mapping[str, float]]


def forces_to_cancel(device: Device) -> Values:
    """Effects of place and actuation that C cancels, with the values that it takes.

    A force that grows with position without bound, as of a spring, is cancelled like a friction
    level: a part of the least that it may be. Then no error of it makes the sum unstable.
    """
    wanted: dict[str, dict[str, float]] = {}
    body, assumptions = device.body, device.stated
    for effect in (e for e in without_absent(body).effects if device.cancels(e)):
        known = {n: body.parameters[f"{effect.name}.{n}"] for n in effect.parameters}
        values = {n: v.value for n, v in known.items()}
        grows = effect.role == "force" and depends_on_position(effect) and period(effect) is None
        if grows and (strength := effect.strength) is not None:
            value = known[strength]
            half = 0.0 if math.isnan(value.stderr) else assumptions.errors * value.stderr
            least = round_down(assumptions.fraction * max(abs(value.value) - half, 0.0))
            values[strength] = math.copysign(least, value.value)
        wanted[effect.name] = values
    return wanted


def following_cancellation(
    smoothed: ProposedController, device: Device
) -> ProposedController | None:
    """A smoothed cancellation that follows the level; None where the level does not vary.

    smoothed: with a constant level
    The part c of the estimated level that it cancels keeps c est <= level everywhere. Where the
    level grows with the acting force, C itself changes that by at most its own size and that of
    the other forces that it cancels: c (1 + L) est <= level - L X, L the largest slope.
    raises ModelError: no bound is known of the level
    """
    body, assumptions = device.body, device.stated
    present = without_absent(body)
    levels = (e for e in present.effects if e.role in LEVEL and not depends_on_time(e))
    keep = [e for e in levels if not device.why_not(e)]
    names = {e.name for e in keep}
    keep = [e for e in keep if e.role == "friction_level" or e.needs <= names]
    level = present.level()
    estimate = compose_equation(tuple(keep)).level.subs(body.numbers())
    if not estimate.free_symbols:
        return None

    slope = 0.0
    if level.has(_ACTING):
        slope = -device.least(-sp.Abs(sp.diff(level, _ACTING)), present)
    most = -device.least(-sp.Abs(_force_of_place(device)), present) if slope else 0.0
    ratio = device.least((level - slope * most) / estimate, present) / (1 + slope)
    if ratio <= 0:
        return None
    part = round_down(assumptions.fraction * ratio / device.gain)
    values = {e: {n: body.parameters[f"{e.name}.{n}"].value for n in e.parameters} for e in keep}
    for effect in (e for e in keep if e.role == "friction_level"):
        assert effect.strength is not None
        values[effect][effect.strength] *= part
    (reason,) = (r for r in smoothed.reasons if r.parameter.endswith(SMOOTHING))
    made = cancel(values, smoothing_velocity=reason.value)
    why = (
        f"{part:.4g} of the identified level: {assumptions.fraction:g} of what is certain within "
        f"{assumptions.errors:g} standard errors everywhere, so that f_D <= f_C (P37 to P39)"
    )
    return ProposedController(made, _reasons(made, body, {SMOOTHING: reason.why}, why))


def with_forces(friction: ProposedController | None, device: Device) -> ProposedController | None:
    """The cancellation of friction and of all that C makes up for beside it, in one law."""
    body, assumptions = device.body, device.stated
    values = {n: dict(v) for n, v in forces_to_cancel(device).items()}
    if not values:
        return friction
    part = f"{assumptions.fraction:g} of the least within {assumptions.errors:g} standard errors"
    whys = {
        f"{name}.{n}": part
        for name, stated in values.items()
        for n, value in stated.items()
        if value != body.parameters[f"{name}.{n}"].value
    }
    smoothing = None
    for reason in () if friction is None else friction.reasons:
        name = reason.parameter.partition(".")[2]
        name = {"level": "coulomb.level", "stiffness": "presliding.stiffness"}.get(name, name)
        whys[name] = reason.why
        effect, _, parameter = name.partition(".")
        if parameter:
            values.setdefault(effect, {})[parameter] = reason.value
        elif name == SMOOTHING:
            smoothing = reason.value
    made = cancel(values, smoothing_velocity=smoothing)
    return ProposedController(made, _reasons(made, body, whys, "as identified"))


def _reasons(made: Controller, body: Body, whys: Mapping[str, str], why: str) -> tuple[Reason, ...]:
    """A reason for each number; whys: those that are known, by the parameter without its law."""
    (stage,) = made.stages
    whys = {**whys, "zero": "the zero of the recorded position: give the device's own"}
    return tuple(
        Reason(
            f"{stage.name}.{n}",
            value,
            unit_of(stage.law.parameters[n].quantity, body.axis),
            whys.get(n, why),
        )
        for n, value in stage.values.items()
    )


def _force_of_place(device: Device) -> sp.Expr:
    """Force of place that C cancels, over the position."""
    total: sp.Expr = sp.S(0)
    for name, numbers in forces_to_cancel(device).items():
        effect = device.body.effect(name)
        if effect.role == "force":
            placed = {s: numbers[n] for n, s in effect.symbols().items()}
            total += effect.expression().subs(placed)
    return total


def late_force_claim(device: Device) -> Claim | None:
    """Whether damping takes what forces of place give out because C cancels them late.

    With abs(f') <= K and a delay T of the force, its hold included,

        integral of (f(x(t)) - f(x(t - T))) v dt <= K T integral of v^2 dt

    returns: None where C cancels no force that depends on place
    """
    slope = sp.diff(_force_of_place(device), _X)
    if slope == 0:
        return None
    steepest, late = -device.least(-sp.Abs(slope)), device.held_delay
    needed, damping = steepest * late, device.damping
    unit, stiff = (unit_of(q, device.body.axis) for q in ("damping", "stiffness"))
    searched = (
        f"slope of at most {steepest:.4g} {stiff}, late by "
        f"{1e3 * late:.3g} ms: {needed:.3g} {unit} are needed, {damping:.3g} {unit} are certain"
    )
    holds = damping >= needed
    statement = "damping takes the energy that forces of place give out, cancelled late"
    return Claim(statement, Evidence(holds, searched, damping - needed, unit))


def not_cancelled(device: Device, cancellation: ProposedController | None) -> Mapping[str, str]:
    """Effects of the body that C does not cancel -> why."""
    stages = () if cancellation is None else cancellation.controller.stages
    names = {n.partition(".")[0] for s in stages for n in s.law.parameters}
    takes_level = any(s.law.bound or "coulomb" in names for s in stages)
    reasons: dict[str, str] = {}
    for effect in without_absent(device.body).effects:
        if effect.name in names or (effect.role == "friction_shape" and takes_level):
            continue
        if effect.name == "coulomb" and takes_level:
            continue
        why = device.why_not(effect)
        if effect.role in FRICTION:
            why = "only its least level" if takes_level else "no level is certain"
        elif not why:
            why = "it damps" if effect.energy == "dissipates" else "it may supply energy"
        reasons[effect.name] = why
    return reasons
