"""Simulate a diagram for many parameter sets at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..diagrams import Diagram
from ..errors import ModelError, did_you_mean
from ..realise.simulated import refuse_massless
from .case_results import REDUCTIONS, CaseResults
from .cases import Group, columns_of, groups, list_refusals, set_case, simulated_values
from .on_grid import Input, samples_of
from .sampling import SAMPLED, Sampling
from .setup import Setup, prepare, simulated_form
from .trajectory import Trajectory
from .wave import GridKey, Wave

if TYPE_CHECKING:
    import xarray

    from ..realise.kernel import Timing
    from ..realise.side_by_side import LaneResults, Reduction


def simulate_many(
    diagram: Diagram,
    values: Mapping[str, ArrayLike],
    *,
    duration: float,
    inputs: Mapping[str, Input] | None = None,
    motion: Mapping[str, Trajectory] | None = None,
    initial: Mapping[str, float] | None = None,
    computer: Sampling | Literal["continuous"] = SAMPLED,
    step: float = 1e-4,
    give: float = 1e-5,
    long_step: Literal["refine", "refuse"] = "refine",
    keep: Sequence[str] = (),
    reduce: Mapping[str, tuple[Any, str]] | None = None,
    after: float = 0.0,
) -> xarray.Dataset:
    """Simulate every parameter set from t = 0, many side by side on all cores.

    values: parameter, such as "Z_m.coulomb.level" (the names of `Diagram.values`) -> its value in
        each case (SI), shape (n,), or one number for all
    keep: signals whose samples are kept, over `case` and `time`; none by default, so that memory
        does not grow with the duration
    reduce: name of a result -> (signal, what): "final", "maximum", "minimum", "peak" (largest
        size), "mean" or "rms" over the samples; or ((force, motion), "energy"), the energy (J) that
        the force has done on the motion. Default: the rms of every signal as "SIGNAL_rms" where
        nothing is kept, else none
    after: start of what is reduced, s
    other arguments: as in `simulate`, for all cases
    returns: variables over `case`; coordinates: the values, `step` (s) that each case took, and
        `reason` why a case has no numbers (they are NaN then), "" where it has. A case that fails
        does not touch the others
    raises ModelError: no such parameter or signal, arrays of different lengths, more samples kept
        than 2 GB; what fails in every case
    """
    columns = columns_of(diagram, values)
    cases = len(next(iter(columns.values()))) if columns else 1
    arguments: dict[str, Any] = {"duration": duration, "inputs": inputs, "initial": initial}
    arguments |= {"motion": dict(motion or {}), "computer": computer, "step": step, "give": give}
    wanted = None if reduce is None else dict(reduce)
    study = _Study(diagram, columns, arguments, long_step, tuple(keep), wanted, after)
    period = (SAMPLED if isinstance(computer, str) else computer).period
    result = CaseResults(cases)
    result.open_rows(samples_of(duration, period), period, study.keep)
    result.refuse(list_refusals(diagram, columns))
    study.run_all(result)
    return result.label(diagram, columns, study.reductions_of(result.numbers), duration)


class _Mistake(ModelError):
    """An error in the arguments that does not depend on the values of a case."""


@dataclass
class _Study:
    """The diagram, its cases, and the results that the caller wants."""

    diagram: Diagram
    columns: Mapping[str, np.ndarray]
    arguments: dict[str, Any]
    long_step: Literal["refine", "refuse"]
    keep: tuple[str, ...]
    reduce: dict[str, tuple[Any, str]] | None
    after: float

    def choose_reductions(self, columns: Sequence[str]) -> dict[str, tuple[Any, str]]:
        """The reductions that the caller wants; by default the rms of every column."""
        if self.reduce is None:
            return {} if self.keep else {f"{name}_rms": (name, "rms") for name in columns}
        return self.reduce

    def reductions_of(self, numbers: Iterable[str]) -> dict[str, tuple[Any, str]]:
        """The reductions of the result; by default those for which there are numbers."""
        if self.reduce is not None or self.keep:
            return self.choose_reductions(())
        return {name: (name.removesuffix("_rms"), "rms") for name in numbers}

    def run_all(self, result: CaseResults) -> None:
        """Simulate the cases group by group; raises ModelError: no case can be simulated."""
        first_error: ModelError | None = None
        for group in groups(self.diagram, self.columns, np.flatnonzero(result.open)):
            try:
                self.run(group, result)
            except _Mistake as error:
                raise ModelError(str(error)) from None
            except ModelError as error:
                first_error = first_error or error
                result.refuse(dict.fromkeys(map(int, group.cases), str(error)))
        if first_error is not None and not np.isfinite(result.steps).any():
            raise first_error

    def run(self, group: Group, result: CaseResults) -> None:
        """Simulate the cases of one structure."""
        from ..realise.side_by_side import rates_of_cases

        setup = prepare(group.diagram, **self.arguments)
        layout, equations = setup.program.layout, setup.program.equations
        kept, reductions = self._columns(setup)
        free = {x for delay in equations.delays for x in delay.free_symbols}
        late = tuple(equations.parameters[x] for x in sorted(free, key=str))
        numbers, reasons = simulated_values(
            group, self.columns, self._form, layout.parameters + late
        )
        result.refuse(reasons)
        many = len(layout.parameters)
        rates, states = rates_of_cases(setup.program, numbers[:, :many])
        delays = _delays(setup, late, numbers[:, many:])
        todo: dict[GridKey, list[int]] = {}
        for k, case in enumerate(group.cases):
            if not result.open[case]:
                continue
            state = layout.states[states[k]] if layout.states else ""
            try:
                inner = setup.ladder(self.long_step, delays[k]).first(float(rates[k]), state)
                setup.check_size(setup.timing(inner, delays[k]))
            except ModelError as error:
                result.refuse({int(case): str(error)})
                continue
            todo.setdefault((inner, delays[k]), []).append(k)
        waves = [Wave(todo, is_first=True)] if todo else []
        while waves:
            now, later = waves.pop().split(setup)
            finer = self._run_wave(
                setup,
                now,
                group.cases,
                numbers=numbers[:, :many],
                kept=kept,
                reductions=reductions,
                result=result,
            )
            waves += [wave for wave in (later, Wave(finer, is_first=False)) if wave.todo]

    def _run_wave(
        self,
        setup: Setup,
        wave: Wave,
        cases: np.ndarray,
        *,
        numbers: np.ndarray,
        kept: dict[str, int],
        reductions: dict[str, Reduction],
        result: CaseResults,
    ) -> dict[GridKey, list[int]]:
        """Run the cases of a wave; returns the cases that need a finer grid, by this grid."""
        from ..realise.side_by_side import execute_many

        runs = wave.runs(setup, numbers)
        samples, period = runs[0].timing.samples, setup.sampling.period
        outcomes = execute_many(
            setup.program,
            runs,
            start=setup.initial,
            kept=list(kept.values()),
            reductions=list(reductions.values()),
            begin=min(round(self.after / period), samples),
        )
        finer: dict[GridKey, list[int]] = {}
        for (grid, members), run, outcome in zip(wave.todo.items(), runs, outcomes, strict=True):
            here = cases[np.array(members)]
            next_steps = self._next_steps(setup, run.timing, grid, here, outcome, result)
            for i, inner in next_steps.items():
                finer.setdefault((inner, grid[1]), []).append(members[i])
            done = result.open[here]
            done[list(next_steps)] = False
            result.take(here[done], run.timing.step, outcome, done, (*kept,), (*reductions,))
        return finer

    def _next_steps(
        self,
        setup: Setup,
        timing: Timing,
        grid: GridKey,
        cases: np.ndarray,
        outcome: LaneResults,
        result: CaseResults,
    ) -> dict[int, int]:
        """Index in `cases` -> steps per sample of cases that need finer steps; refuses failures."""
        finer: dict[int, int] = {}
        ladder = setup.ladder(self.long_step, grid[1])
        for i, case in enumerate(map(int, cases)):
            try:
                if not outcome.is_finite[i]:
                    self._refuse_massless(case)
                inner = ladder.next(timing, float(outcome.worst[i]), bool(outcome.is_finite[i]))
                setup.check_size(setup.timing(inner, grid[1]))
            except ModelError as error:
                result.refuse({case: str(error)})
                continue
            if inner != timing.inner:
                finer[i] = inner
        return finer

    def _refuse_massless(self, case: int) -> None:
        """Raise ModelError if a body of this case has no inertia."""
        there = set_case(self.diagram, self.columns, case)
        if 0 in there.values.values():
            refuse_massless(self._form(there), self.arguments["motion"] or ())

    def _form(self, diagram: Diagram) -> Diagram:
        a = self.arguments
        return simulated_form(diagram, motion=a["motion"], computer=a["computer"], give=a["give"])

    def _columns(self, setup: Setup) -> tuple[dict[str, int], dict[str, Reduction]]:
        """Columns of the signals that are kept and reduced, if this structure has them."""
        from ..realise.side_by_side import Reduction

        layout = setup.program.layout
        names = layout.columns

        def column(name: Any, where: str) -> int | None:
            if name in names:
                return names.index(name)
            # a hidden state of an effect that is absent in these cases is there in others
            if any(
                isinstance(name, str) and name.startswith(f"{b.name}_") for b in self.diagram.blocks
            ):
                return None
            raise _Mistake(
                f'simulate_many: {where}: no signal "{name}", has {", ".join(names)}'
                f"{did_you_mean(str(name), names)}"
            )

        kept = {name: column(name, "keep") for name in self.keep}
        reductions: dict[str, Reduction] = {}
        for name, what in self.choose_reductions(names).items():
            signal, kind = _reduction(name, what)
            if (
                name in self.keep
                or name in self.columns
                or name in ("case", "time", "step", "reason")
            ):
                raise _Mistake(
                    f'simulate_many: reduce: "{name}" is taken: call the result otherwise'
                )
            if kind == "energy":
                force, motion = signal
                first, other = column(force, name), column(f"{motion}_velocity", name)
            else:
                first = other = column(signal, name)
            if first is not None and other is not None:
                reductions[name] = Reduction(kind, first, other)
        return {n: i for n, i in kept.items() if i is not None}, reductions


def _reduction(name: str, what: Any) -> tuple[Any, str]:
    """A reduction as (signal, kind) or ((force, motion), "energy"), checked."""
    expected = 'expected (signal, "rms") or ((force, motion), "energy")'
    if not (isinstance(what, tuple) and len(what) == 2):
        raise _Mistake(f"simulate_many: reduce: {name}: found {what!r}, {expected}")
    signal, kind = what
    if kind not in REDUCTIONS:
        raise _Mistake(
            f'simulate_many: reduce: {name}: no reduction "{kind}", has {", ".join(REDUCTIONS)}'
            f"{did_you_mean(str(kind), REDUCTIONS)}"
        )
    is_port = isinstance(signal, tuple) and len(signal) == 2
    if is_port != (kind == "energy"):
        raise _Mistake(f"simulate_many: reduce: {name}: found {what!r}, {expected}")
    return signal, kind


def _delays(setup: Setup, names: tuple[str, ...], numbers: np.ndarray) -> list[tuple[float, ...]]:
    """Delay of each delayed signal in each case, s."""
    equations = setup.program.equations
    if not equations.delays:
        return [()] * len(numbers)
    symbols = {name: x for x, name in equations.parameters.items()}
    different, which = np.unique(numbers, axis=0, return_inverse=True)
    delays = []
    for row in different:
        at = {symbols[name]: float(x) for name, x in zip(names, row, strict=True)}
        delays.append(tuple(float(delay.subs(at)) for delay in equations.delays))
    return [delays[i] for i in which.reshape(-1)]
