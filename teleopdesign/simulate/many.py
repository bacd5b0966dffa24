"""Simulate a diagram for many parameter sets at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from math import inf
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..base.errors import ModelError, unknown
from ..diagrams import Diagram
from ..realise.simulated import refuse_massless
from .case_results import CaseResults, Mistake, read_reduction
from .cases import (
    Group,
    columns_of,
    delays_of_cases,
    groups,
    list_refusals,
    set_case,
    simulated_values,
)
from .on_grid import Input, samples_of
from .sampling import SAMPLED, Sampling
from .setup import Setup, prepare, simulated_form
from .trajectory import Trajectory

if TYPE_CHECKING:
    import xarray

    from ..realise.side_by_side import GridRun, LaneResults, Reduction

#: numbers in the tables of inputs of grids that run at once: 0.4 GB
_MOST_AT_ONCE = 50_000_000


class _Grid(NamedTuple):
    """Grid of steps of some cases;  is_refined: their run on a coarser grid did not resolve them.

    inner: steps per sample;  delays: of each late signal, s
    """

    is_refined: bool
    inner: int
    delays: tuple[float, ...]


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
    device: Literal["cpu", "cuda"] = "cpu",
) -> xarray.Dataset:
    """Simulate every parameter set from t = 0, many side by side on all cores or on a GPU.

    values: parameter, such as "Z_m.coulomb.level" (the names of `Diagram.values`) -> its value in
        each case (SI), shape (n,), or one number for all
    keep: signals whose samples are kept, over `case` and `time`; none by default, so that memory
        does not grow with the duration
    reduce: name of a result -> (signal, what): "final", "maximum", "minimum", "peak" (largest
        size), "mean" or "rms" over the samples; or ((force, motion), "energy"), the energy (J) that
        the force has done on the motion. Default: the rms of every signal as "SIGNAL_rms" where
        nothing is kept, else none
    after: start of what is reduced, s
    device: "cuda": an NVIDIA GPU (extra `cuda`), which pays from some thousand cases on
    other arguments: as in `simulate`, for all cases
    returns: variables over `case`; coordinates: the values, `step` (s) that each case took, and
        `reason` why a case has no numbers (they are NaN then), "" where it has. A case that fails
        does not touch the others
    raises ModelError: no such parameter or signal, arrays of different lengths, more samples kept
        than 2 GB; no GPU; what fails in every case

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> runs = td.simulate_many(
        ...     td.haptic_interface(device),
        ...     {"Z_M.viscous.damping": [1.0, 2.0]},
        ...     duration=0.1,
        ...     inputs={"R_D": 1.0},
        ... )
        >>> runs["L_rms"].values.round(5)
        array([0.00985, 0.0087 ])
    """
    if device == "cuda":
        from ..realise.on_gpu import check_gpu

        check_gpu()
    columns = columns_of(diagram, values)
    cases = len(next(iter(columns.values()))) if columns else 1
    arguments: dict[str, Any] = {"duration": duration, "inputs": inputs, "initial": initial}
    arguments |= {"motion": dict(motion or {}), "computer": computer, "step": step, "give": give}
    wanted = None if reduce is None else dict(reduce)
    study = _Study(diagram, columns, arguments, long_step, tuple(keep), wanted, after, device)
    period = (SAMPLED if isinstance(computer, str) else computer).period
    result = CaseResults(cases)
    result.open_rows(samples_of(duration, period), period, study.keep)
    result.refuse(list_refusals(diagram, columns))
    study.run_all(result)
    return result.label(diagram, columns, study.reductions_of(result.numbers), duration)


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
    device: Literal["cpu", "cuda"]

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
            except Mistake as error:
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
        delays = delays_of_cases(setup, late, numbers[:, many:])
        ladder = cache(partial(setup.ladder, self.long_step))
        check = cache(lambda *grid: setup.check_size(setup.timing(*grid)))
        todo: dict[_Grid, list[int]] = {}
        for k, case in enumerate(group.cases):
            if not result.open[case]:
                continue
            state = layout.states[states[k]] if layout.states else ""
            try:
                inner = ladder(delays[k]).first(float(rates[k]), state)
                check(inner, delays[k])
                todo.setdefault(_Grid(False, inner, delays[k]), []).append(k)
            except ModelError as error:
                result.refuse({int(case): str(error)})
        while todo:
            now = {grid: todo.pop(grid) for grid in _run_at_once(setup, todo)}
            runs = [_run_on(setup, grid, numbers[here, :many]) for grid, here in now.items()]
            outcomes = self._execute()(
                setup.program,
                runs,
                start=setup.initial,
                kept=list(kept.values()),
                reductions=list(reductions.values()),
                begin=min(round(self.after / setup.sampling.period), setup.samples),
            )
            for (grid, members), run, outcome in zip(now.items(), runs, outcomes, strict=True):
                here = group.cases[np.array(members)]
                finer = self._next_steps(setup, grid, here, outcome, result)
                for i, inner in finer.items():
                    todo.setdefault(_Grid(True, inner, grid.delays), []).append(members[i])
                done = result.open[here]
                done[list(finer)] = False
                result.take(here[done], run.timing.step, outcome, done, (*kept,), (*reductions,))

    def _execute(self) -> Callable[..., list[LaneResults]]:
        """The function that runs cases on the chosen device."""
        if self.device == "cuda":
            from ..realise.on_gpu import execute_on_gpu

            return execute_on_gpu
        from ..realise.side_by_side import execute_many

        return execute_many

    def _next_steps(
        self,
        setup: Setup,
        grid: _Grid,
        cases: np.ndarray,
        outcome: LaneResults,
        result: CaseResults,
    ) -> dict[int, int]:
        """Index in `cases` -> steps per sample of cases that need finer steps; refuses failures."""
        finer: dict[int, int] = {}
        ladder = setup.ladder(self.long_step, grid.delays)
        for i in np.flatnonzero(~ladder.is_resolved(outcome.worst, outcome.is_finite)):
            try:
                if not outcome.is_finite[i]:
                    there = set_case(self.diagram, self.columns, int(cases[i]))
                    if 0 in there.values.values():
                        refuse_massless(self._form(there), self.arguments["motion"] or ())
                finer[int(i)] = ladder.next(
                    grid.inner, float(outcome.worst[i]), bool(outcome.is_finite[i])
                )
            except ModelError as error:
                result.refuse({int(cases[i]): str(error)})
        return finer

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
            raise Mistake(f"simulate_many: {where}: {unknown('signal', name, names)}")

        kept = {name: column(name, "keep") for name in self.keep}
        reductions: dict[str, Reduction] = {}
        for name, what in self.choose_reductions(names).items():
            signal, kind = read_reduction(name, what)
            if (
                name in self.keep
                or name in self.columns
                or name in ("case", "time", "step", "reason")
            ):
                raise Mistake(
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


def _run_at_once(setup: Setup, grids: Iterable[_Grid]) -> list[_Grid]:
    """The coarsest grids, as many as the memory for input tables allows.

    They run side by side, so that the few cases with fine steps leave no core without work.
    """
    chosen: list[_Grid] = []
    numbers = 0
    for grid in sorted(grids):
        numbers += setup.table_size(setup.timing(grid.inner, grid.delays))
        if chosen and numbers > _MOST_AT_ONCE:
            break
        chosen.append(grid)
    return chosen


def _run_on(setup: Setup, grid: _Grid, numbers: np.ndarray) -> GridRun:
    """Cases with these numbers (cases, parameters) on a grid; refined ones may stop early."""
    from ..realise.side_by_side import GridRun

    timing = setup.timing(grid.inner, grid.delays)
    limit = setup.ladder("refine", grid.delays).limit(grid.inner) if grid.is_refined else inf
    tables = setup.arguments(timing)
    return GridRun(numbers, timing, tables["inputs"], tables["sampled"], limit)
