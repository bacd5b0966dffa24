"""Start values of a transmission with friction behind it, from simulated motions of the tip.

A search from starts without the friction ends at another minimum: a tip without friction rattles
through its gap at other moments than a tip that stays where it stops. Along a measured motion, the
tip's course depends on the gap, on the natural frequency of the tip and on its deceleration by
friction, but not on its inertia (`realise.tip_along`). The residual is linear in this inertia and,
to first order, in the parameters of the model without the tip. So each course of a grid needs one
small linear problem.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from ..model import Model
from ..realise.tip_along import tip_along
from .candidates import Candidate
from .fit import Fit, weigh_residuals
from .residual import residuals
from .search_plan import PLAN, SearchPlan
from .without_derivatives import minimise_nearby


@dataclass(frozen=True)
class TipStart:
    """A start: the model with one course of a tip and its best inertia, and the squares left.

    model: with the transmission, the friction behind it, and all other values at their linear best
    """

    model: Model
    squares: float


@dataclass(frozen=True)
class _Course:
    """Parameters of a tip's course: gap, frequency in contact, slowing by friction.

    gap: m or rad;  swing: rad/s
    slowing: deceleration of a sliding tip by friction (m/s^2, rad/s^2)
    """

    gap: float
    swing: float
    slowing: float


def tip_starts(
    base: Fit,
    prepared: Prepared,
    transmission: Candidate,
    friction: Candidate,
    *,
    plan: SearchPlan = PLAN,
) -> list[TipStart]:
    """The best few starts of a transmission with friction behind it, added to a base.

    base: a fit of these records without both effects
    returns: an empty list where a hand's force acts on the body, because the tip's course then
        depends on its inertia, or where no course explains anything
    """
    stretches, at = prepared.of("fit"), base.model.holder(transmission.at)
    here = [s for s in stretches if s.motion.body == at]
    if not here or any(np.any(s.motion.interaction) for s in here):
        return []
    problem = _linear_problem(base, stretches, at, plan)
    has_gap = "gap" in transmission.effect.parameters
    solved = [problem.solve(c) for c in _courses(here, prepared, plan, has_gap=has_gap)]
    solved = sorted((t for t in solved if t.inertia > 0.0), key=lambda t: t.squares)
    finer = [problem.refine(t.course, plan) for t in _select_apart(solved, plan)]
    return [
        TipStart(problem.model_at(t, transmission, friction, plan), t.squares)
        for t in sorted(finer, key=lambda t: t.squares)
    ]


@dataclass(frozen=True)
class _Solved:
    """A course with the best inertia of its tip (SI; 0: no inertia helps), and the squares left."""

    course: _Course
    inertia: float
    squares: float


@dataclass(frozen=True, eq=False)
class _LinearProblem:
    """The residual of a base, and the derivatives by which it can be reduced.

    damping_ratio: of the tip in contact
    left: (rows,) residual;  basis, triangle: QR of its derivatives (rows, p) by the free parameters
    """

    base: Fit
    stretches: tuple[Stretch, ...]
    at: str
    damping_ratio: float
    left: Array
    basis: Array
    triangle: Array

    def column(self, course: _Course) -> Array:
        """Decrease (rows,) of the residual per tip inertia, against a tip fixed to the body."""
        parts = []
        for s in self.stretches:
            motion = s.motion
            if motion.body != self.at:
                parts.append(np.zeros(len(s.keep)))
                continue
            pull = tip_along(
                motion.position,
                motion.velocity,
                motion.sample_time,
                gap=course.gap,
                swing=course.swing,
                damping_ratio=self.damping_ratio,
                slowing=course.slowing,
            )
            parts.append(motion.lowpassed(pull - motion.acceleration, s.keep))
        return weigh_residuals(self.stretches, parts)

    def solve(self, course: _Course) -> _Solved:
        """The best inertia for one course, with all free parameters of the base at their best."""
        new, rest = self._without_base(self.column(course)), self._without_base(self.left)
        size = float(new @ new)
        inertia = max(float(new @ rest) / size, 0.0) if size > 0.0 and np.isfinite(size) else 0.0
        return _Solved(course, inertia, float(rest @ rest) - inertia**2 * size)

    def refine(self, course: _Course, plan: SearchPlan) -> _Solved:
        """The best course near this one, within a factor of `SearchPlan.tip_near`."""
        start = np.array([v for v in (course.gap, course.swing, course.slowing) if v])

        def course_at(x: Array) -> _Course:
            values = (start * np.exp(x)).tolist()
            return _Course(*([] if course.gap else [0.0]), *values)

        best = minimise_nearby(
            lambda x: self.solve(course_at(x)).squares,
            np.zeros(len(start)),
            evaluations=plan.tip_refined,
            reach=float(np.log(plan.tip_near)),
        )
        return self.solve(course_at(best))

    def model_at(
        self, solved: _Solved, transmission: Candidate, friction: Candidate, plan: SearchPlan
    ) -> Model:
        """The model with both effects at this course, and all other values at their linear best."""
        course, inertia = solved.course, solved.inertia
        left = self.left - inertia * self.column(course)
        steps = np.linalg.lstsq(self.triangle, -(self.basis.T @ left), rcond=1e-10)[0]
        model = self.base.model.with_values(_values_after(self.base, np.asarray(steps)))
        for one in (transmission, friction):
            model = model.with_effect(one.effect, at=one.at)
        start = f"{transmission.at}.{transmission.effect.name}"
        (level,) = friction.effect.parameters
        values = {
            f"{start}.tip_inertia": inertia,
            f"{start}.stiffness": inertia * course.swing**2,
            f"{start}.damping": 2.0 * plan.tip_damping * inertia * course.swing,
            f"{friction.at}.{friction.effect.name}.{level}": inertia * course.slowing,
        }
        if course.gap:
            values[f"{start}.gap"] = course.gap
        return model.with_values(values)

    def _without_base(self, column: Array) -> Array:
        return column - self.basis @ (self.basis.T @ column)


def _linear_problem(
    base: Fit, stretches: tuple[Stretch, ...], at: str, plan: SearchPlan
) -> _LinearProblem:
    parts = residuals(base.model, stretches, base.free)
    left = weigh_residuals(stretches, [r for r, _ in parts])
    slopes = np.concatenate(
        [np.sqrt(s.weight) * d.T for s, (_, d) in zip(stretches, parts, strict=True)]
    )
    basis, triangle = np.linalg.qr(slopes)
    return _LinearProblem(base, stretches, at, plan.tip_damping, left, basis, triangle)


def _values_after(base: Fit, steps: Array) -> dict[str, float]:
    """Values of the base's free parameters after these steps, within their bounds."""
    values = {}
    for name, step in zip(base.free, steps.tolist(), strict=True):
        declared, value = base.model.declared(name), base.model.parameters[name].value
        # a search that begins at a bound may stay there
        least = 0.1 * value if declared.lower == 0.0 else declared.lower
        values[name] = float(np.clip(value + step, least, declared.upper))
    return values


def _courses(
    here: list[Stretch], prepared: Prepared, plan: SearchPlan, *, has_gap: bool
) -> Iterator[_Course]:
    scales = prepared.scales
    narrow = 2.0 * max(s.motion.step for s in here)
    wide = max(scales["travel"] / 4.0, 2.0 * narrow)
    gaps = np.geomspace(narrow, wide, plan.tip_gaps) if has_gap else np.zeros(1)
    slowest, fastest = plan.tip_swings
    swings = 2 * np.pi * prepared.bandwidth * np.geomspace(slowest, fastest, plan.tip_grid)
    little, much = plan.tip_slowings
    slowings = scales["acceleration"] * np.geomspace(little, much, plan.tip_grid)
    for gap in gaps:
        for swing in swings:
            for slowing in slowings:
                yield _Course(float(gap), float(swing), float(slowing))


def _select_apart(solved: list[_Solved], plan: SearchPlan) -> list[_Solved]:
    """The best few courses, without close neighbours on the grid."""
    kept: list[_Solved] = []
    for one in solved:
        if len(kept) == plan.tip_starts:
            break
        if not any(_are_close(one.course, other.course) for other in kept):
            kept.append(one)
    return kept


def _are_close(one: _Course, other: _Course) -> bool:
    """Whether all parameters of two courses agree within a factor of two."""
    pairs = (
        (one.gap, other.gap),
        (one.swing, other.swing),
        (one.slowing, other.slowing),
    )
    return all(max(a, b) <= 2.0 * min(a, b) for a, b in pairs)
