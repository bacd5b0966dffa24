"""Which columns belong to joints that are called by words: "hip_pos", "knee.effort", "FL1_torque".

A word is the name of a joint only where the log holds position and force of two joints at least,
each with the same words for its quantities. So "actual" and "desired" are none.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import lru_cache

from ..column_names import is_wanted, likeness, words_of
from .content import SURE_NAME

Words = tuple[str, ...]

#: words that tell apart two columns of one joint: how a value was measured or computed, and at
#: which end of a gear
_OF_ONE_JOINT = frozenset(
    "actual act ist measured meas feedback fb raw filtered filt est estimated sim model exp real "
    "true pred predicted motor load link input output in out sensor drive actuator rotor gear "
    "shaft max min mean avg rms std peak error err offset old new first second total".split()
)
#: quantities whose words are no names of joints
_QUANTITIES = ("position", "velocity", "actuator_force", "interaction_force")


@lru_cache(maxsize=4096)
def _joint_and_quantity(name: str) -> tuple[Words, Words]:
    """The words of a name that may call a joint, and those of its quantity."""
    words = words_of(name)
    is_quantity = [any(likeness(word, q) >= SURE_NAME for q in _QUANTITIES) for word in words]
    joint = tuple(w for w, known in zip(words, is_quantity, strict=True) if not known)
    quantity = tuple(w for w, known in zip(words, is_quantity, strict=True) if known)
    is_symbol = any(len(word) == 1 for word in joint)  # "q_d" and "q_m" are of one joint
    apart = is_symbol or is_wanted(name) or not _OF_ONE_JOINT.isdisjoint(joint + quantity)
    if not joint or not quantity or apart:
        return (), quantity
    return joint, quantity


@lru_cache(maxsize=64)
def _quantities_of_joints(names: frozenset[str]) -> dict[Words, frozenset[Words]]:
    """Joint -> its quantities, for the joints whose position and force another joint has, too."""
    of: dict[Words, set[Words]] = {}
    for name in names:
        joint, quantity = _joint_and_quantity(name)
        if joint:
            of.setdefault(joint, set()).add(quantity)
    return {
        joint: frozenset(known)
        for joint, known in of.items()
        if any(n != joint and _are_of_a_joint(known & other) for n, other in of.items())
    }


def _are_of_a_joint(quantities: Collection[Words]) -> bool:
    """Whether a position and a force are among quantities."""
    kinds = ("position", "actuator_force")
    return all(
        any(likeness(word, kind) >= SURE_NAME for words in quantities for word in words)
        for kind in kinds
    )


def of_another_joint(one: str, other: str, names: Collection[str]) -> bool:
    """Whether two columns belong to two joints that are called by words.

    names: all columns of the log.  Each joint has the quantity of the other's column as well
    """
    joints = _quantities_of_joints(frozenset(names))
    (first, quantity), (second, quantity_2) = map(_joint_and_quantity, (one, other))
    if first == second or first not in joints or second not in joints:
        return False
    return quantity in joints[second] and quantity_2 in joints[first]


def same_at_another_joint(one: str, other: str, names: Collection[str]) -> bool:
    """Whether two columns hold the same quantity of two joints that are called by words."""
    same = _joint_and_quantity(one)[1] == _joint_and_quantity(other)[1]
    return same and of_another_joint(one, other, names)
