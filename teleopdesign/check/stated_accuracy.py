"""Steps and noise of a channel as stated, compared with those of its readings.

The noise floor of a diagnosis depends on these values. The scatter of readings is their content
near the Nyquist frequency (`reading_noise`). Its median over pieces of the record ignores motion
with such content.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Concern, Finding
from ..measurement.encoder import is_on_grid, reading_noise, reading_step
from ..measurement.filtering import Array
from ..measurement.limits import SMALL
from ..measurement.prepare import FEWEST
from ._recording import CheckedRecording, RecordingCheck, Signal

#: multiples of the stated step that are tested as the true one
MULTIPLES = range(2, 65)
#: ratio of measured to stated noise that gives a warning: a quarter of a second of a record shows
#: the noise within 10 %, and a noise floor that is wrong by this factor changes a verdict
FACTOR = 1.6


def find_wrong_accuracy(recording: CheckedRecording) -> Iterator[Finding]:
    """Channels whose readings have other steps, or other noise, than stated."""
    for signal in recording.varying:
        yield from check_steps(signal)
        yield from check_noise(signal)


CHECK = RecordingCheck(order=70, find=find_wrong_accuracy, in_order="steps and noise as stated")


def check_steps(signal: Signal) -> Iterator[Finding]:
    """Compare the stated resolution of a channel with its readings."""
    stated, read_step = signal.channel.resolution, signal.step
    if stated is None or not read_step or (step := true_step(signal.values, stated)) == stated:
        return
    is_between = signal.quantity == "position" and any(
        done.interpolates for done in signal.record.reading
    )
    if step is None and read_step < stated and is_between:
        return  # the readings have steps; the interpolated samples have none
    concern: Concern = "warning"
    text = f" is not read in steps of the stated {stated:.4g} {signal.unit}"
    if step is not None:
        text = (
            f" moves in steps of {step:.4g} {signal.unit}, {step / stated:.0f} times the stated "
            f"{stated:.4g}: the encoder is coarser than stated; write resolution = "
            f"{step / abs(signal.channel.conversion.factor):.4g} at channels.{signal.name}."
        )
    elif read_step < stated:
        concern, text = "note", f"{text}, but in finer ones."
    else:
        text += f", but of {read_step:.4g}."
    numbers = {"stated": stated, "seen": read_step if step is None else step}
    yield signal.finding("encoder steps", concern, text, numbers)


def check_noise(signal: Signal) -> Iterator[Finding]:
    """Compare the stated noise of a channel with its readings; no finding where none is stated."""
    stated = signal.channel.noise
    if stated is None:
        return
    # rounding has an rms of at most 0.29 steps
    expected = float(np.hypot(stated, 0.29 * (signal.channel.resolution or 0.0)))
    scatter = measured_noise(signal)
    ratio = scatter / expected
    if 1 / FACTOR < ratio < FACTOR:
        return
    effect = "hides effects" if ratio < 1 else "makes noise look like an effect"
    words = (
        f" scatters by {scatter:.3g} {signal.unit} rms, {stated:.3g} is stated: a noise floor that "
        f"is wrong {effect}."
    )
    numbers = {"stated": stated, "seen": scatter, "ratio": ratio}
    yield signal.finding("noise", "warning", words, numbers)


def true_step(x: Array, stated: float) -> float | None:
    """The step of the readings: the stated one or a multiple of it; None: neither.

    Each place counts once: the rows of a body at rest lie on any grid.
    """
    if not is_on_grid(x, stated):
        return None
    reached, ratio = float(np.ptp(x)), round(reading_step(x) / stated)
    multiples = [k for k in (*MULTIPLES, ratio) if k > 1 and k * stated < SMALL * reached]
    places = np.unique(x)
    on = [k for k in multiples if is_on_grid(places, k * stated)]
    return stated * max(on, default=1)


def measured_noise(signal: Signal) -> float:
    """Rms noise of the readings in the longest stretch, SI."""
    longest = max((x for _, x in signal.stretches), key=len)
    return reading_noise(longest) if len(longest) >= FEWEST else 0.0
