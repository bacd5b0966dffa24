"""External tone: a force at one frequency that does not depend on the motion, such as hum.

A tone moves the machine a little, at its frequency. A model with a lightly damped tip that
resonates there moves in the same way without any force, so effects that are absent can imitate the
tone. So an effect counts only if it leaves surely less than a single tone does. This test is made
only where the motion, its direction and its speed have hardly any power at the frequency of the
tone.
Hum of the mains moves the machine itself, so the motion contains the tone. At the frequency of the
mains the tone is compared with effects unless a large part of the motion is at this frequency.

A body that is stuck does not show the tone, because friction balances it. So the tone is subtracted
from the residual or applied as a force on the body, whichever leaves less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft
from scipy.optimize import minimize_scalar

from ..base.units import MAINS
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from ..model import Model
from .criteria import CRITERIA
from .evidence import check_squares, gain_score, is_noise
from .fit import Fit, estimate
from .noise_floor import NoiseFloor
from .residual import residuals
from .search_plan import PLAN


@dataclass(frozen=True)
class Tone:
    """Residual of the check records after the best tone on one of the bodies.

    residual: as `Fit.check_residual`; None: no tone, or the motion itself contains it
    """

    residual: Array | None = None

    @property
    def squares(self) -> float:
        """Sum of squares of the residual (as `check_squares`); inf where there is no tone."""
        return float("inf") if self.residual is None else float(self.residual @ self.residual)

    def is_beaten_by(self, fit: Fit) -> bool:
        """Whether a fit leaves less than the tone by more than chance."""
        if self.residual is None:
            return True
        return (
            gain_score(self.residual, fit.check_residual, fit.check_blocks)
            > CRITERIA.indistinguishable
        )

    def holds_all_but_noise(self, fit: Fit, floor: NoiseFloor) -> bool:
        """Whether the tone explains all of a fit's error except noise."""
        squares = check_squares(fit)
        left = fit.check_error * float(np.sqrt(self.squares / squares)) if squares > 0.0 else 0.0
        return is_noise(left, floor)


def best_tone(fitted: Fit, prepared: Prepared) -> Tone:
    """The tone that removes most of the residual of a model.

    The frequency is estimated on the fit records, amplitude and phase on each check stretch.
    """
    fit, check = prepared.of("fit"), prepared.of("check")
    if not check or prepared.is_curve:
        return Tone()
    before = _parts(fitted.fit_residual, fit)
    after = _parts(fitted.check_residual, check)
    whole = check_squares(fitted)
    least = Tone()
    for body in {s.motion.body for s in fit}:
        fit_parts = [(s, r) for s, r in zip(fit, before, strict=True) if s.motion.body == body]
        check_parts = [(s, r) for s, r in zip(check, after, strict=True) if s.motion.body == body]
        frequency = _frequency(fit_parts)
        most = CRITERIA.hum_in_motion if is_of_mains(frequency) else CRITERIA.tone_in_motion
        if frequency > 0 and all(_share(s, frequency) < most for s, _ in fit_parts + check_parts):
            left = [
                _remove_tone(s, r, frequency) if s.motion.body == body else r
                for s, r in zip(check, after, strict=True)
            ]
            tones = [least, Tone(np.concatenate(left))]
            if tones[-1].squares < (1 - CRITERIA.relative_improvement) * whole:
                tones.append(Tone(_fit_beside_tone(fitted, prepared, body, frequency)))
            least = min(tones, key=lambda tone: tone.squares)
    return least


def is_of_mains(frequency: float) -> bool:
    """Whether a frequency (Hz) is that of the mains or its double, as of rectifiers and magnets."""
    tones = [n * mains for mains in MAINS for n in (1, 2)]
    return any(abs(frequency - tone) <= CRITERIA.mains_within * tone for tone in tones)


def _fit_beside_tone(fit: Fit, prepared: Prepared, body: str, frequency: float) -> Array:
    """Check residual of the model, estimated again with the tone as a force on the body."""
    stretches = prepared.stretches
    for _ in range(PLAN.tone_estimates):
        stretches = tuple(
            _drive_by_tone(fit.model, s, frequency) if s.motion.body == body else s
            for s in stretches
        )
        fit = estimate(fit.model, replace(prepared, stretches=stretches))
    return fit.check_residual


def _drive_by_tone(model: Model, stretch: Stretch, frequency: float) -> Stretch:
    """The stretch with the tone, of the best amplitude and phase, among the acting forces.

    A stuck body hides a part of the tone, so amplitude and phase are estimated several times. The
    tone is low-passed before it is compared with the residual.
    """
    waves = _waves(stretch, frequency)
    shown = stretch.motion.lowpassed(waves.T).T[stretch.keep]
    for _ in range(PLAN.tone_turns):
        ((residual, _),) = residuals(model, [stretch])
        if len(residual) <= shown.shape[1]:
            break
        motion = stretch.motion
        size, *_ = np.linalg.lstsq(shown, residual, rcond=None)
        force = motion.interaction - waves @ size
        stretch = replace(stretch, motion=replace(motion, interaction=force))
    return stretch


def _parts(residual: Array, stretches: Sequence[Stretch]) -> list[Array]:
    return np.split(residual, np.cumsum([len(s.keep) for s in stretches])[:-1])


def _waves(stretch: Stretch, frequency: float) -> Array:
    """Sine and cosine at every sample, (n, 2)."""
    angle = 2 * np.pi * frequency * (stretch.motion.time - stretch.motion.time[0])
    return np.column_stack([np.sin(angle), np.cos(angle)])


def _frequency(parts: Sequence[tuple[Stretch, Array]]) -> float:
    """Frequency (Hz) of the tone that removes most of these residuals; 0: there are no rows."""
    parts = [(s, r) for s, r in parts if len(r) > 2 and r.any()]
    if not parts:
        return 0.0
    interval = parts[0][0].motion.sample_time
    rows = max(len(s.motion.time) for s, _ in parts)
    length = fft.next_fast_len(2 * rows, real=True)
    grid = fft.rfftfreq(length, interval)
    power = np.zeros(len(grid))
    for stretch, residual in parts:
        line = np.zeros(len(stretch.motion.time))
        line[stretch.keep] = residual
        power += np.abs(fft.rfft(line, length)) ** 2
    thinned = min(float(np.median(np.diff(s.keep))) for s, _ in parts)
    power[(grid < 2 / (rows * interval)) | (2 * grid * thinned * interval > 1)] = 0.0
    step, peak = float(grid[1]), float(grid[int(np.argmax(power))])

    def lost(frequency: float) -> float:
        return -sum(_tone_squares(s, r, frequency) for s, r in parts)

    bounds = (peak - step, peak + step)
    return float(minimize_scalar(lost, bounds=bounds, method="bounded").x)


def _tone_squares(stretch: Stretch, residual: Array, frequency: float) -> float:
    """Decrease of the squares of a residual by the best tone of this frequency (Hz)."""
    left = _remove_tone(stretch, residual, frequency)
    return float(residual @ residual - left @ left)


def _remove_tone(stretch: Stretch, residual: Array, frequency: float) -> Array:
    """A residual without the tone of this frequency (Hz), of the best amplitude and phase."""
    waves = _waves(stretch, frequency)[stretch.keep]
    if len(residual) <= waves.shape[1]:
        return residual
    size, *_ = np.linalg.lstsq(waves, residual, rcond=None)
    return np.asarray(residual - waves @ size)


def _share(stretch: Stretch, frequency: float) -> float:
    """Largest share of the power near a frequency (Hz), of three signals of the motion.

    The signals are the velocity, its sign and its magnitude: friction of a periodic motion has odd
    and even harmonics that the velocity lacks. By their window a tone is four lines wide.
    """
    motion = stretch.motion
    n = len(motion.velocity)
    line = 1.0 / (n * motion.sample_time)
    near = np.abs(np.fft.rfftfreq(n, motion.sample_time) - frequency) <= 2 * line
    size = np.abs(motion.velocity)
    parts = []
    for signal in (motion.velocity, np.sign(motion.velocity), size - size.mean()):
        power = np.abs(np.fft.rfft(signal * np.hanning(n))) ** 2
        whole = float(power.sum())
        parts.append(float(power[near].sum()) / whole if whole > 0 else 0.0)
    return max(parts)
