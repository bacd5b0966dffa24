"""The actuation along a measured motion: from the recorded command to the force that acts.

Input and output of a stage are averages over the hold of a row. Where a command acts late, they are
averages over parts of the row, because edges of the held command then lie between the rows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import sympy as sp

from ..blocks import Body
from ..effects import SIGNALS, Effect, delayed
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from .scan import exact_scan
from .traced import Along, Traced, filter_traced, joined_rows

#: signals of the motion that a stage may use
_MOTION = ("time", "position", "velocity", "acceleration")
_COMMAND = SIGNALS["command"]
#: parts of a row over which a late command is averaged, and most parts of a sample that stands for
#: several rows. The longest sample is a fifth of a period at the bandwidth: an average over it
#: would weaken the force by 1 %, an average over a sixteenth of it by 0.03 %
PARTS, MOST_PARTS = 4, 16
#: the cubic through samples that are a hold less, none, one and two holds late: its coefficients of
#: the powers 0 to 3 (rows) by each sample
_CUBIC = np.array([[0, 6, 0, 0], [-2, -3, 6, -1], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6.0
#: name of the time by which the log of a body's command is late, used besides the body's parameters
RECORD_SHIFT = "record_shift"
#: the same of the time by which the log of the hand's force is late
INTERACTION_SHIFT = "interaction_shift"
#: symbols of these times among the columns of tangents; no law contains them
COMMAND_LATE = sp.Symbol(RECORD_SHIFT, real=True)
INTERACTION_LATE = sp.Symbol(INTERACTION_SHIFT, real=True)


@dataclass(frozen=True)
class ActuationStage:
    """A stage of the actuation along a motion: its input, hidden states and output.

    law: on symbols, its delayed signals as separate symbols;  delays: those symbols -> s
    signals: symbols -> signals over `parts` equal parts of each row;  output: likewise
    """

    effect: Effect
    law: sp.Expr
    delays: Mapping[sp.Symbol, float]
    signals: Mapping[sp.Symbol, Traced]
    parts: int
    output: Traced


def acting_along(body: Body, motion: Motion, along: Along) -> Traced:
    """Acting force at the rows.

    along: signals at the rows, the command among them
    """
    stages = stages_along(body, motion, along)
    acting = filter_traced(motion.at_rows, stages[-1].output if stages else along.signals[_COMMAND])
    if COMMAND_LATE in along.columns:
        slope = motion.spectrum.multiply(acting.value, motion.spectrum.derivative(1))
        tangent, place = acting.tangent.copy(), along.columns.index(COMMAND_LATE)
        tangent[place] += slope
        acting = Traced(acting.value, tangent, joined_rows(acting, more=[place]))
    return acting


def stages_along(body: Body, motion: Motion, along: Along) -> list[ActuationStage]:
    """Each stage of the actuation, on averages over the hold of a row, or over parts of it.

    along: signals at the rows, the command among them
    """
    effects = along.present(body.effects, "actuation")
    if not effects:
        return []
    laws = [law for e in effects for law in (e.expression(), *e.rates().values())]
    late = any(e.states or e.expression().has(delayed) for e in effects)
    parts = min(PARTS * motion.merged, MOST_PARTS) if late else 1
    signal = filter_traced(lambda y: np.repeat(y, parts, axis=-1), along.signals[_COMMAND])
    signals = {
        SIGNALS[name]: along.constant(np.repeat(getattr(motion, name), parts))
        for name in _MOTION
        if any(law.has(SIGNALS[name]) for law in laws)
    }
    fine = replace(along, signals=signals, step=along.step / parts)
    stages: list[ActuationStage] = []
    for effect in effects:
        stages.append(_stage(effect, fine.with_signals({_COMMAND: signal}), parts))
        signal = stages[-1].output
    return stages


def _stage(effect: Effect, along: Along, parts: int) -> ActuationStage:
    """A stage of the actuation, as averages over each step of its command."""
    law, calls = _with_late_symbols(effect.expression())
    delays = {symbol: max(_value_at(delay, along.values), 0.0) for symbol, delay in calls}
    along = along.with_signals({symbol: _shift(along, delay) for symbol, delay in calls})
    if effect.states:
        (state,) = effect.state_symbols().values()
        along = along.with_signals({state: exact_scan(effect, along)[0]})
    return ActuationStage(effect, law, delays, along.signals, parts, along.evaluate(law))


@lru_cache(maxsize=512)
def _with_late_symbols(law: sp.Expr) -> tuple[sp.Expr, tuple[tuple[sp.Symbol, sp.Expr], ...]]:
    """The law with a symbol for each delayed signal, and the delay of each symbol."""
    calls = []
    for i, call in enumerate(sorted(law.atoms(delayed), key=str)):
        symbol = sp.Symbol(f"delayed_{i}", real=True)
        law = law.subs(call, symbol)
        calls.append((symbol, call.args[1]))
    return law, tuple(calls)


def _shift(along: Along, delay: sp.Expr) -> Traced:
    """The held command delayed by `delay`, averaged over each hold.

    Between holds by the cubic through four of them. The line through two would weaken a wave of
    angular frequency w by up to (w h)^2/8, where h is the length of a hold; a search would then
    prefer delays of whole holds.
    """
    signal, step = along.signals[_COMMAND], along.step
    whole, part = divmod(max(_value_at(delay, along.values), 0.0) / step, 1.0)
    weights = np.array([1.0, part, part**2, part**3]) @ _CUBIC
    slopes = np.array([0.0, 1.0, 2.0 * part, 3.0 * part**2]) @ _CUBIC

    def mix(y: Array, factors: Array) -> Array:
        holds = (f * _delay_samples(y, int(whole) + k - 1) for k, f in enumerate(factors) if f)
        return sum(holds, np.zeros_like(y))

    shifted = filter_traced(lambda y: mix(y, weights), signal)
    tangent = shifted.tangent.copy()
    slope = mix(signal.value, slopes) / step
    by_delay = [i for i, c in enumerate(along.columns) if isinstance(c, sp.Symbol) and delay.has(c)]
    for i in by_delay:
        tangent[i] += slope * _value_at(sp.diff(delay, along.columns[i]), along.values)
    return Traced(shifted.value, tangent, joined_rows(shifted, more=by_delay))


def _value_at(law: sp.Expr, values: Mapping[sp.Symbol, float]) -> float:
    """Value of a law; that of one parameter or of a number without sympy's slow substitution."""
    if law in values:
        return values[law]
    return float(law if law.is_Number else law.subs(values))


def _delay_samples(y: Array, steps: int) -> Array:
    """Signals (..., n) delayed by `steps` samples (-1: one early); the ends keep their value."""
    n = y.shape[-1]
    first, kept = min(max(steps, 0), n), max(min(n - abs(steps), n), 0)
    delayed_signals = np.empty(y.shape)
    delayed_signals[..., :first] = y[..., :1]
    delayed_signals[..., first : first + kept] = y[..., max(-steps, 0) : max(-steps, 0) + kept]
    delayed_signals[..., first + kept :] = y[..., -1:]
    return delayed_signals
