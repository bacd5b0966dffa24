"""Inputs of boosted trees: the motion, without force and without signals that reveal the time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..measurement.reversals import look_back_to_reversal
from .candidates import tells_place_from_time

#: s without sure motion after which a motion counts as a new start, even in the same direction
REST = 0.5


def inputs_along(motions: Sequence[Motion], beside: Sequence[Sequence[Motion]] = ()) -> list[Array]:
    """Inputs of the trees (n, k), for each motion; further measured channels are inputs too.

    beside: for each motion, those of an arm's other joints at the same times
    """
    if beside:  # the other motion of a joint is the motion of one of these
        motions = [replace(m, further=_without_other_motion(m)) for m in motions]
    inputs = [_columns_of_body(m, [o for o in motions if o.body == m.body]) for m in motions]
    if not beside:
        return inputs
    with_place = [tells_place_from_time(of_one) for of_one in zip(*beside, strict=True)]
    return [
        np.column_stack([mine, *_columns_of_others(others, with_place)])
        for mine, others in zip(inputs, beside, strict=True)
    ]


def _without_other_motion(motion: Motion) -> dict[str, Array]:
    return {n: x for n, x in motion.further.items() if not n.startswith("other_")}


def _columns_of_body(motion: Motion, motions: Sequence[Motion]) -> Array:
    """Inputs from the motion of the body itself (n, k); NaN before the first certain motion.

    motions: all motions of that body. Where none returns to a place, or none reverses, position or
        time since a reversal would reveal the time, and with it the recorded command
    """
    since = look_back_to_reversal(
        motion.direction, motion.position, sample_time=motion.sample_time, rest=REST
    )
    columns: list[Array] = [motion.velocity, motion.acceleration, motion.direction.astype(float)]
    if tells_place_from_time(motions):
        columns.append(motion.position)
    if any({-1, 1} <= set(m.direction.tolist()) for m in motions):
        columns += [np.where(since.known, x, np.nan) for x in (since.time, since.travel)]
    return np.column_stack([*columns, *motion.further.values()])


def _columns_of_others(motions: Sequence[Motion], with_place: Sequence[bool]) -> list[Array]:
    """Inputs from the motions of the other joints at the same times, columns (n,).

    with_place: for each joint, whether its position does not reveal the time
    """
    columns: list[Array] = []
    for motion, has_place in zip(motions, with_place, strict=True):
        columns += [motion.velocity, motion.acceleration, motion.direction.astype(float)]
        columns += [motion.position] * has_place
    return columns
