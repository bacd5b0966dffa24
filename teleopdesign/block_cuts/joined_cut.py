"""A cut of a body whose command is not recorded: the computer's laws and the body are one.

    Z_M L = R_A - R_M,    R_A = R_D + H (R_D - R_M) + C L as the laws give it

An effect in a law changes the command, and with it the force that the body leaves unexplained. So
its value and the parameters of the body are estimated together, on the residual of the body. Where
an effect of the body explains more, the law is left as stated.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..diagnose.command_values import CommandSolution, CommandValues, solve_with_command
from ..diagnose.criteria import CRITERIA
from ..diagnose.error import weigh_residuals
from ..diagnose.evidence import check_score
from ..diagnose.fit import Fit, estimate, standard_errors
from ..diagnose.least_squares import sum_of_squares
from ..diagnose.noise_floor import noise_floor
from ..diagnose.rank import rank_candidates
from ..diagnose.residual import relative_residuals
from ..diagnose.search_plan import EFFORTS, Effort
from ..diagrams import Control, Moving
from ..effects.of_blocks.controllers import ControlEffect
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch, prepare
from ..model import Model
from .body import body_experiment
from .computer import Placed, UnevenRows, free_parameters, whole_passes_of
from .computer_search import ComputerLadder, ComputerStep, are_alike, climb, step_of
from .control_rows import ControlFit, ControlRows
from .cuts import Cut, feeding
from .diagram_experiment import DiagramExperiment
from .half_steps import command_by_laws, laws_of_command

#: starts of an effect that are followed, of those that promise most
_FOLLOWED = 2


@dataclass(frozen=True, eq=False)
class _Body:
    """The body estimated with the command of some effects."""

    placed: tuple[Placed, ...]
    prepared: Prepared
    fit: Fit

    @cached_property
    def known(self) -> Array:
        """What its parameters and the shift of the command's log can do, (rows, q) orthonormal."""
        return np.linalg.qr(np.hstack([self.fit.jacobian, self.fit.by_shift]))[0]


class JoinedData(ControlRows):
    """The records of a body's cut, and the laws that give its command."""

    def __init__(self, experiment: DiagramExperiment, cut: Cut, model: Model) -> None:
        moving = experiment.diagram.block(cut.name)
        assert isinstance(moving, Moving)
        part = laws_of_command(experiment, moving)
        super().__init__(part, [whole_passes_of(experiment, log) for log in experiment.logs])
        self.experiment, self.cut, self.model = experiment, cut, model
        blocks = [b for b in experiment.diagram.blocks if b.name in cut.blocks]
        self.places = tuple(b.name for b in blocks if isinstance(b, Control))
        self._feeding = feeding(experiment.diagram, cut)
        self._bandwidth = experiment.bandwidth
        self._stated = self._last = self._estimate_body((), model)
        self._bandwidth = self._stated.prepared.bandwidth
        counts = [
            len(next(iter(r.signals.values()))) for r in self._stated.prepared.experiment.records
        ]
        if counts != [log.count for log in experiment.logs]:
            raise UnevenRows(f"{experiment.title}: the clock of a log was mended: log every pass")

    @cached_property
    def blocks(self) -> dict[str, NDArray[np.intp]]:
        """Number of the block of each row of the residuals of the body."""
        fit = self._stated.fit
        return {"fit": fit.fit_blocks, "check": fit.check_blocks}

    def is_candidate(self, effect: str, at: str) -> bool:
        """A constant that is added to the command is the bias of the body."""
        return effect != "bias" or at not in self._feeding

    def body(self, placed: Sequence[Placed]) -> _Body:
        """The body with the command of these effects."""
        if self._last.placed != tuple(placed):
            self._last = self._estimate_body(placed, self._last.fit.model)
        return self._last

    def _estimate_body(self, placed: Sequence[Placed], start: Model) -> _Body:
        here = body_experiment(self.experiment, self.cut, placed)
        prepared = prepare(here, bandwidth=self._bandwidth)
        return _Body(tuple(placed), prepared, estimate(start, prepared, effort=EFFORTS.continued))

    def floors(self, seed: int = 0) -> dict[str, float]:
        """The cut -> error that its sensors alone leave beside the body and the stated laws."""
        model, random = self._stated.fit.model, np.random.default_rng(seed)
        return {self.cut.name: noise_floor(model, self._stated.prepared, random).value}

    def base(self) -> ControlFit:
        """The laws as stated, their free parameters estimated."""
        free = free_parameters(self.part.diagram, self.places)
        return self._refine([free]) if free else self._fit(self._stated)

    def estimate(self, before: ControlFit, effect: ControlEffect, at: str) -> ControlFit:
        """The best values of an effect and those before it."""
        starts = effect.starts(self.samples(at), self.rows[0].period)
        options = [(*before.placed, Placed(effect, at, float(v))) for v in starts]
        return self._refine(options, before.placed)

    def _refine(
        self, starts: Sequence[Sequence[Placed]], before: Sequence[Placed] = ()
    ) -> ControlFit:
        """Least squares over the values and the body's parameters, from the best start.

        before: effects beside which the body is known
        """
        here = self.body(before)
        promised = sorted(starts, key=lambda one: self._squares_along(here, one))[:_FOLLOWED]
        first = [self._solve(here, one, here.fit.model, EFFORTS.first_steps) for one in promised]
        placed, rough = min(first, key=lambda one: sum_of_squares(one[1].residual))
        placed, best = self._solve(here, placed, rough.model, EFFORTS.continued)
        errors = standard_errors(best.jacobian, best.residual, self.blocks["fit"])
        stderr = errors[: len(placed)] * self.coordinates(placed).unit
        return self._fit(self._estimate_body(placed, best.model), stderr.tolist())

    def _solve(
        self, here: _Body, placed: Sequence[Placed], model: Model, effort: Effort
    ) -> tuple[tuple[Placed, ...], CommandSolution]:
        """The best values of effects and of the body's parameters."""
        scaled = self.coordinates(placed)

        def stretches(x: Array) -> list[Stretch]:
            there = scaled.at(x)
            return [self._with_command(s, here.placed, there) for s in here.prepared.of("fit")]

        values = CommandValues(stretches, scaled.start, *scaled.bounds)
        solution = solve_with_command(model, here.prepared, values, effort)
        return scaled.at(solution.values), solution

    def _squares_along(self, here: _Body, placed: Sequence[Placed]) -> float:
        """Squares with other effects, where the body's parameters follow by their tangents."""
        stretches = here.prepared.of("fit")
        changed = [self._with_command(s, here.placed, placed) for s in stretches]
        parts = [r for r, _ in relative_residuals(here.fit.model, changed)]
        left, known = weigh_residuals(stretches, parts), here.known
        return sum_of_squares(left - known @ (known.T @ left))

    def _with_command(
        self, stretch: Stretch, before: Sequence[Placed], after: Sequence[Placed]
    ) -> Stretch:
        """A stretch with the command of other effects."""
        motion = stretch.motion
        log = next(i for i, r in enumerate(self.rows) if r.file == motion.file)
        change = (self._command(log, after) - self._command(log, before))[motion.rows]
        return replace(stretch, motion=replace(motion, command=motion.command + change))

    def _command(self, log: int, placed: Sequence[Placed]) -> Array:
        """The command that the laws give, at the rows of a log."""
        count = self.experiment.logs[log].count
        return command_by_laws(self.part, self.rows[log], count, placed)

    def _fit(self, body: _Body, stderr: Sequence[float] = ()) -> ControlFit:
        """The fit of a body, as one of the effects in its command."""
        errors = {"fit": body.fit.fit_error, "check": body.fit.check_error}
        residual = {"fit": body.fit.fit_residual, "check": body.fit.check_residual}
        size = {use: float(np.linalg.norm(r)) or 1.0 for use, r in residual.items()}
        return ControlFit(
            body.placed,
            0,
            {use: r * (errors[use] / size[use]) for use, r in residual.items()},
            {use: {self.cut.name: e} for use, e in errors.items()},
            tuple(stderr),
        )


def placed_for(cut: Cut, ladders: Mapping[str, ComputerLadder]) -> tuple[Placed, ...]:
    """Effects of laws for the command in a body's cut: of its own ladder, else of all.

    ladders: name of a joined cut -> its ladder
    """
    these = [ladders[cut.name]] if cut.name in ladders else ladders.values()
    return tuple({p.key: p for ladder in these for p in ladder.last.placed}.values())


def climb_joined(
    experiment: DiagramExperiment,
    cut: Cut,
    model: Model,
    report: Callable[[str], None],
    *,
    seed: int = 0,
) -> ComputerLadder:
    """Effects of the laws that explain more of a body's cut than any effect of the body.

    model: of the body
    raises ModelError: the rows are no passes of the computer, or a law cannot be predicted
    """
    data = JoinedData(experiment, cut, model)
    floors = data.floors(seed)
    return climb(data, floors, report, beside=lambda step: _compare_with_body(data, step))


def rank_laws(experiment: DiagramExperiment, cut: Cut, model: Model) -> ComputerStep:
    """The effects of the laws in a body's cut, each added alone;  model: of the body."""
    data = JoinedData(experiment, cut, model)
    step = step_of(data, data.base(), data.floors())
    return step if step.accepted is None else _compare_with_body(data, step)


def _compare_with_body(data: JoinedData, step: ComputerStep) -> ComputerStep:
    """The step, taken back where an effect of the body explains more."""
    assert step.accepted is not None
    here = data.body(step.before.placed)
    ranking = rank_candidates(here.fit, here.prepared, stated=data.model)
    able = [r for r in ranking.ranked if r.counts and r.score >= CRITERIA.significance]
    if not able:
        return step
    best, ours = min(able, key=lambda r: r.fit.check_error), data.body(step.accepted.fit.placed).fit
    less, more = sorted((ours, best.fit), key=lambda fit: fit.check_error)
    behind = max(check_score(more, less), 0.0)
    if are_alike(more.check_error, less.check_error, behind):
        return replace(step, of_body=(best.candidate.key,))
    if less is ours:
        return step
    why = f"{best.candidate.effect.name} at {data.cut.name} explains more"
    attempts = tuple(replace(a, refused=a.refused or why) for a in step.attempts)
    return replace(step, attempts=attempts, accepted=None, alike=())
