"""First values of a model from the record itself: inertia, friction and damping, by least squares.

    actuator force + interaction force = m a + c sgn(v) + b v + k

A force proportional to position (a spring, a pendulum at small angles) is added where it explains
most of the remaining force. The values are a start for a diagnosis, which estimates them again
together with the effects that are missing here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .encoder import SURELY, Array
from .filtering import spectrum
from .limits import HALF, ONE_WAY, SMALL
from .record import Record

#: Hz, part of the sample rate and bounds of the low-pass before the fit
_BAND = (0.02, 2.0, 40.0)
#: part of the largest speed below which the direction of motion counts as unknown
_SLOW = 0.02
#: s by which the low-pass spreads a force at rest over neighbouring rows (one period at 20 Hz):
#: these rows are left out. On a simulated joint with a Stribeck peak, this lowers the error of a
#: balance from 13 % to 0.5 %
_REACH = 0.05
#: part of its size (rms) by which a force must vary: below, a constant explains more of it than any
#: model of a real machine. Lower: a motor that spins up under one torque passes for one that tells
#: its inertia; higher: said of true small forces beside gravity
VARIES = 0.01
#: part of what one motion leaves of a force, below which another one, such as its size or the same
#: with another sign, surely explains more: 0.02 to 0.6 for sizes of simulated forces, 0.5 for the
#: supply current of a servo; 0.99 and more of forces with a load that keeps their sign
SURELY_LESS = 0.8


@dataclass(frozen=True)
class FirstGuess:
    """Estimates of inertia, friction level and damping in SI.

    explained: part of the force's variance (0 to 1)
    errors: standard errors of the three, each second of the record counted as one reading
    left: rms of the low-passed force that they do not explain, in the unit of the force
    """

    inertia: float
    level: float
    damping: float
    explained: float
    errors: tuple[float, float, float]
    left: float

    @property
    def start_of_inertia(self) -> float:
        """A positive inertia from which a search may begin; 0 where the estimate is none.

        Where friction makes nearly all of the force, an estimate may come out negative. If it is
        not surely so, the search begins at its standard error.
        """
        if self.inertia > 0.0:
            return self.inertia
        error = self.errors[0]
        return error if np.isfinite(error) and self.inertia + SURELY * error > 0.0 else 0.0


_NOTHING = FirstGuess(0.0, 0.0, 0.0, 0.0, (np.inf, np.inf, np.inf), 0.0)


def band_of_fit(sample_time: float) -> float:
    """Hz, up to which forces and motion are compared."""
    return min(max(_BAND[0] / sample_time, _BAND[1]), _BAND[2])


def motion_columns(position: Array, sample_time: float) -> tuple[Array, Array, Array]:
    """Low-passed velocity, acceleration and direction of motion, (n,) each, of a position (n,)."""
    s = spectrum(len(position), sample_time)
    low = s.lowpass(band_of_fit(sample_time))
    # relative to the first position: else rounding far from zero would look like motion
    moved = s.transform(position - position[:1]) * low
    velocity, acceleration = s.back(moved * s.derivative(1)), s.back(moved * s.derivative(2))
    speed = np.abs(velocity)
    direction = np.where(speed > _SLOW * speed.max(initial=0.0), np.sign(velocity), 0.0)
    return velocity, acceleration, s.multiply(direction, low)


def explain_force(force: Array, position: Array, sample_time: float) -> FirstGuess:
    """Inertia, friction level and damping that explain a force (n,) along a position (n,)."""
    return explain_forces([(force, position)], sample_time)


def explain_forces(pairs: Sequence[tuple[Array, Array]], sample_time: float) -> FirstGuess:
    """As `explain_force`, over several stretches; pairs: (force, position) of each stretch."""
    all_of_them = [stretch_of((force, place), place, sample_time) for force, place in pairs]
    stretches = [s for s in all_of_them if s is not None]
    if not stretches:
        return _NOTHING
    columns = np.concatenate([s[0] for s in stretches], axis=1)
    target, place = np.concatenate([s[1] for s in stretches], axis=1)
    if hardly_varies(target):
        return _NOTHING
    solution, errors, left = _fit_with_place(columns, place, target, sample_time)
    whole = float(np.mean((target - target.mean()) ** 2))
    explained = 1.0 - left**2 / whole if whole > 0 else 0.0
    m, c, b = solution[:3].tolist()
    of_each = float(errors[0]), float(errors[1]), float(errors[2])
    return FirstGuess(m, c, b, explained, of_each, left)


def is_turned(force: Array, position: Array, sample_time: float) -> bool:
    """Whether the sign of a force (n,) or of its position is inverted, so that friction drives.

    Friction and damping take energy out, and inertia is positive. The larger of these two parts of
    the force decides, if its sign is certain. In slow motions the force of inertia is too small to
    be distinguished from delays. A motion in one direction, with rests or without, does not
    distinguish friction from a constant force and one of the place, such as a weight that a motor
    lets down: there only inertia decides. A pendulum that swings below its natural frequency has a
    force like that of a negative mass; a force proportional to position is added where it explains
    most of the remaining force. In motions of one frequency it explains no more than the inertia
    does. So where friction brakes, a negative inertia counts only if its sign is certain beside
    such a force, too.
    """
    stretch = stretch_of((force, position), position, sample_time)
    if stretch is None or hardly_varies(force[inner_rows(sample_time)]):
        return False
    (acceleration, direction, velocity, _), (target, place) = stretch
    place = place - place.mean()
    force = target - target.mean()
    fits = []
    for braked in (direction, velocity):
        if np.std(braked) > ONE_WAY * np.sqrt(np.mean(braked**2)):
            # without the part that a constant force explains
            columns = np.stack([acceleration - acceleration.mean(), braked - braked.mean()])
            fits.append((columns, *_fit_with_place(columns, place, force, sample_time)))
    if not fits:
        return False
    columns, solution, errors, _ = min(fits, key=lambda fit: fit[3])
    values, is_sure = solution[:2], np.abs(solution[:2]) > SURELY * errors[:2]
    if is_sure.all() and values[0] < 0.0 < values[1]:  # the sign may be open beside a spring
        factors, least, _ = least_squares(np.vstack([columns, place]), force, sample_time)
        is_sure[0] = np.abs(factors[0]) > SURELY * least[0]
    is_sure[1] &= not goes_one_way(direction)
    sizes = np.where(is_sure, np.abs(values) * np.std(columns, axis=1), 0.0)
    return bool(is_sure.any() and values[np.argmax(sizes)] < 0.0)


def goes_one_way(direction: Array) -> bool:
    """Whether a body rests or moves in one direction, to the part that a low-pass leaves."""
    ways = [float(np.mean(way)) for way in rows_each_way(direction)]
    return min(ways) < ONE_WAY * max(ways)


def rows_each_way(direction: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The rows (n,) that surely move forward, and those that move backward.

    direction: low-passed, so that it rings about zero where a body is at rest before it moves
    """
    return direction > HALF, direction < -HALF


def is_size(force: Array, position: Array, sample_time: float) -> bool:
    """Whether a force (n,) that is never negative is the size of a force that takes both signs.

    Such as the supply current of a servo, which rises in motion, whatever the direction. Then the
    force of the motion and of the place explains surely more where each row has the sign of the
    velocity.
    """
    stretch = stretch_of((force, position), position, sample_time)
    if stretch is None or np.min(force) < 0.0 or hardly_varies(force):
        return False
    motion, (target, place) = stretch
    each = [float(np.mean(way)) for way in rows_each_way(motion[1])]
    if min(each) < SMALL * sum(each):
        return False
    place = (place - place.mean()) / max(float(np.ptp(place)), np.finfo(float).tiny)
    columns, sign = np.vstack([motion, place, place**2]), np.sign(motion[1])
    _, _, signed = least_squares(columns, target, sample_time)
    rows = np.vstack([sign * columns, np.ones_like(sign)])
    _, _, of_size = least_squares(rows, target, sample_time)
    return of_size < SURELY_LESS * signed


def balance_factor(
    force: Array, other: Array, position: Array, sample_time: float
) -> tuple[float, float]:
    """The factor of a second force that balances a force (n,) along the motion, with its error.

        force + factor other = m a + c sgn(v) + b v + k

    Rows at and near rest are left out: friction takes any force there, up to its level. Where one
    force follows the other as well without the motion, it is computed from the other.

    returns: factor and standard error; (0, inf) where less than a second is in motion, or the
        motion tells no factor
    """
    stretch = stretch_of((force, other, np.gradient(other)), position, sample_time)
    if stretch is None:
        return 0.0, np.inf
    columns, (target, beside, rate) = stretch
    speed = np.abs(columns[2])
    window = max(1, round(_REACH / sample_time))
    slow = np.convolve(speed <= SMALL * speed.max(), np.ones(window), "same")
    rows = slow == 0.0
    if np.count_nonzero(rows) * sample_time < 1.0:
        return 0.0, np.inf
    columns = np.vstack([columns, -beside])[:, rows]
    factors, errors, left = least_squares(columns, target[rows], sample_time)
    computed = np.vstack([columns[-2:], rate[rows]])
    _, _, without_motion = least_squares(computed, target[rows], sample_time)
    if not left < SURELY_LESS * without_motion:
        return 0.0, np.inf
    return float(factors[-1]), float(errors[-1])


def inner_rows(sample_time: float) -> slice:
    """The rows without the ends, which the low-pass spoils."""
    trim = max(1, round(0.25 / sample_time))
    return slice(trim, -trim)


def hardly_varies(force: Array) -> bool:
    """Whether a force (n,) is constant but for `VARIES` of it: any motion explains such a force."""
    with np.errstate(over="ignore", invalid="ignore"):  # values beyond 1e150
        return bool(np.std(force) <= VARIES * np.sqrt(np.mean(force**2)))


def stretch_of(
    forces: Sequence[Array], position: Array, sample_time: float
) -> tuple[Array, Array] | None:
    """Columns of the motion (4, rows) and low-passed forces, without the ends.

    None: too short, or values too large to be squared
    """
    inner = inner_rows(sample_time)
    if len(position) < 4 * inner.start:
        return None
    v, a, direction = motion_columns(position, sample_time)
    s = spectrum(len(position), sample_time)
    low = s.lowpass(band_of_fit(sample_time))
    columns = np.stack([a, direction, v, np.ones(len(v))])[:, inner]
    smooth = np.stack([s.multiply(force, low)[inner] for force in forces])
    with np.errstate(over="ignore", invalid="ignore"):  # values beyond 1e150
        finite = np.isfinite(np.sum(columns**2)) and np.isfinite(np.sum(smooth**2))
    return (columns, smooth) if finite else None


def _fit_with_place(
    columns: Array, place: Array, target: Array, sample_time: float
) -> tuple[Array, Array, float]:
    """`least_squares`, with a force proportional to position if this removes most of the rest."""
    fit = least_squares(columns, target, sample_time)
    held = least_squares(np.vstack([columns, place]), target, sample_time)
    return held if held[2] ** 2 < HALF * fit[2] ** 2 else fit


def least_squares(columns: Array, target: Array, sample_time: float) -> tuple[Array, Array, float]:
    """Factors of columns (k, rows), their errors, rms of the rest."""
    scale = np.sqrt(np.mean(columns**2, axis=1))
    scale[scale == 0] = 1.0
    normal = columns / scale[:, None]
    # a few columns with many rows: the normal equations, once refined, take a third of the time
    inverse = np.linalg.pinv(normal @ normal.T / len(target), rcond=1e-12, hermitian=True)
    solution = inverse @ (normal @ target / len(target))
    solution += inverse @ (normal @ (target - solution @ normal) / len(target))
    left = float(np.mean((target - solution @ normal) ** 2))
    seconds = max(len(target) * sample_time, 1.0)
    covariance = inverse * left / seconds
    return solution / scale, np.sqrt(np.abs(np.diag(covariance))) / scale, left**0.5


def guess_from(records: Sequence[Record], body: str) -> FirstGuess:
    """First values of the model of one body from its records."""
    pairs = []
    for record in records:
        force = record.signals[f"{body}.actuator_force"]
        other = record.signals.get(f"{body}.interaction_force")
        total = force if other is None else force + other
        pairs += [(total[s], record.signals[f"{body}.position"][s]) for s in record.segments]
    return explain_forces(pairs, records[0].sample_time)


def is_first_guess(records: Sequence[Record], body: str, inertia: float) -> bool:
    """Whether an inertia (SI) of a model is the start that these records themselves give."""
    return float(f"{guess_from(records, body).start_of_inertia:.3g}") == inertia
