"""Channels that are late or early against the others, by a constant time or by another clock."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from ..base.finding import Finding
from ..measurement.logger_clock import CLOCK
from ..measurement.prepare import Prepared
from ..measurement.soundness.signal import channel_label
from ..model import Model
from .clock_drift import find_drift, report_drift
from .force_balance import ForceBalance
from .force_timing import phase_of_shift

#: part of the force that is left unexplained, above which a shift is not the only mistake
UNEXPLAINED = 0.25
#: part of the force that is left unexplained, up to which a shift that is larger than that of a
#: usual logger is believed
EXPLAINED = 0.03


def label_of(prepared: Prepared, body: str, quantity: str) -> str:
    """The channel of a quantity of a body, as the experiment names it."""
    return channel_label(prepared.experiment, f"{body}.{quantity}")


def is_without_hand(prepared: Prepared, balance: ForceBalance) -> bool:
    """Whether no force of a hand on this body is in the log."""
    return f"{balance.body}.interaction_force" not in prepared.experiment.channels


def check_lateness(model: Model, prepared: Prepared, balance: ForceBalance) -> Iterator[Finding]:
    """A finding on channels that are late or early by half a sample or more."""
    if balance.shifts and balance.left <= UNEXPLAINED:
        stretches = [s for s in prepared.of("fit") if s.motion.body == balance.body]
        drift = find_drift(model.body(balance.body), stretches, balance)
        if drift is not None:
            yield report_drift(label_of(prepared, balance.body, drift.channel), balance, drift)
            return
    h = max(s.motion.sample_time for s in prepared.of("fit") if s.motion.body == balance.body)
    late = {n: e.value for n, e in balance.shifts.items() if e.sure and abs(e.value) >= 0.5 * h}
    if not late:
        return
    parts = [
        f"{label_of(prepared, balance.body, n)} "
        + _describe_lateness(t, h, "the forces" if n == "position" else "the motion")
        for n, t in late.items()
    ]
    concern: Literal["note", "warning"] = "warning"
    first, seconds = next(iter(late.items()))
    where = label_of(prepared, balance.body, first)
    remedy = f'write delay = {{ value = {1e3 * seconds:.3g}, unit = "ms" }} at channels.{where}'
    less = max(map(abs, late.values()))
    turned = phase_of_shift(prepared.of("fit"), balance.body, less)
    if turned > 1.0:
        concern = "note"
        remedy = f"on a motion of one frequency this is a phase of {turned:.2g} rad, and a wrong "
        remedy += "gain or a missing force may look the same: no delay before you know it"
    elif less < h or balance.left > UNEXPLAINED or len(late) > 1:
        # a shift by whole samples alone does not explain it: something between force and motion may
        concern, remedy = "note", "columns are shifted, or something between them is compliant"
    elif is_without_hand(prepared, balance) and less > CLOCK.latest and balance.left > EXPLAINED:
        concern, remedy = "note", "hardly any logger is so late, and a hand that is not logged, or "
        remedy += "a force that the model lacks, may look the same: no delay before you know it"
    elif set(late) == {"actuator_force"} and less <= CLOCK.early * h:
        concern, remedy = "note", "a diagnosis counts up to a row of it as a delay of the logger"
    elif set(late) == {"actuator_force"} and 0.0 < seconds <= CLOCK.latest:
        remedy += ", or leave it to a diagnosis"
    elif late.get("actuator_force", 0.0) < 0:
        # a cause before its effect: physics does that too
        concern, remedy = "note", "the actuator is late, or the position is logged late"
    numbers = {f"{n}.lag": t for n, t in late.items()}
    numbers |= {"left": balance.left, "unshifted": balance.unshifted, "sample_time": h}
    shares = f"{100 * balance.unshifted:.2g} -> {100 * balance.left:.2g} % of the force in motion"
    text = " and ".join(parts)
    yield Finding(
        "time shift",
        concern,
        f"{text}: {remedy} ({shares} left unexplained).",
        numbers,
        balance.body,
    )


def _describe_lateness(seconds: float, sample_time: float, behind: str) -> str:
    samples = seconds / sample_time
    word = "lags" if seconds > 0 else "leads"
    return f"{word} {behind} by {1e3 * abs(seconds):.2g} ms ({abs(samples):.1f} samples)"
