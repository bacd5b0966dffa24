"""Channels that are late or early against the others, by a constant time or by another clock.

A channel of another computer has another clock. If its row at time t holds the value of time
(1 + r) t, its lag is -r t. The balance of forces on each quarter of the records gives the lag
there: it grows along a straight line, and a quarter leaves less force unexplained than the whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base.finding import Concern, Finding
from ..base.sentences import percent
from ..blocks import Body
from ..check import CheckedRecording
from ..effects import EFFECTS
from ..measurement.filtering import Array
from ..measurement.limits import HALF
from ..measurement.prepare import Stretch
from ..measurement.record_clock import CLOCK
from ._force_balance import Estimate, ForceBalance, force_balance
from ._force_timing import phase_of_shift

#: parts of the records, by time: fewer show no straight line, more have too few reversals each
QUARTERS = 4
#: fewest rows by which the lag must grow: a diagnosis bears less (docs/trust.md, "Dirty records")
ROWS = 1.0
#: largest distance of a lag from the straight line, and largest growth of the lag of a force that
#: does not drift, over the growth. A lag of friction or a gap follows the motion, not the time
STRAIGHT = 0.25
#: part of the squares that the whole leaves unexplained, which the quarters leave at most. A
#: constant lag leaves as much in each quarter; nine of twelve simulated drifts by 0.001 of the time
#: are found. 52 bodies without a drift have none without this limit either
LEFT = 0.8
#: part of the force that is left unexplained, above which a shift is not the only mistake, and two
#: columns may be swapped
UNEXPLAINED = 0.25
#: part of the force that is left unexplained, up to which a shift that is larger than that of a
#: usual logger is believed
EXPLAINED = 0.03
#: rows from which a channel is late: to half a row, stamps and rows are one
LATE = 0.5


def check_lateness(recording: CheckedRecording, balance: ForceBalance) -> Iterator[Finding]:
    """A finding on channels that are late or early, by another clock or by a constant time."""
    model, prepared = recording.compared
    stretches = [s for s in prepared.of("fit") if s.motion.body == balance.body]
    labels = {n: recording.label(f"{balance.body}.{n}") for n in _CHANNELS}
    if balance.shifts and balance.left <= UNEXPLAINED:
        drift = _drift(model.body(balance.body), stretches, balance, labels)
        if drift is not None:
            yield drift
            return
    h = max(s.motion.sample_time for s in stretches)
    late = {n: e.value for n, e in balance.shifts.items() if e.sure and abs(e.value) >= LATE * h}
    if not late:
        return
    is_alone = f"{balance.body}.interaction_force" not in prepared.experiment.channels
    concern, remedy = _remedy(late, labels, balance, stretches, is_alone=is_alone)
    if concern == "warning" and _is_of_friction(model.body(balance.body), stretches, late):
        concern, remedy = "note", "friction that the model lacks looks the same: no delay for it"
    parts = [
        f"{labels[n]} {'lags' if t > 0 else 'leads'} "
        f"{'the forces' if n == 'position' else 'the motion'} by {1e3 * abs(t):.2g} ms "
        f"({abs(t / h):.1f} samples)"
        for n, t in late.items()
    ]
    before, after = (percent(e, ".2g") for e in (balance.unshifted, balance.left))
    shares = f"{before} -> {after} of the force in motion"
    numbers = {f"{n}.lag": t for n, t in late.items()}
    numbers |= {"left": balance.left, "unshifted": balance.unshifted, "sample_time": h}
    sentence = f"{' and '.join(parts)}: {remedy} ({shares} left unexplained)."
    yield Finding("time shift", concern, sentence, numbers, balance.body)


_CHANNELS = ("position", "actuator_force", "interaction_force")


def _remedy(
    late: Mapping[str, float],
    labels: Mapping[str, str],
    balance: ForceBalance,
    stretches: Sequence[Stretch],
    *,
    is_alone: bool,
) -> tuple[Concern, str]:
    """How much shifts matter, and what to do about them.

    late: channel -> s;  labels: channel -> its name as the user writes it
    is_alone: whether no force of a hand is in the log
    """
    h = max(s.motion.sample_time for s in stretches)
    (channel, seconds), less = next(iter(late.items())), max(map(abs, late.values()))
    alike = "may look the same: no delay before you know it"
    turned = phase_of_shift(stretches, less)
    if turned > 1.0:
        return "note", (
            f"on a motion of one frequency this is a phase of {turned:.2g} rad, and a wrong gain "
            f"or a missing force {alike}"
        )
    if less < h or balance.left > UNEXPLAINED or len(late) > 1:
        # a shift by whole samples alone does not explain it: something between force and motion may
        return "note", "columns are shifted, or something between them is compliant"
    if is_alone and less > CLOCK.latest and balance.left > EXPLAINED:
        return "note", (
            "hardly any logger is so late, and a hand that is not logged, or a force that the "
            f"model lacks, {alike}"
        )
    write = f'write delay = {{ value = {1e3 * seconds:.3g}, unit = "ms" }}'
    write += f" at channels.{labels[channel]}"
    if channel != "actuator_force":
        return "warning", write
    if less <= CLOCK.early * h:
        return "note", "a diagnosis counts up to a row of it as a delay of the logger"
    if seconds < 0.0:  # a cause before its effect: physics does that too
        return "note", "the actuator is late, or the position is logged late"
    return "warning", f"{write}{', or leave it to a diagnosis' * (seconds <= CLOCK.latest)}"


def _is_of_friction(body: Body, stretches: Sequence[Stretch], late: Mapping[str, float]) -> bool:
    """Whether a lag is gone, or another one, beside friction of any form over the speed.

    late: channel -> s
    """
    top = max(float(np.abs(s.motion.velocity).max()) for s in stretches)
    free = EFFECTS["free_friction"]
    nothing = dict.fromkeys(free.parameters, 0.0)
    beside = force_balance(body.with_effect(free, {**nothing, "upper": top}), stretches)
    shifts = {} if beside is None else beside.shifts
    return any(n not in shifts or abs(shifts[n].value - t) > HALF * abs(t) for n, t in late.items())


def _drift(
    body: Body,
    stretches: Sequence[Stretch],
    balance: ForceBalance,
    labels: Mapping[str, str],
) -> Finding | None:
    """A warning on the channel of a body whose lag grows evenly; None: there is none.

    stretches: of this body;  balance: of all their rows
    """
    middles, parts = _quarters(stretches)
    quarters = [b for part in parts if (b := force_balance(body, part)) is not None]
    left = float(np.sqrt(np.mean([b.left**2 for b in quarters]))) if quarters else 0.0
    if len(quarters) < QUARTERS or left**2 > LEFT * balance.left**2:
        return None
    forces = [n for n in (balance.lead, balance.other) if n]
    lags = {n: [_lag_of(b, n) for b in quarters] for n in forces}
    rates = {n: -float(np.polyfit(middles, [e.value for e in lags[n]], 1)[0]) for n in forces}
    channel = max(forces, key=lambda n: abs(rates[n]))
    rate, ends = rates[channel], (lags[channel][0].value, lags[channel][-1].value)
    step = max(s.motion.sample_time for s in stretches)
    if not _grows_evenly(middles, lags[channel], rate, step):
        return None
    behind, others = "the motion", [rates[n] for n in forces if n != channel]
    if others and all(abs(r / rate - 1.0) <= STRAIGHT for r in others):
        # both forces alike: it is the position's
        channel, rate, ends, behind = "position", -rate, (-ends[0], -ends[1]), "the forces"
    elif any(abs(r) > STRAIGHT * abs(rate) for r in others):
        return None
    sentence = (
        f"{labels[channel]}: its lag behind {behind} goes from {1e3 * ends[0]:.2g} ms in the first "
        f"quarter of the records to {1e3 * ends[1]:.2g} ms in the last: it has another clock. Its "
        f"row at time t holds the value of time {1.0 + rate:.5g} t: multiply its times by about "
        "this number, or log all channels by one clock; a delay corrects the mean alone "
        f"({percent(balance.left, '.2g')} of the force in motion is left unexplained, "
        f"{percent(left, '.2g')} in a quarter)."
    )
    numbers = {"rate": rate, "first": ends[0], "last": ends[1], "left": left}
    return Finding("clock drift", "warning", sentence, numbers, balance.body)


def _quarters(stretches: Sequence[Stretch]) -> tuple[Array, list[list[Stretch]]]:
    """Mean time since the start of their record of the rows in each quarter, and these rows."""
    starts: dict[str, float] = {}
    for s in stretches:
        begin = float(s.motion.time[0])
        starts[s.motion.file] = min(begin, starts.get(s.motion.file, begin))
    times = [s.motion.time[s.keep] - starts[s.motion.file] for s in stretches]
    length = max(float(t[-1]) for t in times if len(t)) / QUARTERS
    middles, parts = [], []
    for k in range(QUARTERS):
        inside = [(t >= k * length) & (t <= (k + 1) * length) for t in times]
        rows = np.concatenate([t[i] for t, i in zip(times, inside, strict=True)])
        middles.append(float(rows.mean()) if len(rows) else (k + 0.5) * length)
        pairs = zip(stretches, inside, strict=True)
        parts.append([replace(s, keep=s.keep[i]) for s, i in pairs if i.any()])
    return np.array(middles), parts


def _lag_of(balance: ForceBalance, force: str) -> Estimate:
    """The lag of a force behind the motion; that of the position counts for every force."""
    if "position" in balance.shifts:
        late = balance.shifts["position"]
        return Estimate(-late.value, late.error)
    return balance.shifts.get(force, Estimate(0.0, 0.0))


def _grows_evenly(middles: Array, lags: Sequence[Estimate], rate: float, step: float) -> bool:
    """Whether the lag surely grows, by at least `ROWS`, and near a straight line."""
    values = np.array([e.value for e in lags])
    growth = abs(rate) * float(middles[-1] - middles[0])
    change = Estimate(values[-1] - values[0], float(np.hypot(lags[0].error, lags[-1].error)))
    off = values + rate * middles
    return bool(
        growth >= ROWS * step
        and change.sure
        and np.abs(off - off.mean()).max() <= STRAIGHT * growth
    )
