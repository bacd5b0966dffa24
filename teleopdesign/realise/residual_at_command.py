"""A residual force as an error of the recorded command, mapped back through the actuation.

    gain g: r / g     lag: (1 + tau s) r     delay: r, earlier by it     ripple: r / (1 + r sin ...)

This works for any effect, without its name. Each law between the command and the force that moves
the body is linearised along the motion by its derivatives: the stages of the actuation, friction,
and forces that depend on the acting force. A law is then a gain for a constant command, sample by
sample, times dynamics that are 1 at rest, with coefficients at their mean along the motion:

    H(s) = law_command + law_delayed e^(-s delay) + law_state (s - rate_state)^-1 rate_command

The residual is divided by both. Where a gain is nearly zero the command has no influence: the
sample is blind.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..blocks import Body
from ..effects import SIGNALS, Effect
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from .along_motion import Residual, measured_along, residual_along, with_loads
from .friction_along import level_along
from .stages_along import ActuationStage, stages_along
from .tangent_columns import TangentColumns
from .traced import Along, Traced

#: a sample is blind if the gain of the law is below this part of its largest gain: a command that
#: is ten times as uncertain as elsewhere is not reported. With a larger part, a ripple or a soft
#: limit would count as blind although the command is still known
SLIGHT = 0.1
#: least divisor of dynamics, as a part of their value at rest: below it the division is rounding
LEAST = 1e-3
_COMMAND, _ACTING = SIGNALS["command"], SIGNALS["acting_force"]
_CARRIED, _INTERACTION = SIGNALS["carried_force"], SIGNALS["interaction_force"]


@dataclass(frozen=True)
class ResidualAtCommand:
    """Residual of a model along one motion (n samples), as an error of the recorded command.

    residual: mapped back, SI; in blind samples divided by the largest gain
    blind: samples in which the command has almost no influence on the moving force
    passed: part of the interaction force that reaches the body, with its sign
    """

    residual: Array
    blind: NDArray[np.bool_]
    passed: Array


@dataclass(frozen=True)
class _Way:
    """The linearised transfer from one signal to another along a motion.

    gain: (n,) static gain;  dynamics: over frequency, for oscillations;  delay: s
    """

    gain: Array
    dynamics: NDArray[np.complex128]
    delay: float


def is_between(body: Body) -> bool:
    """Whether a law acts between the recorded forces and the force that moves the body."""
    return (
        any(e.role == "actuation" for e in body.effects)
        or body.level().has(_ACTING, _CARRIED, _INTERACTION)
        or bool(_effects_that_take(body, _ACTING) or _effects_that_take(body, _INTERACTION))
    )


def residual_at_command(
    body: Body, motion: Motion, along: Residual | None = None
) -> ResidualAtCommand:
    """The residual along a motion as an error of the recorded command.

    along: result of `residual_along` for this body and motion; None: it is computed
    """
    model = along or residual_along(body, motion)
    residual, blind = model.residual.value.copy(), np.zeros(len(motion.time), dtype=bool)
    known = measured_along(body, motion)
    stages = stages_along(body, motion, known)
    known = with_loads(body, motion, known, known.constant(model.acting.value))
    ways = [_net(body, motion, known, _ACTING)]
    ways += [_trace_stage(stage, motion, known) for stage in reversed(stages)]
    for way in ways:
        residual, blind = _undo_way(residual, blind, way, motion)
    passed = motion.interaction
    if passed.any():
        passed = _transmit(passed, _net(body, motion, known, _INTERACTION), motion)
    return ResidualAtCommand(residual, blind, passed)


def _effects_that_take(body: Body, signal: sp.Symbol) -> list[Effect]:
    """Effects that reduce the moving force, by laws that depend on this signal."""
    taking = [e for e in body.effects if e.role in ("force", "structure")]
    return [e for e in taking if any(x.has(signal) for x in (e.expression(), *e.rates().values()))]


def _slopes(law: sp.Expr, by: Sequence[sp.Symbol], along: Along) -> Array:
    """Derivatives of a law by k signals along the motion (k, n); one without samples is zero."""
    n, units = len(along), np.eye(len(by))[:, :, None]
    signals = {}
    for symbol, unit in zip(by, units, strict=True):
        value = along.signals[symbol].value if symbol in along.signals else np.zeros(n)
        signals[symbol] = Traced(value, np.repeat(unit, n, axis=1))
    at = replace(along, columns=TangentColumns(by)).with_signals(signals)
    return np.asarray(at.evaluate(law).tangent)


def _trace_influence(
    effect: Effect,
    law: sp.Expr,
    signal: sp.Symbol,
    along: Along,
    motion: Motion,
    *,
    delays: Mapping[sp.Symbol, float] = MappingProxyType({}),
    parts: int = 1,
) -> _Way:
    """The transfer from a signal through a law, with its hidden states and delayed copies."""
    states, rates = list(effect.state_symbols().values()), list(effect.rates().values())

    def at_rows(law: sp.Expr, *by: sp.Symbol) -> Array:
        whole = _slopes(law, by, along)
        return np.asarray(whole.reshape(len(by), len(motion.time), parts).mean(axis=2))

    both = at_rows(law, signal, *delays, *states)
    now, out = both[: 1 + len(delays)], both[1 + len(delays) :]
    late = np.array([0.0, *delays.values()])
    gain = now.sum(axis=0)
    omega = 2.0 * np.pi * motion.spectrum.frequency
    over = (now.mean(axis=1)[:, None] * np.exp(-1j * late[:, None] * omega)).sum(axis=0)
    if states:
        along_rates = np.array([at_rows(rate, *states, signal) for rate in rates])
        between, into = along_rates[:, :-1], along_rates[:, -1]
        gain = gain - np.einsum("in,ni->n", out, _solve_systems(np.moveaxis(between, 2, 0), into.T))
        frozen = 1j * omega[:, None, None] * np.eye(len(states)) - between.mean(axis=2)
        reached = _solve_systems(frozen, np.broadcast_to(into.mean(axis=1), frozen.shape[:2]))
        over = over + reached @ out.mean(axis=1)
    delay = float(now.mean(axis=1) @ late / over[0].real) if over[0].real and late.any() else 0.0
    return _Way(gain, over, delay)


def _solve_systems(matrices: Array | NDArray[np.complex128], right: Array) -> Any:
    """Solutions (k, m) of k systems of m equations; NaN where one has no solution."""
    try:
        return np.linalg.solve(matrices, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.full(right.shape, np.nan)


def _trace_stage(stage: ActuationStage, motion: Motion, along: Along) -> _Way:
    at_stage = replace(along, signals=stage.signals)
    delays, parts = stage.delays, stage.parts
    return _trace_influence(
        stage.effect, stage.law, _COMMAND, at_stage, motion, delays=delays, parts=parts
    )


def _net(body: Body, motion: Motion, along: Along, signal: sp.Symbol) -> _Way:
    """The transfer from a force to the force that moves the body, less all that it causes."""
    gain, over = np.ones(len(motion.time)), np.ones(len(motion.spectrum.frequency), dtype=complex)
    for effect in _effects_that_take(body, signal):
        if effect.states and effect.is_absent(along.values):
            continue
        way = _trace_influence(effect, effect.expression(), signal, along, motion)
        gain, over = gain - way.gain, over - way.dynamics
    carries = body.level().has(_CARRIED) and body.carried_force().has(signal)
    if carries or body.level().has(signal):
        level, with_speeds = level_along(body, along)
        by_signal, by_carried = _slopes(level, (signal, _CARRIED), with_speeds)
        if carries:
            by_signal = by_signal + by_carried * _slopes(body.carried_force(), (signal,), along)[0]
        gain = gain - along.signals[SIGNALS["direction"]].value * by_signal
    return _Way(gain, over, 0.0)


def _undo_way(
    residual: Array, blind: NDArray[np.bool_], way: _Way, motion: Motion
) -> tuple[Array, NDArray[np.bool_]]:
    """A residual mapped back through a transfer, with the mask of blind samples before it."""
    finite = np.isfinite(way.gain)
    most = float(np.max(np.abs(way.gain), initial=0.0, where=finite))
    slight = ~finite | (np.abs(np.where(finite, way.gain, 0.0)) < SLIGHT * most)
    if most == 0.0 or not np.isfinite(way.dynamics).all():
        return residual, np.ones(len(residual), dtype=bool)
    residual = residual / np.where(slight, most, way.gain)
    blind = blind | slight
    dynamics = _from_rest(way)
    if np.any(dynamics != 1.0):
        size = np.abs(dynamics)
        dynamics = np.where(size < LEAST, LEAST * dynamics / np.maximum(size, 1e-300), dynamics)
        dynamics = np.where(dynamics == 0, LEAST, dynamics)
        residual = motion.spectrum.multiply(residual, 1.0 / dynamics)
    if way.delay > 0.0:
        later = np.arange(len(blind)) + round(way.delay / motion.sample_time)
        blind = blind[np.minimum(later, len(blind) - 1)]
    return residual, blind


def _from_rest(way: _Way) -> NDArray[np.complex128]:
    """Dynamics over their value at rest; unchanged where this value is zero."""
    return way.dynamics / way.dynamics[0] if way.dynamics[0] != 0 else way.dynamics


def _transmit(force: Array, way: _Way, motion: Motion) -> Array:
    """The part of a force that passes a transfer; a resonance does not amplify it."""
    # a coupling that opens during the motion has no dynamics at rest: the whole force passes
    gain = np.where(np.isfinite(way.gain), way.gain, 1.0)
    dynamics = np.where(np.isfinite(way.dynamics), way.dynamics, 1.0)
    limited = dynamics / np.maximum(np.abs(dynamics), 1.0)
    static = float(dynamics[0].real)
    if np.any(limited != 1.0):
        force = motion.spectrum.multiply(force, limited)
    else:
        static = 1.0
    varying = gain / static if static else np.ones(len(force))
    return np.asarray(force * np.clip(varying, -1.0, 1.0))


def blind_share(stretches: Sequence[ResidualAtCommand], motions: Sequence[Motion]) -> float:
    """Share of blind samples among those where the body slides; of all, where it never slides."""
    blind = np.concatenate([s.blind for s in stretches])
    slides = np.concatenate([m.direction != 0 for m in motions])
    counted = blind[slides] if slides.any() else blind
    return float(counted.mean()) if len(counted) else 0.0
