"""Record offsets: an encoder zero, a bias or a level of friction that belongs to one record.

An experiment may state that a record does not share one of these with the others. Then the offset
is estimated on that record for every model, by least squares: two steps by the derivatives of the
residual, exact where force is linear in the offset. The residual and its tangents are then
projected to be orthogonal to these derivatives, so that no other parameter of a model describes
what belongs to one record.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..base.units import unit_of
from ..blocks import Body
from ..effects import SIGNALS
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..measurement.prepare import Stretch
from ..model import Model
from ..realise.along_motion import residual_along

#: iterations of the estimate: two are exact if the force is linear in the offsets
TURNS = 2
#: step of a numerical derivative, over the scale of an offset: far above rounding, and so small
#: that curvature does not matter
SLOPE = 1e-3
#: least friction level of a record, over the model's: friction does not vanish from a machine
LEAST = 0.05
_LEVEL = "coulomb.level"


@dataclass(frozen=True)
class RecordOffsets:
    """A body along the motions of one record, with the offsets of that record.

    values: "position_zero" (shift of the position, m or rad), "bias" (force that acts, N or N m),
        "friction_level" (over the model's)
    body, motions: with these offsets
    slopes: derivatives of the residual by each of the k offsets, (k, rows) for each motion
    """

    values: dict[str, float]
    body: Body
    motions: tuple[Motion, ...]
    slopes: tuple[Array, ...]

    def cleared(self, parts: Sequence[tuple[Array, Array]]) -> list[tuple[Array, Array]]:
        """Residuals (rows) and tangents (p, rows), orthogonal to the slopes of the offsets.

        Where a motion grew beyond all numbers, they stay as they are: every search rejects them.
        """
        slopes = np.concatenate(self.slopes, axis=1)
        rows = np.vstack(
            [
                np.concatenate([r for r, _ in parts])[None],
                np.concatenate([d for _, d in parts], axis=1),
            ]
        )
        if len(slopes) and np.isfinite(slopes).all() and np.isfinite(rows).all():
            rows = rows - np.linalg.lstsq(slopes.T, rows.T, rcond=1e-10)[0].T @ slopes
        ends = np.cumsum([len(r) for r, _ in parts])[:-1]
        return [(part[0], part[1:]) for part in np.split(rows, ends, axis=1)]


def _find_offsets(
    body: Body, motions: Sequence[Motion], rows: Sequence[NDArray[np.intp]], steps: dict[str, float]
) -> RecordOffsets:
    """Estimate the offsets of one record.

    motions: of the body, all of one record;  rows: that count, of each motion
    steps: as of `_steps`
    """

    def residuals(values: dict[str, float]) -> tuple[Body, tuple[Motion, ...], list[Array]]:
        there, moved = _set_offsets(body, motions, values)
        left = [m.lowpassed(residual_along(there, m).residual.value) for m in moved]
        return there, moved, [np.asarray(r[keep]) for r, keep in zip(left, rows, strict=True)]

    values = dict.fromkeys(steps, 0.0)
    for turn in range(TURNS + 1):
        corrected_body, corrected_motions, here = residuals(values)
        slopes = [np.zeros((len(steps), len(r))) for r in here]
        for i, (name, step) in enumerate(steps.items()):
            _, _, there = residuals({**values, name: values[name] + step})
            for slope, moved, left in zip(slopes, there, here, strict=True):
                slope[i] = (moved - left) / step
        whole, left = np.concatenate(slopes, axis=1), np.concatenate(here)
        # a motion grew beyond all numbers: no offset can be estimated from it
        if turn == TURNS or not (np.isfinite(whole).all() and np.isfinite(left).all()):
            break
        change = np.linalg.lstsq(whole.T, left, rcond=1e-10)[0]
        values = {n: v - float(c) for (n, v), c in zip(values.items(), change, strict=True)}
        if "friction_level" in values:
            values["friction_level"] = max(values["friction_level"], LEAST - 1.0)
    offsets = {n: 1.0 + v if n == "friction_level" else v for n, v in values.items()}
    return RecordOffsets(offsets, corrected_body, corrected_motions, tuple(slopes))


def _steps(body: Body, motions: Sequence[Motion], names: Collection[str]) -> dict[str, float]:
    """Offsets that the record can determine -> step of the numerical derivative."""
    steps = {}
    if "position_zero" in names and any(
        e.expression().has(SIGNALS["position"]) for e in body.effects
    ):
        steps["position_zero"] = SLOPE * max(float(np.std(m.position)) for m in motions)
    if "bias" in names:
        steps["bias"] = SLOPE * max(float(np.std(m.command + m.interaction)) for m in motions)
    if "friction_level" in names and _LEVEL in body.parameters:
        steps["friction_level"] = SLOPE
    return {name: step for name, step in steps.items() if step > 0}


def _set_offsets(
    body: Body, motions: Sequence[Motion], values: dict[str, float]
) -> tuple[Body, tuple[Motion, ...]]:
    level = values.get("friction_level", 0.0)
    if level:
        body = body.with_values({_LEVEL: (1 + level) * body.parameters[_LEVEL].value})
    zero, bias = values.get("position_zero", 0.0), values.get("bias", 0.0)
    changed = (
        replace(m, position=m.position + zero, interaction=m.interaction + bias) for m in motions
    )
    return body, tuple(changed)


def offset_groups(
    model: Model, stretches: Sequence[Stretch]
) -> list[tuple[list[int], RecordOffsets]]:
    """For each record and body with offsets: indices of its stretches, and the estimates.

    A record that cannot determine any of its offsets counts as without.
    """
    groups: dict[tuple[str, str], list[int]] = {}
    for i, stretch in enumerate(stretches):
        if stretch.offset_names:
            groups.setdefault((stretch.motion.file, stretch.motion.body), []).append(i)
    offsets = []
    for (_, place), group in groups.items():
        rows = [stretches[i].keep for i in group]
        motions = [as_logged(model, stretches[i].motion) for i in group]
        body = model.body(place)
        if steps := _steps(body, motions, stretches[group[0]].offset_names):
            offsets.append((group, _find_offsets(body, motions, rows, steps)))
    return offsets


@dataclass(frozen=True)
class Offset:
    """An offset of one record, as an answer states it.

    of: "position_zero", "bias" or "friction_level"
    """

    record: str
    at: str
    of: str
    value: float
    unit: str

    def __str__(self) -> str:
        what = self.of.replace("_", " ")
        return f"offset of {self.record} alone: {what} {self.value:.4g} {self.unit}"


def offsets_of(model: Model, stretches: Sequence[Stretch]) -> tuple[Offset, ...]:
    """The offsets of single records, with this model."""
    rows = []
    for group, offsets in offset_groups(model, stretches):
        motion = stretches[group[0]].motion
        units = {
            "position_zero": unit_of("position", offsets.body.axis),
            "bias": unit_of("force", offsets.body.axis),
            "friction_level": "of the model's",
        }
        rows += [
            Offset(motion.file, motion.body, name, float(value), units[name])
            for name, value in offsets.values.items()
        ]
    return tuple(rows)


def as_logged(model: Model, motion: Motion) -> Motion:
    """A motion with the model's shifts of its record, and with the force of an arm's links."""
    late = model.log_late(motion.body)
    if motion.links is not None:
        carried = motion.links.carried(model.links, motion.acceleration)
        return replace(motion, command_late=late, carried=carried)
    if sensed := model.log_late(f"{motion.body}.interaction_force"):
        unfiltered = 1.0 + sensed * motion.spectrum.derivative(1)
        force = motion.spectrum.multiply(motion.interaction, unfiltered)
        motion = replace(motion, interaction=force, interaction_late=sensed)
    return motion if late == motion.command_late else replace(motion, command_late=late)


def apply_record_offsets(
    model: Model,
    stretches: Sequence[Stretch],
    groups: Sequence[tuple[list[int], RecordOffsets]] | None = None,
) -> list[tuple[Body, Motion]]:
    """Body and motion of each stretch, with the offsets of its record.

    groups: of `offset_groups`; None: they are computed
    """
    groups = offset_groups(model, stretches) if groups is None else groups
    located = [(model.body(s.motion.body), as_logged(model, s.motion)) for s in stretches]
    for group, offsets in groups:
        for i, motion in zip(group, offsets.motions, strict=True):
            located[i] = (offsets.body, motion)
    return located
