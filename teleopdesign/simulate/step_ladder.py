"""Number of steps per sample of a run, and the next number if they do not resolve its signals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..base.errors import GrowsWithoutBound, ModelError

if TYPE_CHECKING:
    from ..realise.kernel import Timing


@dataclass(frozen=True)
class StepLadder:
    """The requested step, and the steps by which `realise.kernel.FINER` divides it.

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
        from ..realise.kernel import FASTEST, JUMP, long_step_error, refine_factor, round_up_steps

        if rate > JUMP:
            raise ModelError(
                f"a force on {state} jumps with the sign of a velocity: no step resolves "
                "that in continuous time; sample the controller, or take a law that is rounded off"
            )
        step = self.period / self.least
        if rate * step <= FASTEST:
            return self.least
        if self.long_step == "refuse":
            why = f"is {2 * np.pi / (rate * step):.2g} steps per period of {state}"
            raise long_step_error(step, FASTEST / rate, why)
        needed = self.least * refine_factor(rate * step, FASTEST, 1)
        if (inner := round_up_steps(needed, self.least)) is None:
            raise long_step_error(self.step, self.period / needed, "is far too long")
        return inner

    @staticmethod
    def is_resolved(worst: Any, is_finite: Any) -> Any:
        """Whether a run resolved its bristles; for numbers or arrays, arguments as in `next`."""
        from ..realise.kernel import RELOAD

        return (worst <= RELOAD) & is_finite

    def next(self, timing: Timing, worst: float, is_finite: bool) -> int:
        """Steps per sample for the next run; unchanged if this run resolved its bristles.

        worst: measure of the bristles' reload, see `realise.kernel`
        raises ModelError: signals are not finite, the step is refused, or no step is short enough
        """
        from ..realise.kernel import FINER, RELOAD, long_step_error, refine_factor, round_up_steps

        if self.is_resolved(worst, is_finite):
            return timing.inner
        if not is_finite:
            raise GrowsWithoutBound(
                f"signals grow beyond all bounds at a step of {timing.step:g} s: the "
                "loop is unstable or a parameter makes no sense"
            )
        factor = refine_factor(worst, RELOAD, 2)
        if self.long_step == "refuse":
            why = f"is {np.sqrt(2 / worst):.2g} steps for the bristle's reload after a reversal"
            raise long_step_error(timing.step, timing.step / factor, why)
        if (inner := round_up_steps(timing.inner * factor, self.least)) is None:
            # a run that ended at its limit does not know by how much: none is named that would do
            raise ModelError(
                f"step {self.step * 1e3:.4g} ms is far too long: even one of "
                f"{self.period / (self.least * FINER[-1]) * 1e3:.3g} ms does not resolve the "
                "bristle's reload after a reversal"
            )
        return inner

    def limit(self, inner: int) -> float:
        """Measure of the reload above which no step would suffice: a run may stop there.

        This holds for refined runs, after a run with finite signals. A first run goes to its end,
        so that signals which grow without bound are reported as such.
        """
        from ..realise.kernel import worst_reload

        return worst_reload(inner, self.least)
