"""Which columns of a log belong to one axis: parts, numbers, letters and words of their names.

A word is the name of a joint, "hip_pos", only where the log holds position and force of two joints
at least, each with the same words for its quantities. So "actual" and "desired" are none.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import lru_cache

from ..column_names import bare_name, is_wanted, likeness, words_of
from .content import SURE_NAME

Words = tuple[str, ...]

#: words for the two sides of a teleoperator, or of a device for both hands
_SIDES = (
    ("master", "slave"), ("leader", "follower"), ("local", "remote"), ("mtm", "psm"),
    ("left", "right"), ("links", "rechts"),
)  # fmt: skip
#: letters at the end of a name: of these sides, "q_m" and "q_s", "xl" and "xr"; of axes, "fx", "fy"
_LETTERS = (("m", "s"), ("l", "f"), ("l", "r"), ("x", "y"), ("y", "z"), ("x", "z"))
#: the field of a struct or joint, or a whole name without one; and the numbers of axes ("J2_pos")
_STEM = re.compile(r"(?:^|[./])[^./]*$")
_NUMBERS = re.compile(r"\d+")
#: the letter of an axis in space as the last word of a name: "PosX", "force_y", "Torque z"
_SPACE = re.compile(r"(?:(?<=[a-z])[XYZ]|(?<=[_\s.-])[xyzXYZ])$")
#: words of names that tell columns apart by their number only
_COLUMNS = frozenset(
    ("column", "col", "channel", "chan", "ch", "var", "signal", "data", "value")
    + ("spalte", "kanal", "wert")
)
#: words that tell apart two columns of one joint: how a value was measured or computed, and at
#: which end of a gear
_OF_ONE_JOINT = frozenset(
    "actual act ist measured meas feedback fb raw filtered filt est estimated sim model exp real "
    "true pred predicted motor load link input output in out sensor drive actuator rotor gear "
    "shaft max min mean avg rms std peak error err offset old new first second total".split()
)
#: quantities whose words are no names of joints
_QUANTITIES = ("position", "velocity", "actuator_force", "interaction_force")


def stand_together(one: str, other: str) -> bool:
    """Whether two columns are fields of one struct, or of one joint in a message."""
    stems = {_STEM.sub("", name) for name in (one, other)}
    if stems != {""}:
        return len(stems) == 1
    numbers = {_axis_numbers(name) for name in (one, other)}
    return len(numbers) == 1 and () not in numbers


def _axis_numbers(name: str) -> tuple[str, ...]:
    """Numbers in a name, "J2_pos" -> 2, or its letter, "PosX" -> x: such numbers count axes.

    Where the name says no more, "column 2", they count columns.
    """
    bare = bare_name(name)
    if _COLUMNS.issuperset(words_of(_SPACE.sub("", bare))):
        return ()
    return (*_NUMBERS.findall(bare), *map(str.lower, _SPACE.findall(bare)))


def same_but_axis(one: str, other: str) -> bool:
    """Whether two names differ in the number of their axis only, "joint1" and "joint2"."""
    numbers = {_axis_numbers(name) for name in (one, other)}
    stems = {_NUMBERS.sub("#", _SPACE.sub("#", bare_name(name))) for name in (one, other)}
    return len(numbers) == 2 and () not in numbers and len(stems) == 1


def of_another_axis(one: str, other: str, names: Collection[str] = ()) -> bool:
    """Whether two columns belong to two axes: "J1_current", "J2_angle"; "slave_pos", "master_cmd".

    names: all columns of the log. The last letter of a name tells a side only where the log holds
        the other side of both columns, too: "q_m", "q_s", "tau_m", "tau_s"; the same is true of a
        word that calls a joint
    """
    numbers = {_axis_numbers(name) for name in (one, other)}
    if len(numbers) == 2 and () not in numbers:
        return True
    words = [frozenset(words_of(name)) for name in (one, other)]
    for pair in _SIDES:
        sides = [{side for side in pair if side in of_name} for of_name in words]
        if all(len(side) == 1 for side in sides):
            return sides[0] != sides[1]
    if names and of_another_joint(one, other, names):
        return True
    bare = {bare_name(name).lower() for name in names}
    for pair in _LETTERS:
        letters = [_side_letter(name, pair, bare) for name in (one, other)]
        if None not in letters and max(map(len, map(bare_name, (one, other)))) > 1:
            return letters[0] != letters[1]
    return False


def _side_letter(name: str, pair: tuple[str, str], bare: Collection[str]) -> str | None:
    """The letter of `pair` at the end of a name, where the log holds the same name with the other.

    bare: the names of all columns, without units and in lower case
    """
    name = bare_name(name).lower()
    for letter, opposite in (pair, pair[::-1]):
        if name.endswith(letter) and name[:-1] + opposite in bare:
            return letter
    return None


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
