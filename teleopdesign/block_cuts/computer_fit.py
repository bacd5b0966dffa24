"""Fits of the computer's effects: residuals at its cuts, least squares over few values.

The residual of a cut is the recorded signal less the predicted one, low-passed, over the rms of the
recorded signal. A shift of the command's log by a row belongs to the record: it is chosen for each
fit among -1, 0 and 1 rows, the smaller one where both leave the same.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..base.frozen import is_same
from ..diagnose.diagnosis import Diagnosis
from ..diagnose.evidence import SAME
from ..diagnose.fit import standard_errors
from ..diagnose.solve import BLOCK
from ..effects.of_blocks.controllers import ControlEffect
from ..measurement.filtering import Array, spectrum
from ..measurement.prepare import TRIM
from .computer import ComputerPart, Passes, Placed, free_parameters, passes_of
from .control_rows import ControlFit, ControlRows
from .cuts import Cuts
from .diagram_experiment import DiagramExperiment, RecordedLog

#: part of the sample rate up to which the computer's signals are compared where no bandwidth is
#: stated: a tenth of it, as far as a difference of two readings is a velocity
_BAND = 0.1

#: s of a block that is held out where no record is for checks only
HELD_OUT = 1.0
#: error of a cut that double precision leaves, where a log holds every digit
ROUNDING = 1e-12
#: draws of the rounding: the floor is then known to a few percent
DRAWS = 8
#: squares over those of the signal below which two shifts leave the same: rounding
TINY = 1e-16


class ControlData(ControlRows):
    """The recorded signals of the computer's cuts, low-passed, and the rows that count."""

    def __init__(self, part: ComputerPart, rows: Sequence[Passes], bandwidth: float) -> None:
        super().__init__(part, rows)
        self.bandwidth = bandwidth
        self.spectra = [spectrum(_count(r), r.period) for r in self.rows]
        self.gains = [s.lowpass(bandwidth) for s in self.spectra]
        held_out = all(r.use == "fit" for r in self.rows)
        self.masks = [_masks(r, held_out) for r in self.rows]
        self.held_out = held_out
        self.recorded = [
            {c.signal: self.low(i, r.signals[c.signal]) for c in part.cuts}
            for i, r in enumerate(self.rows)
        ]
        self.scale = {
            (use, c.signal): float(
                np.sqrt(sum(np.sum(z[c.signal][m[use]] ** 2) for z, m in self._pairs()))
            )
            or 1.0
            for use in ("fit", "check")
            for c in part.cuts
        }
        self.shifts = (0,) if part.computer.one_pass else (0, -1, 1)
        # low-passed residuals hold nothing above twice the bandwidth: every so many rows tell all
        self.thin = max(1, int(1.0 / (4.0 * bandwidth * self.rows[0].period)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ControlData):
            return NotImplemented
        contents = ((one.part, one.rows, one.bandwidth) for one in (self, other))
        return is_same(*contents)

    __hash__ = None  # type: ignore[assignment]

    def _pairs(self) -> list[tuple[dict[str, Array], dict[str, NDArray[np.bool_]]]]:
        return list(zip(self.recorded, self.masks, strict=True))

    def low(self, record: int, samples: Array) -> Array:
        """The samples of a record through the low-pass of the comparison."""
        return self.spectra[record].multiply(samples, self.gains[record])

    @cached_property
    def blocks(self) -> dict[str, NDArray[np.intp]]:
        """Number of the block of each row of the residuals, cuts one after the other."""
        numbers: dict[str, NDArray[np.intp]] = {}
        for use in ("fit", "check"):
            parts, first = [], 0
            for r, m in zip(self.rows, self.masks, strict=True):
                at = (np.flatnonzero(m[use]) * r.period / BLOCK).astype(np.intp) + first
                parts.append(at)
                first = int(at.max(initial=first)) + 1
            one = np.concatenate(parts)
            numbers[use] = np.concatenate([one] * len(self.part.cuts))
        return numbers

    def predictions(self, placed: Sequence[Placed]) -> list[dict[str, Array]]:
        """Low-passed prediction of each record's signals."""
        made = [self.part.predict(r, placed) for r in self.rows]
        return [{s: self.low(i, x) for s, x in one.items()} for i, one in enumerate(made)]

    def residuals(
        self, predicted: Sequence[dict[str, Array]], shift: int, use: str
    ) -> dict[str, Array]:
        """Residual of each cut on the rows of a use, over the rms of its signal there."""
        left = {}
        for cut in self.part.cuts:
            s = cut.signal
            parts = [
                (z[s] - np.roll(p[s], shift))[m[use]]
                for (z, m), p in zip(self._pairs(), predicted, strict=True)
            ]
            left[cut.name] = np.concatenate(parts) / self.scale[use, s]
        return left

    def squares(self, placed: Sequence[Placed]) -> dict[int, float]:
        """Sum of squares on the fit rows at each shift."""
        made = self.predictions(placed)
        return {
            s: sum(float(np.sum(r**2)) for r in self.residuals(made, s, "fit").values())
            for s in self.shifts
        }

    def at(
        self, placed: Sequence[Placed], shift: int | None = None, stderr: Sequence[float] = ()
    ) -> ControlFit:
        """The fit at these values;  shift: None: the best one."""
        if shift is None:
            shift = _least(self.squares(placed))
        made = self.predictions(placed)
        left = {use: self.residuals(made, shift, use) for use in ("fit", "check")}
        return ControlFit(
            tuple(placed),
            shift,
            {use: np.concatenate(list(one.values())) for use, one in left.items()},
            {
                use: {name: float(np.sqrt(np.sum(r**2))) for name, r in one.items()}
                for use, one in left.items()
            },
            tuple(stderr),
        )

    def estimate(self, before: ControlFit, effect: ControlEffect, at: str) -> ControlFit:
        """The best values of an effect and those before it."""
        starts = effect.starts(self.samples(at), self.rows[0].period)
        return self._best([(*before.placed, Placed(effect, at, float(v))) for v in starts])

    def base(self) -> ControlFit:
        """The laws as stated, their free parameters estimated."""
        free = free_parameters(self.part.diagram, self.part.places)
        return self._best([free]) if free else self.at(())

    def _best(self, starts: Sequence[tuple[Placed, ...]]) -> ControlFit:
        """The best fit from the best start at each shift."""
        sums = [self.squares(one) for one in starts]
        fits = {}
        for shift in self.shifts:  # a delay fitted at a wrong shift is least there: fit at each
            best = min(range(len(starts)), key=lambda i: sums[i][shift])
            fits[shift] = self._refine(starts[best], shift)
        return fits[_least({shift: fit.squares for shift, fit in fits.items()})]

    def _refine(self, placed: Sequence[Placed], shift: int) -> ControlFit:
        """Least squares over the values, from these ones."""
        from scipy.optimize import least_squares

        scaled = self.coordinates(placed)

        def residual(x: Array) -> Array:
            one = self.residuals(self.predictions(scaled.at(x)), shift, "fit")
            return np.concatenate(list(one.values()))[:: self.thin]

        steps = [1e-4] * len(placed)
        solved = least_squares(
            residual, scaled.start, bounds=scaled.bounds, diff_step=steps, xtol=1e-6
        )
        errors = standard_errors(
            np.asarray(solved.jac), solved.fun, self.blocks["fit"][:: self.thin]
        )
        return self.at(scaled.at(solved.x), shift, (errors * scaled.unit).tolist())


def _least(squares: dict[int, float]) -> int:
    """The shift that leaves least; the smallest one where several leave the same."""
    least = min(squares.values())
    alike = [s for s, left in squares.items() if left <= least * (1.0 + SAME) + TINY]
    return min(alike, key=abs)


def _count(rows: Passes) -> int:
    return len(next(iter(rows.signals.values())))


def _masks(rows: Passes, held_out: bool) -> dict[str, NDArray[np.bool_]]:
    """Passes of each use: without the ends, and without lost rows and what is near them.

    Blocks in turn are held out where no record is for checks only.
    """
    time = np.arange(_count(rows)) * rows.period
    counted = (time >= TRIM) & (time < time[-1] + rows.period - TRIM)
    for row in rows.lost:
        counted &= abs(time - time[row]) >= TRIM
    if not held_out:
        return {use: counted & (rows.use == use) for use in ("fit", "check")}
    odd = (time / HELD_OUT).astype(int) % 2 == 1
    return {"fit": counted & ~odd, "check": counted & odd}


def floors(data: ControlData, experiment: DiagramExperiment, seed: int = 0) -> dict[str, float]:
    """Error of each cut that rounding alone leaves, on the check rows, by drawn readings.

    The computer read the same numbers, so that only the last digit of a column counts; of a sensor
    that it does not read, resolution and noise. The predicted signal is rounded anew, beside the
    steps that the log has: at rest the rounding is a constant, which no low-pass takes away.
    """
    random = np.random.default_rng(seed)
    sums = dict.fromkeys((c.signal for c in data.part.cuts), 0.0)
    for i, (rows, log) in enumerate(zip(data.rows, experiment.logs, strict=True)):
        drawn = {
            s: x + _reading(experiment, log, s, len(x), random) for s, x in rows.signals.items()
        }
        again = Passes(rows.file + " drawn", rows.use, rows.period, drawn, rows.lost)
        before, after = data.part.predict(rows), data.part.predict(again)
        for cut in data.part.cuts:
            s = cut.signal
            step = max(experiment.digit(s, log), experiment.channel[s].resolution or 0.0)
            for beside in random.uniform(0.0, step, DRAWS):
                made = _round_to(after[s] + beside, step) - before[s] - beside
                left = data.low(i, made)[data.masks[i]["check"]]
                sums[s] += float(np.sum(left**2)) / data.scale["check", s] ** 2 / DRAWS
    return {c.name: max(float(np.sqrt(sums[c.signal])), ROUNDING) for c in data.part.cuts}


def _round_to(samples: Array, step: float) -> Array:
    return np.round(samples / step) * step if step else samples


def _reading(
    experiment: DiagramExperiment, log: RecordedLog, name: str, n: int, random: np.random.Generator
) -> Array:
    """Drawn difference between what the computer read and what the log holds."""
    channel = experiment.channel[name]
    if name not in experiment.read_by_computer:
        noise = (channel.noise or 0.0) * random.standard_normal(n)
        return noise + random.uniform(-0.5, 0.5, n) * (channel.resolution or 0.0)
    if channel.resolution is not None and name in experiment.diagram.measured:
        return np.zeros(n)  # whole steps of a sensor, as the computer read them
    # a number of the computer, which was rounded for the log
    step = max(experiment.digit(name, log), channel.resolution or 0.0)
    return random.uniform(-0.5, 0.5, n) * step


def data_of_computer(
    experiment: DiagramExperiment, cuts: Cuts, bodies: Mapping[str, Diagnosis]
) -> ControlData:
    """The rows of the cuts of the computer and of sums, at the bandwidth of the bodies.

    raises ModelError: rows are not passes of the computer, or a law cannot be predicted
    """
    computed = (*cuts.of("computer"), *cuts.of("wiring"))
    part = ComputerPart(experiment.diagram, computed, experiment.zero, experiment.computer)
    rows = [passes_of(experiment, log) for log in experiment.logs]
    bandwidth = experiment.bandwidth or min(
        [d.bandwidth for d in bodies.values()] or [_BAND / rows[0].period]
    )
    return ControlData(part, rows, bandwidth)
