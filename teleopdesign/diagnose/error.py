"""The force error: rms of the residual force relative to the measured force.

    error = rms(LP residual) / rms(LP (actuator force + interaction force)),  without the ends

LP is the zero-phase low-pass at the comparison's bandwidth; sums of squares run over all bodies,
records and segments of one use ("fit" or "check"). The ends of each record do not count.

In a model in which less force acts, less force remains to be explained, but such a model may ignore
the recorded command. So the force error is also computed from the residual mapped back to the
command, and an effect must lower both errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..base.codec import At, InUnit, Size
from ..base.frozen import ByValue
from ..base.sentences import percent
from ..blocks import Body
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..measurement.prepare import Prepared, Stretch, measured_force
from ..measurement.reversals import mark_reversals
from ..model import Model
from ..realise.along_motion import residual_along
from ..realise.residual_at_command import (
    ResidualAtCommand,
    blind_share,
    is_between,
    residual_at_command,
)
from .record_offsets import apply_record_offsets, offset_groups
from .residual import residuals

#: s to either side of a reversal that count as near: there presliding, gaps and lags show
NEAR = 0.1


def error_of(stretches: Sequence[Stretch], values: Sequence[Array]) -> float:
    """The force error of these stretches, from the low-passed residual of each (N or N m)."""
    with np.errstate(over="ignore"):  # inf where a hidden body grew beyond all numbers
        left = sum(s.weight * float(np.sum(r**2)) for s, r in zip(stretches, values, strict=True))
    whole = sum(s.measured for s in stretches)
    return float(np.sqrt(left / whole))


def weigh_residuals(stretches: Sequence[Stretch], values: Sequence[Array]) -> Array:
    """Residuals of all stretches in one array, each row times the square root of its weight.

    The weight of a row is the number of rows that it represents.
    """
    parts = [np.sqrt(s.weight) * r for s, r in zip(stretches, values, strict=True)]
    return np.concatenate(parts) if parts else np.zeros(0)


def force_error(model: Model, stretches: Sequence[Stretch]) -> float:
    """Relative force error of a model on these stretches, without estimation; NaN: no stretch."""
    if not stretches:
        return float("nan")
    return error_of(stretches, [r for r, _ in residuals(model, stretches)])


@dataclass(frozen=True)
class NearReversals:
    """Check error on the rows within `NEAR` of a reversal, relative to the force there.

    share: part of these rows among all rows that count;  within: s
    """

    error: Annotated[Size, At("check_error")]
    share: Size
    within: Annotated[float, InUnit("s")] = NEAR

    def __str__(self) -> str:
        return (
            f"within {self.within:g} s of a reversal: {percent(self.error, '.3g')} of the force "
            f"there ({percent(self.share, '.2g')} of the rows)"
        )


def mark_near_reversals(motion: Motion) -> NDArray[np.bool_]:
    """Whether each sample (n,) is within `NEAR` of a reversal."""
    return mark_reversals(motion.direction, within=round(NEAR / motion.sample_time))


def error_near_reversals(model: Model, prepared: Prepared) -> NearReversals | None:
    """The error near reversals on check records, else on fit records; None: no reversals."""
    stretches = prepared.of("check") or prepared.of("fit")
    left = force = 0.0
    rows = whole = 0
    for s, (residual, _) in zip(stretches, residuals(model, stretches), strict=True):
        near = mark_near_reversals(s.motion)[s.keep]
        left += s.weight * float(np.sum(residual[near] ** 2))
        force += s.weight * float(np.sum(measured_force(s)[near] ** 2))
        rows, whole = rows + int(near.sum()), whole + len(near)
    return NearReversals(float(np.sqrt(left / force)), rows / whole) if force > 0.0 else None


@dataclass(frozen=True, eq=False)
class AtCommand(ByValue):
    """Residual of a model on some stretches, as an error of the recorded forces.

    residual: low-passed and weighted, on the rows that count; in blind rows the acting residual
    sighted: the rows that are not blind
    error: rms residual over rms measured force, both over the rows that are not blind; NaN: there
        are none
    blind: share of blind samples among those where the body slides
    """

    residual: Array
    sighted: NDArray[np.bool_]
    error: float
    blind: float


def refer_to_command(model: Model, stretches: Sequence[Stretch]) -> AtCommand:
    """Residual of the model as an error of the recorded forces: see `residual_at_command`.

    Equal to `residuals` where no effect lies between the recorded forces and the body. Where the
    model withholds a part of the interaction force from a body, the residual is scaled up
    accordingly.
    """
    groups = offset_groups(model, stretches)
    located = apply_record_offsets(model, stretches, groups)
    motions = [motion for _, motion in located]
    command_errors = [_map_back(*one) for one in located]
    values = [
        m.lowpassed(one.residual)[s.keep]
        for s, m, one in zip(stretches, motions, command_errors, strict=True)
    ]
    nothing = np.zeros((0, 0))
    for group, offsets in groups:
        bare = [(values[i], nothing.reshape(0, len(values[i]))) for i in group]
        for i, (residual, _) in zip(group, offsets.cleared(bare), strict=True):
            values[i] = residual
    values = _scale_to_command(stretches, motions, values, command_errors)
    sighted = [~one.blind[s.keep] for s, one in zip(stretches, command_errors, strict=True)]
    left = whole = 0.0
    for s, r, sighted_rows in zip(stretches, values, sighted, strict=True):
        left += s.weight * float(np.sum(r[sighted_rows] ** 2))
        whole += (
            s.measured
            if sighted_rows.all()
            else s.weight * float(np.sum(measured_force(s)[sighted_rows] ** 2))
        )
    return AtCommand(
        weigh_residuals(stretches, values),
        np.concatenate([np.zeros(0, dtype=bool), *sighted]),
        float(np.sqrt(left / whole)) if whole > 0.0 else float("nan"),
        blind_share(command_errors, [s.motion for s in stretches]) if stretches else 0.0,
    )


def _map_back(body: Body, motion: Motion) -> ResidualAtCommand:
    along = residual_along(body, motion)
    if is_between(body):
        return residual_at_command(body, motion, along)
    none = np.zeros(len(motion.time), dtype=bool)
    return ResidualAtCommand(along.residual.value, none, motion.interaction)


def _scale_to_command(
    stretches: Sequence[Stretch],
    motions: Sequence[Motion],
    values: list[Array],
    command_errors: Sequence[ResidualAtCommand],
) -> list[Array]:
    """Residuals scaled as if all of the interaction force reached the body.

    How much of it does shows only where the body slides: where a body may rest, friction balances
    the whole force whatever the law takes from it.

    motions: of the stretches, as logged;  values: residual of each stretch
    """
    values = list(values)
    for body in {s.motion.body for s in stretches}:
        mine = [i for i, s in enumerate(stretches) if s.motion.body == body]
        if all(command_errors[i].passed is motions[i].interaction for i in mine):
            continue
        anywhere = not any(motions[i].direction.any() for i in mine)
        whole = passed = 0.0
        for i in mine:
            s, m = stretches[i], motions[i]
            slides = anywhere | (m.direction != 0)
            command = s.motion.at_rows(s.motion.command)
            forces = np.stack([command + m.interaction, command + command_errors[i].passed])
            acting, reaching = s.motion.lowpassed(forces * slides)[:, s.keep]
            whole += s.weight * float(acting @ acting)
            passed += s.weight * float(reaching @ reaching)
        factor = max(1.0, float(np.sqrt(whole / max(passed, 1e-12 * whole))))
        for i in mine:
            values[i] = factor * values[i]
    return values
