"""Paths of all joints of an arm that determine its parameters best, within shown limits.

Each joint follows a sum of sines of one base frequency, so that the motion repeats and derivatives
are known exactly. Force is linear in base parameters and in Coulomb and viscous friction. Of random
paths within the limits, the path with the smallest standard errors (geometric mean over all
parameters) is kept. It is then changed at random; changes that lower this mean are kept.

Source: Swevers, Ganseman, Tukel, De Schutter, Van Brussel, Optimal robot excitation and
identification, IEEE Trans. Robotics and Automation 13 (1997) 730.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..arms.regressor import BaseParameters, base_parameters, columns_with_motors
from ..base.errors import ExperimentError
from ..base.frozen import ByValue
from ..base.shown import Shown
from ..diagnose import Diagnosis
from ..measurement.filtering import Array
from .limits import Limits, shown_limits
from .proposal import Reference

#: longest period of a path, s; and its highest sine, in multiples of the inverse of the period
PERIOD, HARMONICS = 10.0, 5
#: samples of a path for its evaluation: forty for each period of its fastest sine
SAMPLES = 200
#: number of random paths, and of changes of the best one: on an arm of two joints twice as many
#: improved little
DRAWS, CHANGES = 100, 300
#: size of a change, over that of the coefficients
CHANGE = 0.3
#: parts of the limits that a path may use; the largest part with forces within their limits counts.
#: Not all of a limit is used, because the readings of the records have noise
USED = (0.95, 0.8, 0.65, 0.5)


@dataclass(frozen=True, eq=False)
class ArmPaths(Shown, ByValue):
    """Paths of all joints of an arm: periodic, and at rest at their start.

    reference: joint -> position over time;  period: s
    condition, recorded: condition numbers of the regressors of these paths and of the fit records
    errors: parameter -> standard error from as many samples of these paths, over that of the fit
        records, for equal residuals
    """

    reference: Reference
    period: float
    condition: float
    recorded: float
    errors: Mapping[str, float]

    @property
    def is_useful(self) -> bool:
        """Whether the paths determine the parameters better than the records do, on average."""
        return self.gain < 1.0

    @property
    def gain(self) -> float:
        """Geometric mean of the parameters' standard errors, relative to those of the records."""
        return float(np.exp(np.mean(np.log(list(self.errors.values())))))


def propose_paths(
    diagnosis: Diagnosis,
    *,
    duration: float = 20.0,
    limits: Mapping[str, Limits] | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> ArmPaths:
    """The paths of all joints that determine the arm's parameters best.

    duration: s, of the reference: whole periods of at most `PERIOD`;  seed: of the random paths
    limits: joint -> limits; None: those that its records have shown. The force is computed from the
        links of the diagnosis, and from Coulomb and viscous friction
    raises ExperimentError: no path keeps the limits
    """
    experiment, prepared = diagnosis.experiment, diagnosis.recording.parts
    assert experiment.arm is not None
    shown = {j: shown_limits(p)[j] for j, p in prepared.parts.items()} | dict(limits or {})
    judge = _Judge(diagnosis, [shown[j] for j in prepared.parts])
    period = duration / math.ceil(duration / PERIOD)
    generator = np.random.default_rng(seed)
    best, least = None, math.inf
    for k in range(DRAWS + CHANGES):
        if progress is not None and k % 10 == 0:
            progress(f"paths of all joints ({k} of {DRAWS + CHANGES})")
        drawn = generator.normal(size=(2, len(shown), HARMONICS))
        if k >= DRAWS and best is not None:
            drawn = best + CHANGE * np.std(best) * drawn
        error = judge.error(drawn, period)
        if error < least:
            best, least = drawn, error
    if best is None:
        raise ExperimentError(
            f"{experiment.folder.name}: all paths within the limits of the joints need more force "
            "than the limits allow: state larger limits with --limit"
        )
    step = experiment.records[0].sample_time
    time = np.linspace(0.0, duration, round(duration / step) + 1)
    position = judge.motion(best, period, time)[0]
    parts = (f"paths of all joints with a period of {period:g} s",)
    return ArmPaths(
        Reference(time, dict(zip(prepared.parts, position, strict=True)), parts, 1),
        period,
        judge.condition(best, period),
        judge.recorded,
        judge.errors(best, period),
    )


class _Judge:
    """Evaluation of paths by regressors of base parameters and friction, scaled by force."""

    def __init__(self, diagnosis: Diagnosis, limits: list[Limits]) -> None:
        assert diagnosis.experiment.arm is not None
        self.arm = diagnosis.experiment.arm.arm
        self.base: BaseParameters = base_parameters(self.arm)
        self.limits = limits
        self.links = np.array(diagnosis.model.links or self.base.initial)
        joints = diagnosis.recording.parts.parts
        self.joints = tuple(joints)
        motions = [[s.motion for s in p.of("fit")] for p in joints.values()]
        force = [
            np.concatenate([m.at_rows(m.command) + m.interaction for m in ms]) for ms in motions
        ]
        self.size = np.array([float(np.sqrt(np.mean(f**2))) for f in force])
        moved = [
            np.array([np.concatenate([getattr(m, n) for m in ms]) for ms in motions])
            for n in ("position", "velocity", "acceleration")
        ]
        every = max(1, moved[0].shape[1] // (10 * SAMPLES))
        rows = self._regressor(*(x[:, ::every] for x in moved))
        links = self._links(*(x[:, ::every] for x in moved))
        # level and viscous damping of each joint, by the direction of its motion: for the force
        beside = np.array([f[::every] for f in force]) - links
        speed = moved[1][:, ::every]
        self.friction = np.array(
            [_level_and_damping(f, v) for f, v in zip(beside, speed, strict=True)]
        )
        self.variance, self.recorded = _variance(rows), _condition(rows)

    def motion(self, drawn: Array, period: float, time: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (k, n), at rest at time 0, within the limits.

        The largest part in `USED` of the limits that the force allows is used; NaN where none is
        allowed.
        """
        once: Array = np.arange(SAMPLES) * period / SAMPLES
        for used in USED:
            if self._is_allowed(*self._scale_path(drawn, period, once, used)):
                return self._scale_path(drawn, period, time, used)
        nothing = np.full((len(self.limits), len(time)), np.nan)
        return nothing, nothing, nothing

    def _is_allowed(self, position: Array, velocity: Array, acceleration: Array) -> bool:
        """Whether the force of links and friction keeps the limits."""
        force = self._links(position, velocity, acceleration)
        level, damping = self.friction.T[:, :, None]
        force = force + level * np.sign(velocity) + damping * velocity
        return bool(np.all(np.abs(force).max(axis=1) <= [limit.force for limit in self.limits]))

    def _scale_path(
        self, drawn: Array, period: float, time: Array, used: float
    ) -> tuple[Array, Array, Array]:
        """The path scaled to a part of the limits of position, speed and acceleration."""
        w: Array = np.arange(1.0, HARMONICS + 1.0) * (2.0 * np.pi / period)
        sine, cosine = drawn[0] / w, drawn[1] / w
        # at rest at the beginning: neither velocity nor acceleration
        sine = sine - np.outer(sine @ w, w) / float(w @ w)
        cosine = cosine - np.outer(cosine @ w**2, w**2) / float(w**2 @ w**2)
        out = [np.zeros((len(sine), len(time))) for _ in range(3)]
        fine = np.linspace(0.0, period, 4 * SAMPLES)
        for j, limit in enumerate(self.limits):
            q, v, a = _sums(sine[j], cosine[j], w, fine)
            factor = used * min(
                (limit.high - limit.low) / np.ptp(q),
                limit.speed / np.abs(v).max(),
                limit.acceleration / np.abs(a).max(),
            )
            middle = 0.5 * (limit.low + limit.high) - factor * 0.5 * (q.max() + q.min())
            for target, signal in zip(out, _sums(sine[j], cosine[j], w, time), strict=True):
                target[j] = factor * signal
            out[0][j] += middle
        return out[0], out[1], out[2]

    def error(self, drawn: Array, period: float) -> float:
        """Mean logarithm of a path's standard errors; infinite where it needs too much force."""
        rows = self._along(drawn, period)
        if rows is None:
            return math.inf
        return float(np.mean(np.log(np.maximum(_variance(rows), 1e-300)))) / 2.0

    def condition(self, drawn: Array, period: float) -> float:
        """Condition number of a path's regressor."""
        rows = self._along(drawn, period)
        return math.inf if rows is None else _condition(rows)

    def _along(self, drawn: Array, period: float) -> Array | None:
        """The regressor of a path; None where it needs too much force or has not full rank."""
        moved = self.motion(drawn, period, np.arange(SAMPLES) * period / SAMPLES)
        if not np.isfinite(moved[0]).all():
            return None
        rows = self._regressor(*moved)
        return rows if np.linalg.matrix_rank(rows) == rows.shape[1] else None

    def errors(self, drawn: Array, period: float) -> dict[str, float]:
        """Parameter -> standard error of a path over that of the fit records, for equal samples."""
        rows = self._along(drawn, period)
        assert rows is not None
        names = [f"arm.{n}" for n in self.base.names]
        names += [f"{j}.{n}" for n in ("coulomb.level", "viscous.damping") for j in self.joints]
        ratio = np.sqrt(_variance(rows) / self.variance)
        return {n: float(x) for n, x in zip(names, ratio, strict=True) if np.isfinite(x)}

    def _links(self, position: Array, velocity: Array, acceleration: Array) -> Array:
        columns = columns_with_motors(self.arm, position, velocity, acceleration)
        return np.asarray(np.einsum("b,kbn->kn", self.links, columns[:, self.base.chosen]))

    def _regressor(self, position: Array, velocity: Array, acceleration: Array) -> Array:
        """Force of all joints per parameter (k n, b + 2 k), over the rms force of each joint."""
        columns = columns_with_motors(self.arm, position, velocity, acceleration)
        k = len(position)
        friction = [np.eye(k)[:, :, None] * x[:, None, :] for x in (np.sign(velocity), velocity)]
        whole = np.concatenate([columns[:, self.base.chosen], *friction], axis=1)
        whole = whole / self.size[:, None, None]
        return np.asarray(whole.transpose(0, 2, 1).reshape(-1, whole.shape[1]))


def _level_and_damping(force: Array, velocity: Array) -> Array:
    """Coulomb level and viscous damping (2,) that fit a force (n,) best."""
    columns = np.column_stack([np.sign(velocity), velocity])
    return np.asarray(np.linalg.lstsq(columns, force, rcond=None)[0])


def _sums(sine: Array, cosine: Array, w: Array, time: Array) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration (n,) of a sum of sines."""
    phase = np.outer(time, w)
    s, c = np.sin(phase), np.cos(phase)
    velocity = c @ (sine * w) - s @ (cosine * w)
    return s @ sine + c @ cosine, velocity, -(s @ (sine * w**2)) - c @ (cosine * w**2)


def _condition(rows: Array) -> float:
    """Condition number of a regressor with columns of unit length."""
    norm = np.linalg.norm(rows, axis=0)
    if not (norm > 0).all():
        return float("inf")
    return float(np.linalg.cond(rows / norm))


def _variance(rows: Array) -> Array:
    """Variance of each parameter per variance of the noise, times the number of rows."""
    inverse = np.linalg.pinv(rows.T @ rows / len(rows), rcond=1e-14, hermitian=True)
    return np.maximum(np.diag(inverse), 0.0)
