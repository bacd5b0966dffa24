"""Checks of a recording: clock, gaps, outliers, stuck and clipped channels, steps, noise, shifts.

    from teleopdesign.measurement.soundness import check_signals

    for finding in check_signals(experiment):
        print(finding)

No model is needed. `teleopdesign.diagnose` compares forces with the motion. Errors that
`load_experiment` refuses (columns without numbers, unknown units) are not checked here.
"""

from __future__ import annotations

from ...base.finding import Finding
from ..experiment import Experiment
from .clipping import check_clipped
from .clock import check_clock, clock_in_order
from .encoder_steps import check_steps
from .force_steps import check_force_steps, check_lost_force
from .held_samples import check_constant, check_repeats, check_stuck, check_update
from .log_reading import check_reading
from .mains_hum import check_hum
from .noise import check_noise
from .outliers import check_jumps, check_outliers
from .segments import check_segments
from .signal import Signal, signals
from .time_shift import check_velocity

__all__ = ["check_signals"]


def check_signals(experiment: Experiment) -> tuple[Finding, ...]:
    """Findings about the clock and the channels of every record.

    A finding "fine" about the clock, or about the channels, comes last if nothing is wrong with
    them.
    """
    read = signals(experiment)
    findings: list[Finding] = []
    for record in experiment.records:
        record_signals = [s for s in read if s.record is record]
        findings += check_clock(experiment, record, record_signals)
        findings += check_segments(record)
        findings += check_reading(record)
        for signal in record_signals:
            findings += _check_channel(signal, [s for s in record_signals if s is not signal])
        for position, velocity in _pairs(record_signals):
            findings += check_velocity(position, velocity)
    if not any(f.topic == "sample clock" for f in findings):
        findings.append(clock_in_order(experiment))
    if not any(f.concern == "warning" and f.topic != "sample clock" for f in findings):
        findings.append(_channels_in_order(read))
    return tuple(findings)


def _check_channel(signal: Signal, others: list[Signal]) -> list[Finding]:
    constant = check_constant(signal)
    if constant or signal.channel.quantity == "velocity":
        return constant  # a velocity is only compared with the position
    findings = [*check_stuck(signal), *check_clipped(signal), *check_outliers(signal)]
    findings += [*check_jumps(signal), *check_repeats(signal), *check_update(signal)]
    findings += [*check_force_steps(signal), *check_lost_force(signal), *check_hum(signal, others)]
    return findings + check_steps(signal, others) + check_noise(signal, others)


def _pairs(record_signals: list[Signal]) -> list[tuple[Signal, Signal]]:
    """Position and velocity channel of each body that has both."""
    by = {(s.channel.body, s.channel.quantity): s for s in record_signals}
    return [
        (s, by[(body, "velocity")])
        for (body, quantity), s in by.items()
        if quantity == "position" and (body, "velocity") in by
    ]


def _channels_in_order(read: list[Signal]) -> Finding:
    names = ", ".join(dict.fromkeys(s.name for s in read))
    return Finding(
        "channels",
        "fine",
        f"{names}: no outliers, no stuck or clipped stretches; steps and noise as stated.",
        {"samples": float(sum(len(s.values) for s in read))},
    )
