"""Clock drift between channels: a lag that grows evenly along a record.

A channel of another computer has another clock. If its row at time t holds the value of time
(1 + r) t, its lag is -r t. The balance of forces on each quarter of the records gives the lag
there: it grows along a straight line, and a quarter leaves less force unexplained than the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.finding import Finding
from ..blocks import Body
from ..measurement.filtering import Array
from ..measurement.prepare import Stretch
from .force_balance import Estimate, ForceBalance, force_balance

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


@dataclass(frozen=True)
class Drift:
    """A channel whose lag grows along the records.

    channel: "actuator_force", "interaction_force" or "position"
    rate: its row at time t holds the value of time (1 + rate) t
    first, last: its lag in the first and in the last quarter, s
    left: residual force over measured force (rms) in the quarters
    """

    channel: str
    rate: float
    first: float
    last: float
    left: float


def find_drift(body: Body, stretches: Sequence[Stretch], balance: ForceBalance) -> Drift | None:
    """The drift of one channel of a body; None where no lag grows evenly.

    stretches: of this body;  balance: of all their rows
    """
    middles, parts = _quarters(stretches)
    balances = [force_balance(body, part) for part in parts]
    quarters = [b for b in balances if b is not None]
    if len(quarters) < QUARTERS:
        return None
    left = float(np.sqrt(np.mean([b.left**2 for b in quarters])))
    if left**2 > LEFT * balance.left**2:
        return None
    forces = [n for n in (balance.lead, balance.other) if n]
    lags = {n: [_lag_of(b, n) for b in quarters] for n in forces}
    rates = {n: -float(np.polyfit(middles, [e.value for e in lags[n]], 1)[0]) for n in forces}
    channel = max(forces, key=lambda n: abs(rates[n]))
    rate, ends = rates[channel], (lags[channel][0], lags[channel][-1])
    step = max(s.motion.sample_time for s in stretches)
    if not _grows_evenly(middles, lags[channel], rate, step):
        return None
    others = [abs(rates[n] / rate - 1.0) for n in forces if n != channel]
    if all(x <= STRAIGHT for x in others) and others:  # both forces alike: it is the position's
        return Drift("position", -rate, -ends[0].value, -ends[1].value, left)
    if any(abs(rates[n]) > STRAIGHT * abs(rate) for n in forces if n != channel):
        return None
    return Drift(channel, rate, ends[0].value, ends[1].value, left)


def report_drift(label: str, balance: ForceBalance, drift: Drift) -> Finding:
    """A warning on a channel whose lag grows along the records;  label: of the channel."""
    behind = "the forces" if drift.channel == "position" else "the motion"
    ends = [f"{1e3 * t:.2g}" for t in (drift.first, drift.last)]
    text = (
        f"{label}: its lag behind {behind} goes from {ends[0]} ms in the first quarter of the "
        f"records to {ends[1]} ms in the last: it has another clock. Its row at time t holds the "
        f"value of time {1.0 + drift.rate:.5g} t: multiply its times by about this number, or log "
        f"all channels by one clock; a delay corrects the mean alone ({100 * balance.left:.2g} % "
        f"of the force in motion is left unexplained, {100 * drift.left:.2g} % in a quarter)."
    )
    numbers = {"rate": drift.rate, "first": drift.first, "last": drift.last, "left": drift.left}
    return Finding("clock drift", "warning", text, numbers, balance.body)


def _quarters(stretches: Sequence[Stretch]) -> tuple[Array, list[list[Stretch]]]:
    """Mean time since the start of their record of the rows in each quarter, and these rows."""
    starts: dict[str, float] = {}
    for s in stretches:
        begin = float(s.motion.time[0])
        starts[s.motion.file] = min(begin, starts.get(s.motion.file, begin))
    times = [s.motion.time[s.keep] - starts[s.motion.file] for s in stretches]
    longest = max(float(t[-1]) for t in times if len(t))
    middles, parts = [], []
    for k in range(QUARTERS):
        inside = [
            (t >= k * longest / QUARTERS) & (t <= (k + 1) * longest / QUARTERS) for t in times
        ]
        rows = np.concatenate([t[i] for t, i in zip(times, inside, strict=True)])
        middles.append(float(rows.mean()) if len(rows) else (k + 0.5) * longest / QUARTERS)
        part = [
            replace(s, keep=s.keep[i]) for s, i in zip(stretches, inside, strict=True) if i.any()
        ]
        parts.append(part)
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
