"""How far up in frequency a record still tells an acceleration."""

from __future__ import annotations

import numpy as np

from ..measurement.experiment import Experiment


def default_bandwidth(experiment: Experiment) -> float:
    """Default bandwidth (Hz): the highest frequency at which positions still show acceleration.

    The highest frequency below a tenth of the sample rate at which the acceleration's spectrum
    stands 10 dB above what white reading noise would leave there.
    """
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
