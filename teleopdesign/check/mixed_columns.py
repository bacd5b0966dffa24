"""Channels whose content is not what their label says: a clock in ms, swapped columns.

This shows without a model: inertia and friction explain a force by the motion, but not a position
by a force, and no machine is logged once in ten seconds.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..base.finding import Finding
from ..measurement.experiment import Experiment
from ..measurement.first_guess import explain_force
from ..measurement.soundness.signal import channel_label

#: Hz: lowest and highest plausible rate of a log
SLOWEST, FASTEST = 5.0, 1e6
#: columns seem exchanged if the motion explains less than AS_LOGGED of the force as logged, and
#: more than EXCHANGED of it the other way round. On the recordings of `fetch` and twelve simulated
#: ones the part is 0.47 to 1.0 for columns in their places, and, with one exception (0.43), at most
#: 0.2 for exchanged columns
AS_LOGGED, EXCHANGED = 0.25, 0.6


def check_clock_unit(experiment: Experiment) -> Iterator[Finding]:
    """Findings on a sample rate that no logger has: the unit of the time is wrong."""
    for record in experiment.records:
        rate = 1.0 / record.sample_time
        if SLOWEST <= rate <= FASTEST:
            continue
        channel = experiment.channels.get("time")
        unit = "s" if channel is None else channel.unit
        smaller = {"s": "ms", "ms": "us", "us": "ns"}.get(unit, "ms")
        larger = {"ms": "s", "us": "ms", "ns": "us"}.get(unit, "s")
        meant = smaller if rate < SLOWEST else larger
        yield Finding(
            "sample clock",
            "warning",
            f"{rate:.4g} samples a second: the time is in {meant}, given as {unit}; write "
            f'unit = "{meant}" at channels.time.',
            {"rate": rate},
            record.file,
        )


def check_mixed_columns(experiment: Experiment) -> Iterator[Finding]:
    """Findings on columns of position and force that are exchanged within one body."""
    record = experiment.fit_records[0]
    rows = max(record.segments, key=lambda s: s.stop - s.start)
    for body in experiment.bodies:
        force, position = (
            record.signals[f"{body}.{q}"][rows] for q in ("actuator_force", "position")
        )
        hand = record.signals.get(f"{body}.interaction_force")
        other = 0.0 if hand is None else hand[rows]
        if force.std() == 0.0 or position.std() == 0.0:
            continue
        as_logged = explain_force(force + other, position, record.sample_time)
        exchanged = explain_force(position + other, force, record.sample_time)
        if as_logged.explained < AS_LOGGED and exchanged.explained > EXCHANGED:
            keys = [f"{body}.{q}" for q in ("position", "actuator_force")]
            names = [channel_label(experiment, key) for key in keys]
            columns = [experiment.channels[key].column for key in keys]
            yield Finding(
                "swapped columns",
                "warning",
                f"the columns of {names[0]} and {names[1]} seem swapped: motion explains "
                f"{100 * max(as_logged.explained, 0.0):.2g} % of the force, "
                f"{100 * exchanged.explained:.2g} % the other way round; write "
                f'column = "{columns[1]}" at channels.{names[0]} and column = "{columns[0]}" at '
                f"channels.{names[1]}.",
                {"as_given": as_logged.explained, "swapped": exchanged.explained},
                body,
            )
