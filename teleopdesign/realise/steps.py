"""Inner steps per sample: as requested, or finer where a run would not resolve its signals.

A step that is too long is detected and reported, by two measures that need no second run:

- steps per radian of the fastest oscillation or decay of the equations at rest, friction stuck;
- where a bristle is reloaded after a reversal: that takes the time sqrt(2 lambda / a), lambda its
  length and a the acceleration. One step changes the bristle's decay rate by h a / lambda, so
  N = sqrt(2 / (h * change)) steps fall into that time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from ..base.errors import GrowsWithoutBound, ModelError

#: largest product of the step h and the fastest rate of the equations at rest: 0.3 is 20 steps in a
#: period
FASTEST = 0.3
#: 1/s: a larger rate is a jump and no dynamics: a step of 1 N within 1 nm/s on 1 kg has 1e9
JUMP = 1e7
#: largest product of the step h and the change of a bristle's decay rate in a step: 0.02 is 10
#: steps in a reload of the bristle
RELOAD = 0.02
#: divisors of a step that is too long. There are few, so that simulations side by side that need
#: similar steps share a grid; above 200 the model is wrong
FINER = (1, 2, 3, 4, 5, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 200)


@dataclass(frozen=True)
class StepLadder:
    """The requested step, and the steps by which `FINER` divides it.

    step, period: requested step and sample period, s;  least: steps per sample at the requested
        step
    """

    step: float
    period: float
    least: int
    long_step: Literal["refine", "refuse"] = "refine"

    def first(self, rate: float, state: str) -> int:
        """Steps per sample that resolve a rate (1/s); state: the one that takes part in it most.

        raises ModelError: the step is refused, or no step is short enough
        """
        if rate > JUMP:
            raise ModelError(
                f"a force on {state} jumps with the sign of a velocity: no step resolves "
                "that in continuous time; sample the controller, or take a law that is rounded off"
            )
        step = self.period / self.least
        if rate * step <= FASTEST:
            return self.least
        if self.long_step == "refuse":
            why = f"is {2 * math.pi / (rate * step):.2g} steps per period of {state}"
            raise _long_step_error(step, FASTEST / rate, why)
        needed = self.least * _refine_factor(rate * step, FASTEST, 1)
        if (inner := self._round_up(needed)) is None:
            raise _long_step_error(self.step, self.period / needed, "is far too long")
        return inner

    @staticmethod
    def is_resolved(worst: Any, is_finite: Any) -> Any:
        """Whether a run resolved its bristles; for numbers or arrays, arguments as in `next`."""
        return (worst <= RELOAD) & is_finite

    def next(self, inner: int, worst: float, is_finite: bool) -> int:
        """Steps per sample for the next run; unchanged if this run resolved its bristles.

        inner: steps per sample of this run;  worst: its measure of the bristles' reload
        raises ModelError: signals are not finite, the step is refused, or no step is short enough
        """
        if self.is_resolved(worst, is_finite):
            return inner
        step = self.period / inner
        if not is_finite:
            raise GrowsWithoutBound(
                f"signals grow beyond all bounds at a step of {step:g} s: the "
                "loop is unstable or a parameter makes no sense"
            )
        factor = _refine_factor(worst, RELOAD, 2)
        if self.long_step == "refuse":
            why = f"is {math.sqrt(2 / worst):.2g} steps for the bristle's reload after a reversal"
            raise _long_step_error(step, step / factor, why)
        if (finer := self._round_up(inner * factor)) is None:
            # a run that ended at its limit does not know by how much: none is named that would do
            raise ModelError(
                f"step {self.step * 1e3:.4g} ms is far too long: even one of "
                f"{self.period / (self.least * FINER[-1]) * 1e3:.3g} ms does not resolve the "
                "bristle's reload after a reversal"
            )
        return finer

    def limit(self, inner: int) -> float:
        """Measure of the reload above which no step would suffice: a run may stop there.

        This holds for refined runs, after a run with finite signals. A first run goes to its end,
        so that signals which grow without bound are reported as such.
        """
        return RELOAD * (FINER[-1] * self.least / inner) ** 2

    def _round_up(self, needed: int) -> int | None:
        """Steps per sample on the coarsest grid with `needed` or more; None: no such grid."""
        return next((self.least * f for f in FINER if self.least * f >= needed), None)


def _refine_factor(measure: float, bound: float, power: float) -> int:
    """Factor by which to divide a step whose measure exceeds a bound.

    power: of the step in the measure
    """
    return math.ceil(math.pow(measure / bound, 1 / power) * 1.0001)


def _long_step_error(step: float, use: float, why: str) -> ModelError:
    """The error for a step that is refused.

    step, use: s, the refused step, and a step that can be used;  why: reason, in words
    """
    return ModelError(f"step {step * 1e3:.4g} ms {why}: use {use * 1e3:.3g} ms or less")
