"""Model against measurement: the force residual, and the force error as one figure.

    error = rms(LP residual) / rms(LP (actuator force + interaction force)),  record less its ends

LP is the zero-phase low-pass at the comparison's bandwidth; sums of squares run over all bodies,
records and segments of one use ("fit" or "check").

What makes the recorded force unpredictable has not explained it: with less force acting there is
less to explain. So the same figure is taken of the residual as an error of the recorded command
(`at_command`), and what counts must be smaller in both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..blocks import Body
from ..by_value import ByValue
from ..effects import SIGNALS
from ..errors import ExperimentError
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import Motion, motions
from ..model import Model
from ..realise.along_motion import residual_along
from ..realise.seen_at_command import SeenAtCommand, blind_share, is_between, seen_at_command
from ..realise.traced import Probe
from .own import Own, own_of

#: seconds at each end of a stretch where the low-pass has not settled
TRIM = 0.25
#: samples kept per second and hertz of bandwidth after the low-pass (2 would be Nyquist's)
OVERSAMPLING = 5.0
#: blocks of the fit records that are held out in turn where there is no check record
FOLDS = 4


@dataclass(frozen=True, eq=False)
class Stretch(ByValue):
    """One body along one segment with its use, and the rows that count.

    keep: the rows that count, thinned to what the low-pass leaves
    weight: rows that each of them stands for
    measured: sum of squares of the low-passed measured force over the rows that count
    own: what the record has of its own, to be found on it
    """

    motion: Motion
    use: str
    keep: NDArray[np.intp]
    weight: float
    measured: float
    own: frozenset[str] = frozenset()

    @property
    def own_zero(self) -> bool:
        """Whether its position cannot be compared with that of other records."""
        return "position_zero" in self.own


@dataclass(frozen=True, eq=False)
class Prepared(ByValue):
    """An experiment made ready for comparison at one bandwidth (Hz)."""

    experiment: Experiment
    bandwidth: float
    stretches: tuple[Stretch, ...]

    def of(self, use: str) -> tuple[Stretch, ...]:
        """The stretches of one use."""
        return tuple(s for s in self.stretches if s.use == use)


def default_bandwidth(experiment: Experiment) -> float:
    """Bandwidth (Hz) where none is given: as far as the position still tells an acceleration.

    The highest frequency below a tenth of the sample rate at which the acceleration's spectrum
    stands 10 dB above what white reading noise would leave there.
    """
    found = []
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
            told = frequency[(density > 10 * noise) & (frequency <= 0.1 * rate)]
            found.append(told.max() if told.size else 0.02 * rate)
    return float(max(min(found), 1.0))


def prepare(experiment: Experiment, *, bandwidth: float | None = None) -> Prepared:
    """Smooth, differentiate and cut the records of an experiment for comparison.

    bandwidth: Hz; default: the experiment's, or chosen from the record
    raises ExperimentError: bandwidth too high for the sample rate, or no stretch long enough
    """
    chosen = bandwidth or experiment.bandwidth or default_bandwidth(experiment)
    stretches = []
    for record in experiment.records:
        if chosen > 0.4 / record.sample_time:
            raise ExperimentError(
                f"{experiment.folder.name}/experiment.toml: comparison.bandwidth: {chosen:g} Hz is "
                f"too high for {record.file} at {1 / record.sample_time:g} Hz, expected below "
                f"{0.4 / record.sample_time:g} Hz"
            )
        for body in experiment.bodies:
            channel = experiment.channels[f"{body}.position"]
            for motion in motions(record, body, bandwidth=chosen, resolution=channel.resolution):
                stretches.append(stretch_of(motion, record.use, chosen, record.own))
    if not any(s.use == "fit" for s in stretches):
        raise ExperimentError(f"{experiment.folder.name}: fit records: no stretch of 0.6 s or more")
    return Prepared(experiment, chosen, tuple(stretches))


def stretch_of(motion: Motion, use: str, bandwidth: float, own: frozenset[str]) -> Stretch:
    """A motion with the rows of it that count at this bandwidth (Hz).

    own: what its record has of its own
    """
    n, rate = len(motion.time), 1.0 / motion.sample_time
    trim = min(int(TRIM * rate), n // 3)
    stride = max(1, int(rate / (OVERSAMPLING * bandwidth)))
    keep = np.arange(trim, n - trim, stride)
    return Stretch(motion, use, keep, float(stride), _squares(motion, keep, float(stride)), own)


def residuals(
    model: Model, stretches: Sequence[Stretch], wrt: Sequence[str | Probe] = ()
) -> list[tuple[Array, Array]]:
    """Low-passed residual force and its tangents (p, rows) on the rows that count, per stretch.

    wrt: full parameter names ("device.coulomb.level"), or probes
    """
    return [(r, d) for r, d, _, _ in _with_acting(model, stretches, wrt)]


def referred(
    model: Model, stretches: Sequence[Stretch], wrt: Sequence[str | Probe] = ()
) -> list[tuple[Array, Array]]:
    """Residuals relative to the force that acts by the model, at the scale of the measured force.

    A model whose actuator passes next to nothing leaves next to no residual force, nor does one
    whose friction takes up whatever acts; relative to what it lets act on each body, nothing is
    gained. Equal to `residuals` where nothing stands between command and force.
    """
    parts = _with_acting(model, stretches, wrt)
    found = [(r, d) for r, d, _, _ in parts]
    for place, body in model.bodies.items():
        mine = [i for i, s in enumerate(stretches) if s.motion.body == place]
        if not mine or not _takes_from_what_acts(body):
            continue
        whole = sum(stretches[i].measured for i in mine)
        acting = sum(stretches[i].weight * float(parts[i][2] @ parts[i][2]) for i in mine)
        acting = max(acting, 1e-12 * whole)
        slope = sum(
            (stretches[i].weight * (parts[i][3] @ parts[i][2]) for i in mine), np.zeros(len(wrt))
        )
        factor = float(np.sqrt(whole / acting))
        for i in mine:
            r, d = found[i]
            found[i] = factor * r, factor * (d - np.outer(slope / acting, r))
    return found


def _takes_from_what_acts(body: Body) -> bool:
    """Whether an actuator's stage, or friction under load, stands before what moves the body."""
    stages = any(e.role == "actuation" for e in body.effects)
    return stages or body.level().has(SIGNALS["acting_force"])


def _with_acting(
    model: Model, stretches: Sequence[Stretch], wrt: Sequence[str | Probe]
) -> list[tuple[Array, Array, Array, Array]]:
    """Residual and acting plus interaction force, low-passed, on the rows that count; tangents."""
    found = []
    owned = own_groups(model, stretches)
    for stretch, (body, there) in zip(stretches, _along(model, stretches, owned), strict=True):
        motion, rows = stretch.motion, stretch.keep
        located = [_located(model, name) for name in wrt]
        mine = [i for i, (place, _) in enumerate(located) if place == motion.body]
        own = [located[i][1] for i in mine]
        along = residual_along(body, there, own)
        signals = []
        for traced, offset in ((along.residual, 0.0), (along.moving, motion.interaction)):
            value = motion.lowpassed(traced.value + offset)[rows]
            tangent = np.zeros((len(wrt), len(rows)))
            moving = traced.tangent.any(axis=1)
            if moving.any():
                tangent[np.array(mine)[moving]] = motion.lowpassed(traced.tangent[moving])[:, rows]
            signals += [value, tangent]
        found.append((signals[0], signals[1], signals[2], signals[3]))
    for group, own_values in owned:
        cleared = own_values.cleared([found[i][:2] for i in group])
        for i, (residual, tangent) in zip(group, cleared, strict=True):
            found[i] = (residual, tangent, *found[i][2:])
    return found


@dataclass(frozen=True)
class AtCommand:
    """What a model leaves on some stretches, as an error of the recorded forces.

    residual: per stretch, low-passed, on the rows that count; in blind rows as it acts
    told: per stretch, the rows that are not blind
    error: relative, over the rows that are not blind, above the line and below; NaN: there are none
    blind: share of blind samples among those where the body slides
    weak: an actuator can give, at no command, what its model needs to slide
    """

    residual: tuple[Array, ...]
    told: tuple[NDArray[np.bool_], ...]
    error: float
    blind: float
    weak: bool


def at_command(model: Model, stretches: Sequence[Stretch]) -> AtCommand:
    """What the model leaves, as an error of the recorded forces: see `seen_at_command`.

    Equal to `residuals` where nothing stands between the recorded forces and the body. What a model
    keeps of the interaction force from a body is made up for by the scale of the rest.
    """
    owned = own_groups(model, stretches)
    along = _along(model, stretches, owned)
    seen = [_seen(body, motion) for body, motion in along]
    values = [
        m.lowpassed(one.residual)[s.keep]
        for s, (_, m), one in zip(stretches, along, seen, strict=True)
    ]
    nothing = np.zeros((0, 0))
    for group, own_values in owned:
        bare = [(values[i], nothing.reshape(0, len(values[i]))) for i in group]
        for i, (residual, _) in zip(group, own_values.cleared(bare), strict=True):
            values[i] = residual
    values = _made_up_for(stretches, values, seen)
    sighted = [~one.blind[s.keep] for s, one in zip(stretches, seen, strict=True)]
    left = whole = 0.0
    for s, r, told in zip(stretches, values, sighted, strict=True):
        left += s.weight * float(np.sum(r[told] ** 2))
        whole += s.measured if told.all() else s.weight * float(np.sum(_measured(s)[told] ** 2))
    return AtCommand(
        tuple(values),
        tuple(sighted),
        float(np.sqrt(left / whole)) if whole > 0.0 else float("nan"),
        blind_share(seen, [s.motion for s in stretches]) if stretches else 0.0,
        any(one.weak for one in seen),
    )


def _seen(body: Body, motion: Motion) -> SeenAtCommand:
    if is_between(body):
        return seen_at_command(body, motion)
    none = np.zeros(len(motion.time), dtype=bool)
    return SeenAtCommand(
        residual_along(body, motion).residual.value, none, motion.interaction, False
    )


def _made_up_for(
    stretches: Sequence[Stretch], values: list[Array], seen: Sequence[SeenAtCommand]
) -> list[Array]:
    """Residuals at the scale that they have where all of the interaction force reaches the body."""
    values = list(values)
    for body in {s.motion.body for s in stretches}:
        mine = [i for i, s in enumerate(stretches) if s.motion.body == body]
        if all(seen[i].passed is stretches[i].motion.interaction for i in mine):
            continue
        whole = sum(stretches[i].measured for i in mine)
        passed = 0.0
        for i in mine:
            s, kept = stretches[i], seen[i].passed
            force = s.motion.lowpassed(s.motion.at_rows(s.motion.command) + kept)[s.keep]
            passed += s.weight * float(force @ force)
        factor = max(1.0, float(np.sqrt(whole / max(passed, 1e-12 * whole))))
        for i in mine:
            values[i] = factor * values[i]
    return values


def own_groups(model: Model, stretches: Sequence[Stretch]) -> list[tuple[list[int], Own]]:
    """(places of the stretches, what they have of their own) for each record that has any."""
    groups: dict[tuple[str, str], list[int]] = {}
    for i, stretch in enumerate(stretches):
        if stretch.own:
            groups.setdefault((stretch.motion.file, stretch.motion.body), []).append(i)
    found = []
    for (_, place), group in groups.items():
        rows = [stretches[i].keep for i in group]

        def residual(body: Body, motion: Motion, k: int, rows: Any = rows) -> Array:
            left = motion.lowpassed(residual_along(body, motion).residual.value)
            return np.asarray(left[rows[k]])

        motions = [stretches[i].motion for i in group]
        names = stretches[group[0]].own
        found.append((group, own_of(model.body(place), motions, names, residual)))
    return found


def along_own(model: Model, stretches: Sequence[Stretch]) -> list[tuple[Body, Motion]]:
    """Body and motion of each stretch, with what its record has of its own."""
    return _along(model, stretches, own_groups(model, stretches))


def _along(
    model: Model, stretches: Sequence[Stretch], owned: Sequence[tuple[list[int], Own]]
) -> list[tuple[Body, Motion]]:
    found = [(model.body(s.motion.body), s.motion) for s in stretches]
    for group, own in owned:
        for i, motion in zip(group, own.motions, strict=True):
            found[i] = (own.body, motion)
    return found


def _located(model: Model, name: str | Probe) -> tuple[str, str | Probe]:
    return (model.holder(name.at), name) if isinstance(name, Probe) else model.locate(name)


def error_of(stretches: Sequence[Stretch], values: Sequence[Array]) -> float:
    """The force error of these stretches from their low-passed residuals."""
    left = sum(s.weight * float(np.sum(r**2)) for s, r in zip(stretches, values, strict=True))
    whole = sum(s.measured for s in stretches)
    return float(np.sqrt(left / whole))


def force_error(model: Model, stretches: Sequence[Stretch]) -> float:
    """Relative force error of the model as it stands, on these stretches; NaN if there are none."""
    if not stretches:
        return float("nan")
    return error_of(stretches, [r for r, _ in residuals(model, stretches)])


def folds(
    stretches: Sequence[Stretch],
) -> list[tuple[tuple[Stretch, ...], tuple[Stretch, ...]]]:
    """The stretches with `FOLDS` blocks of each held out in turn: (seen, held out)."""
    found = []
    for i in range(FOLDS):
        seen, unseen = [], []
        for s in stretches:
            part = np.arange(len(s.keep)) * FOLDS // len(s.keep) == i
            seen.append(_cut(s, s.keep[~part]))
            unseen.append(_cut(s, s.keep[part]))
        found.append((tuple(seen), tuple(unseen)))
    return found


def _cut(stretch: Stretch, keep: NDArray[np.intp]) -> Stretch:
    return replace(stretch, keep=keep, measured=_squares(stretch.motion, keep, stretch.weight))


def _measured(stretch: Stretch) -> Array:
    """The low-passed measured force on the rows that count."""
    motion = stretch.motion
    return motion.lowpassed(motion.at_rows(motion.command) + motion.interaction)[stretch.keep]


def _squares(motion: Motion, keep: NDArray[np.intp], weight: float) -> float:
    measured = motion.lowpassed(motion.at_rows(motion.command) + motion.interaction)
    return weight * float(np.sum(measured[keep] ** 2))
