"""Up to which frequency a record still tells an acceleration, and the position a motion."""

from __future__ import annotations

import numpy as np

from .experiment import Experiment
from .motion import motions

#: share of the rows in motion, over that two octaves lower, below which a bandwidth hides the
#: motion. A half: of what could be tested, most is lost
LEAST_SHARE = 0.5
#: Hz: no lower bandwidth is chosen or proposed
LOWEST = 1.0


def default_bandwidth(experiment: Experiment) -> float:
    """Default bandwidth (Hz): how far up positions still show acceleration, and tell a motion.

    The highest frequency below a tenth of the sample rate at which the acceleration's spectrum
    stands 10 dB above what white reading noise would leave there. Steps of an encoder are no white
    noise: while they hide most of the motion, the bandwidth is halved.
    """
    chosen = _highest_acceleration(experiment)
    while any(hides_motion(experiment, body, chosen) for body in experiment.bodies):
        chosen /= 2.0
    return chosen


def share_in_motion(experiment: Experiment, body: str, bandwidth: float) -> float:
    """Share of the fitted rows in which the position tells a direction of motion, at this Hz.

    The wider the band, the more of the readings' error is left in the velocity. Where a velocity
    cannot be distinguished from rest, friction takes up whatever force acts: no model fails there,
    and none is tested.
    """
    resolution = experiment.channels[f"{body}.position"].resolution
    directions = [
        motion.direction != 0
        for record in experiment.fit_records
        if bandwidth <= 0.4 / record.sample_time
        for motion in motions(record, body, bandwidth=bandwidth, resolution=resolution)
    ]
    return float(np.mean(np.concatenate(directions))) if directions else 0.0


def hides_motion(experiment: Experiment, body: str, bandwidth: float) -> bool:
    """Whether far fewer rows tell a motion at this bandwidth (Hz) than two octaves lower."""
    lower = bandwidth / 4.0
    if lower < LOWEST:
        return False
    could = share_in_motion(experiment, body, lower)
    return share_in_motion(experiment, body, bandwidth) < LEAST_SHARE * could


def _highest_acceleration(experiment: Experiment) -> float:
    limits = []
    for record in experiment.records:
        rate = 1.0 / record.sample_time
        for body in experiment.bodies:
            x = np.concatenate([record.signals[f"{body}.position"][s] for s in record.segments])
            n = min(len(x), 4096)
            windows = np.lib.stride_tricks.sliding_window_view(x, n)[:: max(1, n // 2)]
            window = np.hanning(n)
            density = np.mean(
                np.abs(np.fft.rfft((windows - windows.mean(1)[:, None]) * window)) ** 2, 0
            )
            frequency = np.fft.rfftfreq(n, record.sample_time)
            noise = np.median(density[frequency > 0.3 * rate])
            above_noise = frequency[(density > 10 * noise) & (frequency <= 0.1 * rate)]
            limits.append(above_noise.max() if above_noise.size else 0.02 * rate)
    return float(max(min(limits), 1.0))
