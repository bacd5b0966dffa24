"""Noise: the stated noise of a channel, compared with the scatter of its readings.

The scatter is the content near the Nyquist frequency (`reading_noise`). The median over pieces of
the record ignores motion with such content. The noise floor of a diagnosis depends on these values.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...base.finding import Finding
from ..encoder import reading_noise
from .signal import Signal

#: ratio of measured to stated noise that gives a warning: a quarter of a second of a record shows
#: the noise within 10 %, and a noise floor that is wrong by this factor changes a verdict
FACTOR = 1.6
#: samples of a piece
PIECE = 500


def measured_noise(signal: Signal) -> float:
    """Rms noise of the readings, SI."""
    pieces: list[float] = []
    for _, x in signal.stretches:
        starts = range(0, max(len(x) - PIECE, 0) + 1, max(PIECE, len(x) // 40))
        pieces += [reading_noise(x[k : k + PIECE]) for k in starts if len(x) - k >= 16]
    return float(np.median(pieces)) if pieces else 0.0


def check_noise(signal: Signal, others: Sequence[Signal]) -> list[Finding]:
    """Compare the stated noise of a channel with its readings; no finding where none is stated.

    others: channels of the same record; one of the same unit may be the noisy one instead
    """
    stated, scatter = signal.channel.noise, measured_noise(signal)
    # rounding has an rms of at most 0.29 steps
    rounding = 0.29 * (signal.channel.resolution or signal.step)
    numbers = {"stated": stated or float("nan"), "seen": scatter}
    if stated is None:
        return []
    expected = float(np.hypot(stated, rounding if signal.channel.resolution else 0.0))
    ratio = scatter / expected
    if 1 / FACTOR < ratio < FACTOR:
        return []
    alike = [o for o in others if o.channel.noise is None and o.unit == signal.unit]
    noisy = [o.name for o in alike if 1 / FACTOR < measured_noise(o) / expected < FACTOR]
    hint = f" {noisy[0]} has it: are the two columns swapped?" if noisy and ratio < 1 else ""
    effect = "hides effects" if ratio < 1 else "makes noise look like an effect"
    return [
        Finding(
            "noise",
            "warning",
            f"{signal.name} scatters by {scatter:.3g} {signal.unit} rms, {stated:.3g} is stated: a "
            f"noise floor that is wrong {effect}.{hint}",
            {**numbers, "ratio": ratio},
            signal.record.file,
        )
    ]
