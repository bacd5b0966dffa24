"""Friction curves: points of constant speed and force, the commonest form of friction data.

    actuator_force = friction(velocity) + bias

An experiment with `kind = "friction curve"` has no time. Its records are points, a row each: the
speed of a long run, and the mean force that holds it. Points at rest tell no friction of the speed
and are left out. The points are sorted in four groups with every fourth speed, so that a block of
rows that is held out has speeds of the whole range; readings of one speed stay together.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError
from ..base.toml import Table
from .channel import Channel, channels_from
from .description import ONE_BODY, BodyDescription, ModelValue, bodies_from
from .filtering import Array, spectrum
from .limits import SEVERAL
from .motion import Motion
from .reading import ReadingStep, count_of
from .record import Record, RecordEntry
from .tables import LogColumns

#: kind of an experiment
CURVE = "friction curve"
#: channels of a friction curve
CHANNELS = ("velocity", "actuator_force")
#: blocks of rows that are held out in turn where there is no check record; of a friction curve,
#: each has every so many-th speed
FOLDS = 4
#: part by which speeds may differ and count as one: runs are held no better
SAME_SPEED = 0.01


def bodies_and_channels(
    content: Table,
) -> tuple[dict[str, BodyDescription], dict[str, Channel]]:
    """The body and the channels of a friction curve; the inertia is fixed, for nothing accelerates.

    raises ExperimentError: several bodies, or other channels than `CHANNELS`
    """
    model, channels = content.table("model"), content.table("channels")
    bodies = bodies_from(model)
    if tuple(bodies) != ONE_BODY:
        raise ExperimentError(f"{model.where()}: a {CURVE} has one body, [model.device]")
    if others := [n for n in channels.content if n.removeprefix("device.") not in CHANNELS]:
        raise ExperimentError(
            f"{channels.where(others[0])}: a {CURVE} has no time and two channels, "
            f"{' and '.join(CHANNELS)}"
        )
    body = bodies["device"]
    inertia = body.inertia or ModelValue(0.0, None, True, body.where)
    fixed = replace(body, inertia=replace(inertia, fixed=True))
    read = channels_from(channels, bodies, required=CHANNELS)
    return {"device": fixed}, read


def curve_record(
    columns: LogColumns, entry: RecordEntry, channels: Mapping[str, Channel]
) -> Record:
    """The points of one table in SI, in the groups that are held out in turn.

    raises ExperimentError: no point has a speed and a force
    """
    file, use, offset_names, _ = entry
    signals = {key: channel.signal(columns.values) for key, channel in channels.items()}
    velocity, force = (signals[f"device.{name}"] for name in CHANNELS)
    known = np.isfinite(velocity) & np.isfinite(force)
    moving = known & (velocity != 0.0)
    if not moving.any():
        raise ExperimentError(f"{file}: found no row with a speed and a force, expected points")
    steps = list(columns.steps(file))
    for count, what in (
        (np.sum(~known), "without a number"),
        (np.sum(known & ~moving), "at rest, where friction takes any value up to its level"),
    ):
        if count:
            steps.append(
                ReadingStep(file, f"{count_of(int(count), 'row')} {what}", "left out", "none")
            )
    rows = np.flatnonzero(moving)
    numbers = speed_numbers(velocity[rows])
    # the points of every fourth speed follow one another
    rows = rows[np.lexsort((numbers, numbers % FOLDS))]
    return Record(
        file,
        use,
        offset_names,
        np.arange(len(rows), dtype=float),
        1.0,
        (slice(0, len(rows)),),
        {key: signal[rows] for key, signal in signals.items()},
        tuple(steps),
    )


def speed_numbers(velocity: Array) -> NDArray[np.intp]:
    """Number of the speed of each point (n,), in the order of the speeds; equal for one speed."""
    order = np.argsort(velocity, kind="stable")
    numbers, number, first = np.zeros(len(velocity), dtype=np.intp), -1, np.nan
    for row in order:
        if not abs(velocity[row] - first) <= SAME_SPEED * abs(first):
            number, first = number + 1, velocity[row]
        numbers[row] = number
    return numbers


def count_speeds(velocities: Iterable[Array]) -> int:
    """Number of different speeds among the points of some records."""
    return int(speed_numbers(np.concatenate([*velocities])).max()) + 1


def points_as_motion(body: str, file: str, velocity: Array, force: Array) -> Motion:
    """Points of speed and force (n,) as a motion without time."""
    nothing = np.zeros(len(velocity))
    points = spectrum(len(velocity), 1.0)
    return Motion(
        body=body,
        file=file,
        time=np.arange(len(velocity), dtype=float),
        position=nothing,
        velocity=velocity,
        acceleration=nothing,
        command=force,
        interaction=nothing,
        direction=np.sign(velocity).astype(np.int8),
        step=0.0,
        rows=slice(0, len(velocity)),
        spectrum=points,
        smoothing=np.ones(len(points.frequency)),
        bandwidth=np.inf,
    )


def noise_of_points(velocity: Array, force: Array) -> tuple[float, str]:
    """Noise (rms) of the force of a friction curve, and where it comes from, in words.

    Readings at one speed scatter by it. Where too few are repeated, each point is compared with the
    straight line between its two neighbours in the same direction; the median leaves out bends.
    """
    numbers = speed_numbers(velocity)
    counts = np.bincount(numbers)
    freedom = int(np.sum(counts - 1))
    if freedom >= FOLDS:
        means = np.bincount(numbers, force) / counts
        squares = float(np.sum((force - means[numbers]) ** 2))
        return float(np.sqrt(squares / freedom)), "scatter of readings at one speed"
    left = []
    for way in (-1.0, 1.0):
        here = np.flatnonzero(np.sign(velocity) == way)
        here = here[np.argsort(velocity[here], kind="stable")]
        v, f = velocity[here], force[here]
        if len(here) < SEVERAL:
            continue
        share = (v[1:-1] - v[:-2]) / np.maximum(v[2:] - v[:-2], 1e-300)
        between = (1.0 - share) * f[:-2] + share * f[2:]
        left.append((f[1:-1] - between) / np.sqrt(1.0 + share**2 + (1.0 - share) ** 2))
    if not left:
        return 0.0, "too few points to tell the noise of the force"
    size = float(np.median(np.abs(np.concatenate(left)))) / 0.6745  # of a normal distribution
    return size, "scatter of the force about its neighbours"
