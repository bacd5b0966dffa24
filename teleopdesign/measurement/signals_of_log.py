"""From the columns of a log to the signals of a record: converted to SI, on the record's grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..base.sentences import percent
from .channel import Channel
from .encoder import Array, is_on_grid, reading_step
from .reading import ReadingStep, count_of
from .record_clock import RecordClock
from .repeated_rows import SLOWER
from .resample import Rule, filling_error, resample_on_grid
from .spikes import filled_spikes
from .tables import LogColumns


def signals_of_log(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    clock: RecordClock,
    file: str,
) -> tuple[dict[str, Array], list[ReadingStep]]:
    """The signals (n,) by channel, and the reading steps that made them."""
    signals: dict[str, Array] = {}
    of_bodies = {key: ch for key, ch in channels.items() if ch.body is not None}
    readings, steps = _readings_of_log(columns, of_bodies, clock, file)
    for key, channel in of_bodies.items():
        if channel.columns[0] in columns.stamps:
            signals[key], more = _resample_by_stamps(columns, key, channel, clock, file)
            steps += more
            continue
        values = readings[key]
        rule, step = rule_of(channel), encoder_step(channel, values)
        out = resample_on_grid(values, clock, rule, step=step, delay=channel.delay)
        signals[key] = _restore_steps(out, values, channel, step)
    if clock.lost:
        steps.append(_describe_lost_rows(readings, channels, clock, file))
    return signals, steps


def _readings_of_log(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    clock: RecordClock,
    file: str,
) -> tuple[dict[str, Array], list[ReadingStep]]:
    """Readings in SI at the clock's rows, of the channels on this clock, with spikes filled."""
    readings: dict[str, Array] = {}
    steps: list[ReadingStep] = []
    for key, channel in channels.items():
        conversion = channel.conversion
        conversion.refuse_other_counts(columns.values, f"{file}: channels.{key}")
        name = key.removeprefix("device.")
        if wraps := conversion.wraps(columns.values):
            text = f"{name} wraps {count_of(wraps, 'time')}"
            steps.append(ReadingStep(file, text, "unwrapped", "none"))
        if conversion.delay:
            text = f"{name} logged {1e3 * conversion.delay:.3g} ms late, as stated"
            steps.append(ReadingStep(file, text, "moved back", "none"))
        if channel.columns[0] not in columns.stamps:
            values = {c: columns.values[c][clock.rows] for c in channel.columns}
            readings[key] = channel.signal(values)
    for key in sorted(readings, key=lambda k: channels[k].quantity != "position"):
        position = readings.get(f"{channels[key].body}.position")
        readings[key], more = _fill_spikes(
            readings[key], key, channels[key], clock.of_rows, position, file
        )
        steps += more
    return readings, steps


def _fill_spikes(
    values: Array,
    key: str,
    channel: Channel,
    parts: Sequence[slice],
    position: Array | None,
    file: str,
) -> tuple[Array, list[ReadingStep]]:
    """The readings of a measured channel with their spikes filled, and the step that says so.

    parts: uninterrupted stretches
    position: of the same body in the same rows; without one a force stays as it is
    """
    is_force = channel.quantity in ("actuator_force", "interaction_force")
    if channel.quantity == "velocity" or (
        channel.quantity == "actuator_force" and not channel.measured
    ):
        return values, []  # a command may have any value; a velocity is only compared
    if is_force and position is None:
        return values, []  # a hit shows in the motion of the same rows only
    step = reading_step(values)
    filled, spikes = filled_spikes(values, step, parts, position if is_force else None)
    if not spikes.any():
        return values, []
    filled = _restore_steps(
        filled, values[~spikes], channel, encoder_step(channel, values[~spikes])
    )
    count, off = int(spikes.sum()), np.abs(filled - values)
    worst = float(off.max())
    name = key.removeprefix("device.")
    done = ReadingStep(
        file,
        f"{name}: {count_of(count, 'reading')} far off the course of the others, the worst by "
        f"{float(f'{worst / np.std(filled):.2g}'):g} standard deviations",
        "read as lost, filled by the curve through their neighbours",
        f"{percent(count / len(values), '.2g')} of the readings",
        topic="outliers",
        numbers=(("count", float(count)), ("row", float(np.argmax(off)) + 1.0), ("size", worst)),
    )
    return filled, [done]


def rule_of(channel: Channel) -> Rule:
    """The rule for the values of a channel between two rows."""
    rules: dict[str, Rule] = {"actuator_force": "held", "position": "position"}
    return rules.get(channel.quantity, "line")


def encoder_step(channel: Channel, values: Array) -> float:
    """Step of a position's encoder, stated or estimated from the readings; 0 for other channels."""
    if channel.quantity != "position":
        return 0.0
    return channel.resolution or reading_step(values)


def _restore_steps(out: Array, values: Array, channel: Channel, step: float) -> Array:
    """Round a position to the steps of its readings, if no resolution is stated.

    The resolution is then estimated from the readings, so interpolated values must keep the steps.
    """
    if out is values or channel.quantity != "position" or channel.resolution or step <= 0.0:
        return out
    if not is_on_grid(values, step):
        return out
    stepped = values[0] + step * np.round((out - values[0]) / step)
    return np.where(np.isin(out, values), out, stepped)


def _resample_by_stamps(
    columns: LogColumns,
    key: str,
    channel: Channel,
    clock: RecordClock,
    file: str,
) -> tuple[Array, list[ReadingStep]]:
    """A channel with separate time stamps, as those of a bag's topic, and its reading steps."""
    stamps = columns.stamps[channel.columns[0]]
    values = channel.signal(columns.values)
    fine = np.isfinite(values) & np.isfinite(stamps)
    order = np.argsort(stamps[fine], kind="stable")
    at, values = stamps[fine][order], values[fine][order]
    once = np.r_[True, np.diff(at) > 0]
    at, values = at[once], values[once]
    values, spikes = _fill_spikes(values, key, channel, [slice(None)], None, file)
    rule, step = rule_of(channel), encoder_step(channel, values)
    rate = _rate_within(at, clock)
    if channel.quantity == "interaction_force" and rate * clock.sample_time < SLOWER:
        rule = "position"  # a line between slow readings would weaken what changes fast
    out = resample_on_grid(values, clock, rule, step=step, delay=channel.delay, stamps=at)
    words = {"held": "held until its next", "position": "interpolated", "line": "interpolated"}
    text = f"{key.removeprefix('device.')} has stamps of its own, {rate:.4g} Hz"
    done = ReadingStep(
        file,
        text,
        words[rule],
        "none",
        numbers=(("rate", rate),),
        interpolates=rule == "position",
        channel=key,
    )
    return _restore_steps(out, values, channel, step), [*spikes, done]


def _rate_within(stamps: Array, clock: RecordClock) -> float:
    """Stamps a second (Hz) within the segments of a record."""
    ends = [clock.time[[s.start, s.stop - 1]] for s in clock.segments]
    inside = [stamps[(stamps >= first) & (stamps <= last)] for first, last in ends]
    lasting = sum(float(np.ptp(part)) for part in inside if len(part))
    return sum(len(part) - 1 for part in inside if len(part)) / max(lasting, 1e-300)


def _describe_lost_rows(
    readings: Mapping[str, Array],
    channels: Mapping[str, Channel],
    clock: RecordClock,
    file: str,
) -> ReadingStep:
    """Reading step for lost rows: their number, the filling, its error where it can be tested.

    readings: of the channels on this clock, at its rows
    """
    lost = clock.lost
    part = lost / len(clock.time)
    error = force = 0.0
    positions = []
    for key, values in readings.items():
        channel = channels[key]
        if channel.quantity == "velocity":
            continue
        step = encoder_step(channel, values)
        wrong = filling_error(values, clock, rule_of(channel), step=step)
        if channel.quantity == "position":
            unit = f"{float(f'{wrong / step:.2g}'):g} steps" if step > 0 else f"{wrong:.2g}"
            positions.append(unit)
        elif channel.quantity in ("actuator_force", "interaction_force"):
            error += part * wrong**2
            force += float(np.mean(values**2))
    size = float(np.sqrt(error / force)) if force > 0 else float("nan")
    return ReadingStep(
        file,
        f"{count_of(lost, 'row')} lost, {percent(part, '.2g')}",
        "filled: positions by the curve through their neighbours, commands by the line between",
        f"adds at most {percent(size, '.2g')} of the force"
        + (f"; positions there err by {' and '.join(positions)}" if positions else ""),
        size,
        "lost rows",
        (("lost", float(lost)), ("part", part), ("force_error", size)),
    )
