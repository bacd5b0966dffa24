"""The range of the records of an experiment: travel, speed, command, sensors, sampling."""

from __future__ import annotations

import numpy as np

from ..base.errors import ExperimentError
from ..measurement.experiment import Experiment
from ..measurement.motion import RARE, TRAVEL
from ..measurement.prepare import prepare
from ..realise.reach import Reach


def reach_of(experiment: Experiment, place: str) -> Reach:
    """The recorded range of one body: travel, speed, command, sensors and sampling.

    raises ExperimentError: the body does not move in the records
    """
    motions = [s.motion for s in prepare(experiment).stretches if s.motion.body == place]
    position = np.concatenate([m.position for m in motions])
    speed = np.abs(np.concatenate([m.velocity for m in motions]))
    if not speed.any():
        raise ExperimentError(f"{experiment.folder.name}: {place}.position: it never moves")
    ways = np.concatenate([m.direction for m in motions])
    records, step = experiment.records, max(m.step for m in motions)
    acceleration = float(np.sqrt(np.mean(np.concatenate([m.acceleration**2 for m in motions]))))
    after_reversal = acceleration / (2 * motions[0].bandwidth) ** 2 / 2
    return Reach(
        low=float(position.min()),
        high=float(position.max()),
        peak_speed=float(speed.max()),
        rms_speed=float(np.sqrt(np.mean(speed**2))),
        command=float(max(np.abs(m.command).max() for m in motions)),
        duration=max(r.duration for r in records),
        sample_period=records[0].sample_time,
        step=step,
        unresolved=max(TRAVEL * step, after_reversal),
        both_ways=bool(min(np.sum(ways > 0), np.sum(ways < 0)) >= RARE * np.sum(ways != 0)),
        measures_force=f"{place}.interaction_force" in experiment.channels,
    )
