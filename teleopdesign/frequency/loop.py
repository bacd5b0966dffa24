"""The loop of a controller: its gain at each frequency, and the delay that it tolerates.

A loop gain with a measured response: its stability, and where its gain is 1.

Nyquist's criterion, from the lowest measured frequency to the highest. Outside this range it is
assumed that the gain stays below 1 above it, and that below it the phase goes to 0 at rest from
between -270 and +90 degrees: plants lag, and controllers lead by less than a quarter turn. With the
loop opened at the controller's output, the rest is assumed stable, as it was when it was measured.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from ..base.errors import ModelError, UnstableLoop
from ..base.shown import Shown
from ..controllers import measured_frequencies
from ..derive import symbol_values
from ..derive.elimination import round_trip
from ..diagrams import Diagram
from ..realise.lti import S, as_transfer_function, linear_blocks, numerical
from ..realise.tips import linear_tips
from . import sampled_margins
from .frozen_friction import cancellations_left_over
from .late_loop import LateRatio, count_loop, crossings, loop_as_written, unity_grid
from .late_zeros import count_growing
from .sampled_loop import SampledLoop, sampled_loop, unseen_beside

if TYPE_CHECKING:
    import control


#: order of the Pade approximation in the stability test of a loop with several sampled parts
_PADE = 8
#: rad/s: range in which crossings are searched, on a grid of so many points, and then refined
_SLOWEST, _FASTEST, _POINTS = 1e-4, 1e7, 20001


@dataclass(frozen=True)
class LoopGain(Shown):
    """Gain once round the loop of a controller; stable feedback is > 0. Dead times are exact.

    expression: in `realise.lti.S`, with exact numbers
    left_out: what has no linear form, and takes no part: "block.effect", a controller as "block"
    held: controllers in discrete time, taken as H(e^(j w T)) and the hold of a sample
    fastest: rad/s, half the sampling rate of what is held; inf where nothing is
    growing: poles of the controller itself in the right half plane
    sampled: the loop in discrete time, where this controller alone samples: its margins are exact.
        None where others sample too: those of `held` then count as their response over frequency
    counted: the loop with all states, where nothing samples or is measured
    left_over: other controllers that cancel friction while friction is left out
    fault: a mode that grows, and that no law which samples or was measured changes; "" for none
    """

    expression: sp.Expr
    controller: str
    left_out: tuple[str, ...]
    held: tuple[str, ...]
    fastest: float
    growing: int = 0
    sampled: SampledLoop | None = None
    counted: LateRatio | None = field(default=None, compare=False, repr=False)
    left_over: tuple[str, ...] = ()
    fault: str = ""

    def __call__(self, s: Any) -> Any:
        """Value at complex s (1/s), a number or an array of any shape."""
        points = np.atleast_1d(np.asarray(s, dtype=complex))
        values = numerical(self.expression)(points.ravel()).reshape(points.shape)
        return complex(values[0]) if np.ndim(s) == 0 else values

    def transfer_function(self, *, delay_order: int = 4) -> control.TransferFunction:
        """The gain as a python-control system; dead times and holds by Pade approximation.

        Up to delay_order/delay (rad/s) the phase error is at most 0.4 degrees at order 4, 4.2 at
        order 1.
        """
        return as_transfer_function(self.expression, delay_order=delay_order)


def loop_gain(diagram: Diagram, *, controller: str = "H", speed: float = 0.0) -> LoopGain:
    """Gain once round the loop of a controller, opened at its output; stable feedback is > 0.

    All other blocks at work, linear forms with smoothed friction and schedules frozen at `speed`.
    A controller in discrete time counts as it samples and holds.

    raises ModelError: no such controller, or one without linear form
    """
    part = next((c for c in diagram.controls if c.name == controller), None)
    if part is None:
        diagram.block(controller)
        raise ModelError(f"{diagram.name}: {controller} is a body, expected a controller")
    diagram = linear_tips(diagram)
    linear = linear_blocks(diagram, speed=speed, held=True)
    if controller in linear.left_out:
        laws = ", ".join(stage.name for stage in part.stages)
        raise ModelError(
            f"{diagram.name}: {controller} ({laws}) has no linear form, so that its loop has no "
            "gain: see `describing_function`; a system with dt=True needs its period"
        )
    gain = -sp.sympify(round_trip(diagram, part)).subs(symbol_values(linear))
    kept = {c.name: c for c in diagram.controls if c.name in linear.held}
    periods = [g.values["period"] for c in kept.values() for g in c.stages if g.law.in_z]
    fastest = np.pi / max(periods) if periods else float("inf")
    growing, form = 0, linear.blocks[controller]
    if not (form.atoms(AppliedUndef) or form.has(sp.exp)):
        below = sp.Poly(sp.fraction(sp.cancel(sp.together(form)))[1], S)
        poles = np.roots([float(c) for c in below.all_coeffs()])
        growing = int((poles.real > 0).sum())
    sampled = sampled_loop(diagram, part, linear) if linear.held else None
    counted = None
    if not linear.held and not gain.atoms(AppliedUndef):
        counted = count_loop(diagram, controller, speed=speed)
    fault = ""
    if counted is None and sampled is None:
        there = (c for c in diagram.controls if c.name not in linear.left_out)
        away = [c for c in there if not all(g.law.linear for g in c.stages)]
        fault = unseen_beside(diagram, away)
    over = cancellations_left_over(diagram, linear.left_out)
    made = gain, controller, linear.left_out, linear.held, fastest, growing, sampled, counted
    return LoopGain(*made, over, fault)


def delay_margin(loop: LoopGain | control.TransferFunction) -> float:
    """Dead time (s) in the loop at which it begins to oscillate; inf where its gain stays below 1.

    0 where the gain does not fall below 1 at high frequency: there the least dead time makes motion
    grow, the faster the shorter. A loop with a measured response is judged between its frequencies,
    see `measured_crossings`. A controller that alone samples is in it as it is, in discrete time;
    where others sample too, by their response over frequency (`LoopGain.sampled`).

    raises ModelError: the loop is unstable without any delay (`UnstableLoop`); a controller was
        left out of it; its gain is above 1 where its samples no longer tell a frequency from
        others, or at the highest frequency that was measured
    """
    phase, w, fades = unity_crossings(loop)
    if isinstance(loop, LoopGain) and loop.sampled is not None:
        return sampled_margins.delay_margin(loop.sampled)
    if not fades:
        return 0.0
    # a crossing is reached by turning back as far as its phase lies ahead of -180 degrees
    return float((np.radians(phase % 360) / w).min(initial=np.inf))


def unity_crossings(
    loop: LoopGain | control.TransferFunction,
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Crossings of a stable loop: where its gain is 1, and whether it fades at high frequency.

    returns: phase above -180 degrees and frequency (rad/s), shape (crossings,), and the flag
    raises ModelError: as for `delay_margin`
    """
    if isinstance(loop, LoopGain):
        if gone := [name for name in loop.left_out if "." not in name]:
            raise ModelError(
                f"loop: {', '.join(gone)} has no linear form and is not in the gain: "
                f'judge the rest with `diagram.without("{gone[0]}")`, or simulate'
            )
        if loop.fault:
            raise UnstableLoop(f"the loop of {loop.controller}: {loop.fault}")
        if loop.expression.atoms(AppliedUndef):
            return *measured_crossings(loop.expression, growing=loop.growing), True
        if loop.sampled is not None:
            if loop.sampled.fault:
                raise UnstableLoop(f"the loop of {loop.controller}: {loop.sampled.fault}")
            if loop.sampled.grows():
                raise _unstable()
            phase, angles = sampled_margins.unity_crossings(loop.sampled)
            return phase, angles / float(loop.sampled.period), True
        if loop.held:
            from ..base import python_control as control

            # below half the sampling rate the approximation is good
            whole = control.feedback(loop.transfer_function(delay_order=_PADE), 1)
            if (np.real(whole.poles()) >= 0).any():
                raise _unstable()
            return *_crossings(loop, None), True
        ratio = loop.counted or loop_as_written(loop.expression)
        if ratio.fault:
            raise UnstableLoop(f"the loop of {loop.controller}: {ratio.fault}")
    elif loop.isdtime(strict=True):
        raise ModelError("loop: expected a system in continuous time, found a discrete one")
    else:
        sides = (np.trim_zeros(np.ravel(p[0][0]), "f") for p in (loop.num, loop.den))
        above, below = ({0.0: p} for p in sides)
        ratio = LateRatio(above, below)
    if count_growing(ratio.closed):
        raise _unstable()
    if not ratio.above:  # a gain of 0 at every frequency
        return np.zeros(0), np.zeros(0), True
    if isinstance(loop, LoopGain) and loop.expression.has(sp.exp):
        return *_crossings(loop, ratio), ratio.fades()
    (p,), (q,) = ratio.above.values(), ratio.below.values()
    w = crossings(p, q)
    gain = np.polyval(p, 1j * w) / np.polyval(q, 1j * w)
    return np.degrees(np.angle(gain)) + 180, w, ratio.fades()


def _unstable() -> UnstableLoop:
    return UnstableLoop("the loop is unstable without delay")


def _crossings(loop: LoopGain, ratio: LateRatio | None) -> tuple[np.ndarray, np.ndarray]:
    """Phase above -180 degrees, and frequency (rad/s), where the gain is 1.

    ratio: of a loop that is one; a grid alone might miss crossings of its delayed terms
    """
    call = numerical(loop.expression)
    grid = frequencies_of(loop, ratio, _POINTS)
    grid = grid if ratio is None else unity_grid(ratio, grid)
    gain = call(1j * grid)
    if np.isfinite(loop.fastest) and np.abs(gain[-1]) >= 1:
        raise ModelError(
            f"the loop's gain is still {np.abs(gain[-1]):.3g} at half the sampling rate"
        )
    return sampled_margins.where_unity(lambda w: call(1j * w), grid, gain)


def frequencies_of(loop: LoopGain, ratio: LateRatio | None, points: int) -> np.ndarray:
    """A first grid of so many frequencies, rad/s, with corners and narrow resonances."""
    slowest, fastest = _SLOWEST, min(loop.fastest, _FASTEST)
    corners = np.zeros(0) if ratio is None else ratio.corners()
    if len(corners):
        slowest, fastest = min(slowest, corners.min() / 1e4), max(fastest, corners.max() * 1e4)
    return np.unique(np.concatenate([np.geomspace(slowest, fastest, points), corners]))


#: frequencies between two neighbouring measured ones. Between these the measured response is
#: interpolated by a line, and the rest of the loop is smooth. Fewer frequencies may miss a turn of
#: the phase, more take time
_BETWEEN = 8
#: rad: longest step of the phase whose direction is certain
_SURE = np.pi / 2


def measured_crossings(expression: sp.Expr, *, growing: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Phase above -180 degrees, and frequency (rad/s), where the gain is 1.

    expression: loop gain, stable feedback > 0
    growing: poles of the controller itself in the right half plane
    raises ModelError: the loop is unstable (`UnstableLoop`), or the measurement does not decide
    """
    call = numerical(expression)
    w = _frequencies(expression)
    gain = call(1j * w)
    size = np.abs(gain)
    if size[-1] >= 1:
        raise ModelError(
            f"the loop's gain is still {size[-1]:.3g} at {w[-1]:.4g} rad/s, the "
            "highest frequency that was measured: measure further"
        )
    angle = np.angle(1 + gain)
    if angle[0] > _SURE:  # of a plant that lags by more than half a turn
        angle[0] -= 2 * np.pi
    steps = (np.diff(angle) + np.pi) % (2 * np.pi) - np.pi
    if np.abs(steps).max() > _SURE:
        at = w[int(np.argmax(np.abs(steps)))]
        raise ModelError(
            f"too few frequencies were measured beside {at:.4g} rad/s to follow the phase there"
        )
    turns = round((angle[0] + steps.sum() - angle[-1]) / (2 * np.pi))
    if 2 * turns != growing:
        raise _unstable()
    return sampled_margins.where_unity(lambda x: call(1j * x), w, gain)


def _frequencies(expression: sp.Expr) -> np.ndarray:
    """Frequencies that all measured responses cover, with points between neighbours, rad/s."""
    every = measured_frequencies(expression)
    low, high = max(w[0] for w in every), min(w[-1] for w in every)
    if low >= high:
        raise ModelError("measured responses have no frequencies in common")
    w = np.unique(np.concatenate([w[(w >= low) & (w <= high)] for w in every] + [[low, high]]))
    parts = np.arange(_BETWEEN) / _BETWEEN
    between = np.exp(np.log(w[:-1, None]) + np.diff(np.log(w))[:, None] * parts)
    return np.append(between.ravel(), high)
