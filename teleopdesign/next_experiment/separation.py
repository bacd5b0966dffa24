"""Separation of two models along a motion, to first order.

One model is the truth; the force that it needs along a motion acts on the other, whose parameters
are re-estimated on the present records and the new one together:

    left = d + J step,   step = -(N + J'J)^-1 J'd,   d = residual(other) - residual(truth)

with J the tangents of the other's residual along the new motion and N those of the present fit.
Sums over parts of a motion add, so any composition of parts is evaluated without new residuals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..diagnose.least_squares import solve_normal
from ..diagnose.residual import relative_residuals
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from .rivals import Rival


@dataclass(frozen=True)
class Sums:
    """Sums over the rows of k parts (leading axis) for one truth and one other model.

    squares: of d, (k,);  gradient: J'd, (k, p);  normal: J'J, (k, p, p)
    noise: (k,) squares of the truth's residual, or of the noise floor of the present records in as
        many rows, whichever is larger
    present: normal matrix of the present fit records, (p, p)
    """

    squares: Array
    gradient: Array
    normal: Array
    noise: Array
    present: Array

    def separation(self, parts: Sequence[int] | NDArray[np.intp]) -> float:
        """Remaining error along these parts, in noise floors of the parts."""
        chosen = list(parts)
        normal, gradient = self.normal[chosen].sum(0), self.gradient[chosen].sum(0)
        step = -solve_normal(self.present + normal, gradient)
        left = float(self.squares[chosen].sum() + 2 * gradient @ step + step @ normal @ step)
        noise = float(self.noise[chosen].sum())
        return float(np.sqrt(max(left, 0.0) / max(noise, 1e-300)))


def normal_matrix(rival: Rival, prepared: Prepared, use: str = "fit") -> Array:
    """J'J of a model by its free parameters on the records of one use."""
    stretches = prepared.of(use)
    parts = relative_residuals(rival.model, stretches, rival.fit.free)
    p = len(rival.fit.free)
    return sum(
        (s.weight * d @ d.T for s, (_, d) in zip(stretches, parts, strict=True)), np.zeros((p, p))
    )


def sums_of(
    other: Rival,
    truth_left: Sequence[Array],
    stretches: Sequence[Stretch],
    part_of: Sequence[int],
    present: Array,
    floor: float,
) -> Sums:
    """The sums for one other model, along parts that were simulated with one truth.

    truth_left: the truth's residual on the rows that count, per stretch
    part_of: number of the part of each stretch
    floor: force (rms) that sensors leave on the present records. A motion that hardly moves the
        body has a lower floor, but the present records limit the accuracy
    """
    k, p = max(part_of) + 1, len(other.fit.free)
    squares, noise, rows = np.zeros(k), np.zeros(k), np.zeros(k)
    gradient, normal = np.zeros((k, p)), np.zeros((k, p, p))
    parts = relative_residuals(other.model, stretches, other.fit.free)
    for i, s, truth_residual, (r, d) in zip(part_of, stretches, truth_left, parts, strict=True):
        apart = r - truth_residual
        squares[i] += s.weight * float(apart @ apart)
        gradient[i] += s.weight * (d @ apart)
        normal[i] += s.weight * (d @ d.T)
        noise[i] += s.weight * float(truth_residual @ truth_residual)
        rows[i] += s.weight * len(s.keep)
    return Sums(squares, gradient, normal, np.maximum(noise, rows * floor**2), present)


def floor_force(prepared: Prepared, floor: float) -> float:
    """Force (rms) that sensors leave on the check records (without these, on the fit records).

    floor: noise floor as a relative error
    """
    check = prepared.of("check") or prepared.of("fit")
    return floor * rms_measured(check)


def rms_measured(stretches: Sequence[Stretch]) -> float:
    """Rms of the measured force over the rows that count."""
    rows = sum(s.weight * len(s.keep) for s in stretches)
    return float(np.sqrt(sum(s.measured for s in stretches) / rows))


def present_separation(truth: Rival, other: Rival, prepared: Prepared, floor: float) -> float:
    """The separation on the check records of the present data, if `truth` is true.

    Without check records: on the fit records.  floor: relative noise floor
    """
    fit, check = prepared.of("fit"), prepared.of("check") or prepared.of("fit")
    present = normal_matrix(other, prepared)
    on_fit = _sums_against(truth, other, fit, present)
    step = -solve_normal(present, on_fit.gradient.sum(0))
    shown = on_fit if check is fit else _sums_against(truth, other, check, present)
    left = float(
        shown.squares.sum() + 2 * shown.gradient.sum(0) @ step + step @ shown.normal.sum(0) @ step
    )
    return float(np.sqrt(max(left, 0.0) / sum(s.measured for s in check)) / floor)


def _sums_against(truth: Rival, other: Rival, stretches: Sequence[Stretch], present: Array) -> Sums:
    truth_left = [r for r, _ in relative_residuals(truth.model, stretches)]
    return sums_of(other, truth_left, stretches, [0] * len(stretches), present, 0.0)
