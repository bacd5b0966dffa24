"""Residual rows of one body, with all signals that the residual is compared with.

Where a body sticks, friction balances every force: a force that the model lacks leaves no residual.
So every regressor is first multiplied by the residual per missing force (`push`, `grip`), then
low-passed like the residual.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..diagnose.fit import block_numbers
from ..diagnose.folds import folds
from ..diagnose.record_offsets import as_logged
from ..diagnose.residual import residuals
from ..diagnose.solve import free_parameters
from ..effects import Effect, Parameter
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch, measured_force
from ..measurement.reversals import look_back_to_reversal
from ..model import Model
from ..realise.along_motion import residual_along

#: s without sure motion after which a body counts as having rested: longer than a hand takes to
#: reverse, and shorter than the half second that experimenters wait
RESTED = 0.2

_SIZE = {"size": Parameter("force", "size", lower=-float("inf"))}
_PUSH = Effect(role="force", law=lambda now, p: p.size, parameters=_SIZE, absent={"size": 0.0})
_GRIP = Effect(
    role="friction_level", law=lambda now, p: p.size, parameters=_SIZE, absent={"size": 0.0}
)
PUSH, GRIP = _PUSH.named("unexplained_force", ""), _GRIP.named("unexplained_level", "")


@dataclass(frozen=True)
class StretchSignals:
    """One stretch at full rate: n samples, SI.

    signals: name -> (n,), signals that a residual may depend on; and "push", the residual per
        missing force, 1 while the body slides, and "grip", per missing friction level, the
        direction of sliding: both 0 where it sticks
    """

    stretch: Stretch
    signals: Mapping[str, Array]


@dataclass(frozen=True)
class Rows:
    """The rows that count of one body (n in all); see `Stretch.keep`.

    residual: low-passed, unit of the forces;  tangents: (n, p) by the free parameters
    measured: measured force, low-passed likewise
    root: square root of the samples that a row represents, 0 where no motion is certain: there only
        bounds of friction are known
    blocks: number of the row's quarter second
    number: of the row's stretch
    splits: pairs of masks: rows for estimates, rows for tests
    """

    body: str
    axis: str
    bandwidth: float
    alongs: tuple[StretchSignals, ...]
    residual: Array
    measured: Array
    tangents: Array
    root: Array
    blocks: NDArray[np.intp]
    number: NDArray[np.intp]
    splits: tuple[tuple[NDArray[np.bool_], NDArray[np.bool_]], ...]

    @property
    def is_curve(self) -> bool:
        """Whether the rows are points of a friction curve, without time and position."""
        return self.bandwidth == np.inf

    @property
    def checked(self) -> NDArray[np.bool_]:
        """Mask of the rows on which dependences are tested."""
        return np.asarray(sum(test for _, test in self.splits), dtype=bool)

    @property
    def learnt(self) -> NDArray[np.bool_]:
        """Mask of the rows of the final estimates: those of the fit records."""
        return np.asarray(sum(train for train, _ in self.splits), dtype=bool)

    def lowpassed(self, columns: Callable[[StretchSignals], Array]) -> Array:
        """Low-passed columns (n, k) at the rows, from signals (k, samples) of each stretch."""
        return np.concatenate(
            [a.stretch.motion.lowpassed(columns(a))[:, a.stretch.keep].T for a in self.alongs]
        )

    def at(self, name: str) -> Array:
        """A signal at the rows (n,)."""
        return np.concatenate([a.signals[name][a.stretch.keep] for a in self.alongs])


def rows_of(model: Model, prepared: Prepared, body: str) -> Rows:
    """The residual rows of one body of a fitted model."""
    stretches = tuple(s for s in prepared.stretches if s.motion.body == body)
    free = [n for n in free_parameters(model) if model.locate(n)[0] == body]
    parts = residuals(model, stretches, free)
    lengths = [len(s.keep) for s in stretches]
    return Rows(
        body=body,
        axis=model.body(body).axis,
        bandwidth=prepared.bandwidth,
        alongs=tuple(_signals_along(model, s) for s in stretches),
        residual=np.concatenate([r for r, _ in parts]),
        measured=np.concatenate([measured_force(s) for s in stretches]),
        tangents=np.concatenate([d.T for _, d in parts]),
        root=np.concatenate(
            [np.sqrt(s.weight) * (s.motion.direction[s.keep] != 0) for s in stretches]
        ),
        blocks=block_numbers(stretches),
        number=np.repeat(np.arange(len(stretches)), lengths),
        splits=_splits(stretches),
    )


def _splits(
    stretches: Sequence[Stretch],
) -> tuple[tuple[NDArray[np.bool_], NDArray[np.bool_]], ...]:
    """Fit and check rows; without check records, blocks of the fit records held out in turn."""
    check = np.repeat([s.use == "check" for s in stretches], [len(s.keep) for s in stretches])
    if check.any():
        return ((~check, check),)
    return tuple((~fold.rows, fold.rows) for fold in folds(stretches))


def _signals_along(model: Model, stretch: Stretch) -> StretchSignals:
    motion = as_logged(model, stretch.motion)
    body = model.body(motion.body).with_effect(PUSH, {"size": 0.0}).with_effect(GRIP, {"size": 0.0})
    along = residual_along(body, motion, [f"{PUSH.name}.size", f"{GRIP.name}.size"])
    acting = along.acting.value
    since = look_back_to_reversal(
        motion.direction, motion.position, sample_time=motion.sample_time, rest=RESTED
    )
    spectrum, moves = motion.spectrum, motion.direction != 0
    push, grip = -along.residual.tangent
    # with a zero of its own, a position cannot be compared with that of other records
    position = np.full_like(acting, np.nan) if stretch.has_zero_offset else motion.position
    expected = acting - motion.lowpassed(along.residual.value)
    signals = {
        "time": motion.time,
        "position": position,
        "velocity": motion.velocity,
        "speed": np.abs(motion.velocity),
        "acceleration": motion.acceleration,
        "actuator_force": acting,
        "load": np.abs(acting),
        "expected_force": expected,
        "expected_load": np.abs(expected),
        "interaction_force": motion.interaction,
        "force_rate": spectrum.multiply(acting, spectrum.derivative(1)),
        "direction": motion.direction.astype(float),
        "since_reversal": since.time,
        "travel": since.travel,
        "rested": since.rested,
        "push": push,
        "grip": grip * moves,
    }
    return StretchSignals(stretch, signals)
