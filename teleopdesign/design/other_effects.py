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
from ..controllers import Controller, cancel, why_not_cancelled
from ..effects import SIGNALS, Effect, depends_on_position, depends_on_time, period
from ..frequency.frozen_friction import FRICTION
from ..passivity import Claim, Evidence
from ..realise.damping_interval import small_motion_damping
from ..realise.friction_interval import lowest_of
from ..realise.reach import Reach
from ..realise.simulated import without_absent
from .assumptions import Assumptions
from .cancellation import ProposedController, Reason

_X, _ACTING = SIGNALS["position"], SIGNALS["acting_force"]
LEVEL = ("friction_level", "friction_factor")
SMOOTHING = "smoothing_velocity"
Values = Mapping[str, Mapping[str, float]]


def is_cancelled(effect: Effect, body: Body) -> bool:
    """Whether C makes up for a force or a gain of the actuator, by the law of the effect."""
    stores = effect.role == "force" and effect.energy == "stores"
    return (stores or effect.role == "actuation") and not _why_not(effect, body)


def _why_not(effect: Effect, body: Body) -> str:
    numbers = {n: body.parameters[f"{effect.name}.{n}"].value for n in effect.parameters}
    return why_not_cancelled(effect, [n for n, value in numbers.items() if value])


def forces_to_cancel(body: Body, assumptions: Assumptions) -> Values:
    """Effects of place and actuation that C cancels, with the values that it takes.

    A force that grows with position without bound, as of a spring, is cancelled like a friction
    level: a part of the least that it may be. Then no error of it makes the sum unstable.
    """
    wanted: dict[str, dict[str, float]] = {}
    for effect in (e for e in without_absent(body).effects if is_cancelled(e, body)):
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


def with_gains_divided_out(body: Body, *, reach: Reach, errors: float) -> tuple[Body, float]:
    """The body without the gains that C divides out, and their largest ratio to the estimates."""
    stages = tuple(e for e in body.effects if e.role == "actuation" and is_cancelled(e, body))
    if not stages:
        return body, 1.0
    gain = compose_equation(stages).acting / SIGNALS["command"]
    ratio = sp.simplify(gain / gain.subs(body.numbers()))
    least, _ = lowest_of(body, -ratio, reach, errors=errors)
    for effect in stages:
        body = body.without_effect(effect.name)
    return body, -least.low


def following_cancellation(
    smoothed: ProposedController,
    body: Body,
    reach: Reach,
    assumptions: Assumptions,
    *,
    gain: float,
) -> ProposedController | None:
    """A smoothed cancellation that follows the level; None where the level does not vary.

    smoothed: with a constant level;  gain: acting force per commanded force
    The part c of the estimated level that it cancels keeps c est <= level everywhere. Where the
    level grows with the acting force, C itself changes that by at most its own size and that of
    the other forces that it cancels: c (1 + L) est <= level - L X, L the largest slope.
    raises ModelError: no bound is known of the level
    """
    present = without_absent(body)
    levels = (e for e in present.effects if e.role in LEVEL and not depends_on_time(e))
    keep = [e for e in levels if not _why_not(e, body)]
    names = {e.name for e in keep}
    keep = [e for e in keep if e.role == "friction_level" or e.needs <= names]
    level = present.level()
    estimate = compose_equation(tuple(keep)).level.subs(body.numbers())
    if not estimate.free_symbols:
        return None

    def least(law: sp.Expr) -> float:
        return lowest_of(present, law, reach, errors=assumptions.errors)[0].low

    slope = -least(-sp.Abs(sp.diff(level, _ACTING))) if level.has(_ACTING) else 0.0
    others = _force_of_place(forces_to_cancel(body, assumptions), body)
    most = -least(-sp.Abs(others)) if slope else 0.0
    ratio = least((level - slope * most) / estimate) / (1 + slope)
    if ratio <= 0:
        return None
    part = round_down(assumptions.fraction * ratio / gain)
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


def with_forces(
    friction: ProposedController | None, body: Body, assumptions: Assumptions
) -> ProposedController | None:
    """The cancellation of friction and of all that C makes up for beside it, in one law."""
    values = {n: dict(v) for n, v in forces_to_cancel(body, assumptions).items()}
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


def _force_of_place(values: Values, body: Body) -> sp.Expr:
    """Force of place that C cancels, over the position."""
    total: sp.Expr = sp.S(0)
    for name, numbers in values.items():
        effect = body.effect(name)
        if effect.role == "force":
            placed = {s: numbers[n] for n, s in effect.symbols().items()}
            total += effect.expression().subs(placed)
    return total


def late_force_claim(
    body: Body, reach: Reach, assumptions: Assumptions, *, late: float
) -> Claim | None:
    """Whether damping takes what forces of place give out because C cancels them late.

    late: delay of the force, its hold included, s. With abs(f') <= K,

        integral of (f(x(t)) - f(x(t - T))) v dt <= K T integral of v^2 dt

    returns: None where C cancels no force that depends on place
    """
    slope = sp.diff(_force_of_place(forces_to_cancel(body, assumptions), body), _X)
    if slope == 0:
        return None
    steepest = -lowest_of(body, -sp.Abs(slope), reach, errors=assumptions.errors)[0].low
    needed, damping = steepest * late, small_motion_damping(body, errors=assumptions.errors)
    unit = unit_of("damping", body.axis)
    searched = (
        f"slope of at most {steepest:.4g} {unit_of('stiffness', body.axis)}, late by "
        f"{1e3 * late:.3g} ms: {needed:.3g} {unit} are needed, {damping:.3g} {unit} are certain"
    )
    holds = damping >= needed
    statement = "damping takes the energy that forces of place give out, cancelled late"
    return Claim(statement, Evidence(holds, searched, damping - needed, unit))


def not_cancelled(body: Body, cancellation: ProposedController | None) -> Mapping[str, str]:
    """Effects of the body that C does not cancel -> why."""
    stages = () if cancellation is None else cancellation.controller.stages
    names = {n.partition(".")[0] for s in stages for n in s.law.parameters}
    takes_level = any(s.law.bound or "coulomb" in names for s in stages)
    reasons: dict[str, str] = {}
    for effect in without_absent(body).effects:
        if effect.name in names or (effect.role == "friction_shape" and takes_level):
            continue
        if effect.name == "coulomb" and takes_level:
            continue
        why = _why_not(effect, body)
        if effect.role in FRICTION:
            why = "only its least level" if takes_level else "no level is certain"
        elif not why:
            why = "it damps" if effect.energy == "dissipates" else "it may supply energy"
        reasons[effect.name] = why
    return reasons
