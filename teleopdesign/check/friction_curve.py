"""What the points of a friction curve can tell, before anything is fitted."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Concern, Finding
from ..base.units import unit_of
from ..measurement.experiment import Experiment
from ..measurement.friction_curve import (
    CHANNELS,
    CURVE,
    count_speeds,
    noise_of_points,
    speed_numbers,
)
from ._recording import CheckedRecording, RecordingCheck
from .hidden_motion import FOR_EACH

#: points in each direction below which its curve is hardly known: as many as a level, a damping and
#: the three numbers of a Stribeck curve need
FEWEST = 6
#: largest over smallest speed from which the fall of friction near rest may show: one decade
WIDE = 10.0


def find_in_points(recording: CheckedRecording) -> Iterator[Finding]:
    """Signs, directions, range of the speeds and scatter of the force of a friction curve."""
    experiment = recording.experiment
    for step in experiment.reading:
        yield Finding("reading", "note", f"{step.observed}: {step.rule}.", where=step.file)
    velocity, force = (
        np.concatenate([r.signals[f"device.{name}"] for r in experiment.records])
        for name in CHANNELS
    )
    if velocity @ force < 0.0:
        yield Finding(
            "signs",
            "warning",
            "the force is against the motion, so that it would hold no speed: state sign = -1 at "
            "channels.actuator_force or at channels.velocity.",
            {"power": float(np.mean(velocity * force))},
            stops=True,
        )
    yield from _about_count(recording, velocity)
    yield from _about_directions(velocity)
    yield from _about_scatter(experiment, velocity, force)


def _about_count(recording: CheckedRecording, velocity: np.ndarray) -> Iterator[Finding]:
    if recording.model is None:
        return
    values = recording.model.parameters.items()
    free = sum(not (n.endswith(".inertia") or v.fixed) for n, v in values)
    speeds, least = count_speeds([velocity]), int(FOR_EACH * (free + 1))
    if speeds < least:
        sentence = (
            f"{speeds} different speeds tell no effect beside the {free} parameters of the model, "
            f"which follow them whatever they are: measure at {least} speeds or more."
        )
        yield Finding("points", "warning", sentence, {"speeds": float(speeds)}, stops=True)


def _about_directions(velocity: np.ndarray) -> Iterator[Finding]:
    counts = {way: int(np.sum(np.sign(velocity) == way)) for way in (1.0, -1.0)}
    numbers = {"forward": float(counts[1.0]), "backward": float(counts[-1.0])}
    words = f"{counts[1.0]} points forward, {counts[-1.0]} backward"
    if not all(counts.values()):
        words += ": one direction tells no asymmetry, and no bias from Coulomb friction"
    few = min(counts.values()) < FEWEST
    yield Finding("directions", "warning" if few else "fine", f"{words}.", numbers)
    speed = np.abs(velocity)
    ratio = float(speed.max() / speed.min())
    words = f"the largest speed is {ratio:.3g} times the smallest"
    if ratio < WIDE:
        words += ": friction that falls near rest hardly shows; add slower runs"
    concern: Concern = "note" if ratio < WIDE else "fine"
    yield Finding("range of speeds", concern, f"{words}.", {"ratio": ratio})


def _about_scatter(
    experiment: Experiment, velocity: np.ndarray, force: np.ndarray
) -> Iterator[Finding]:
    noise, source = noise_of_points(velocity, force)
    repeated = len(velocity) - int(speed_numbers(velocity).max()) - 1
    unit = unit_of("force", experiment.axis("device"))
    yield Finding(
        "scatter",
        "fine" if repeated else "note",
        f"noise of the force {noise:.3g} {unit} ({source}); {repeated} points repeat a speed.",
        {"noise": noise, "repeated": float(repeated)},
    )


CHECK = RecordingCheck(order=300, find=find_in_points, may_stop=True, kind=CURVE)
