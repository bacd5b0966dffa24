"""Which columns of a log belong to one axis: by the parts, numbers, letters and words of names."""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import lru_cache

from ..column_names import WANTED, bare_name, likeness, words_of
from .content import SURE_NAME

Words = tuple[str, ...]

#: words for the two sides of a teleoperator, or of a device for both hands; letters of axes
_SIDES = (
    ("master", "slave"), ("leader", "follower"), ("local", "remote"), ("mtm", "psm"),
    ("left", "right"), ("links", "rechts"),
)  # fmt: skip
#: letters that are indices of sides where the log holds both; others, "q_d", tell kinds of values
_LETTERS = frozenset("mslfr")
#: the field of a struct or joint, or a whole name without one; and the numbers of axes ("J2_pos")
_STEM = re.compile(r"(?:^|[./])[^./]*$")
_NUMBERS = re.compile(r"\d+")
#: the letter of an axis in space as the last word of a name: "PosX", "force_y", "Torque z"
_SPACE = re.compile(r"(?:(?<=[a-z])[XYZ]|(?<=[_\s.-])[xyzXYZ])$")
#: words of names that tell columns apart by their number only
_COLUMNS = frozenset("column col channel chan ch var signal data value spalte kanal wert".split())
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


def of_another_axis(one: str, other: str, names: Collection[str] = ()) -> bool:
    """Whether two columns belong to two axes: "J1_current", "J2_angle"; "slave_pos", "master_cmd".

    names: all columns of the log. Another word or letter calls a joint or a side only where the log
        holds each of the two columns with that of the other, too: "q_m", "q_s", "tau_m", "tau_s"
    """
    numbers = {_axis_numbers(name) for name in (one, other)}
    if len(numbers) == 2 and () not in numbers:
        return True
    first, second = (words_of(name) for name in (one, other))
    for pair in _SIDES:
        sides = [{side for side in pair if side in words} for words in (first, second)]
        if all(len(side) == 1 for side in sides):
            return sides[0] != sides[1]
    (label, quantity), (label_2, quantity_2) = _split(first), _split(second)
    if not label or not label_2 or label == label_2:
        return False
    splits = {_split(words_of(name)) for name in names}
    both, both_2 = ({q for of, q in splits if of == one} for one in (label, label_2))
    return {quantity, quantity_2} <= both & both_2 and len(both & both_2) > 1


@lru_cache(maxsize=4096)
def _split(words: Words) -> tuple[Words, Words]:
    """The words that may call a joint, "hip", or a side, "m", and those of a quantity."""
    called = [w in _LETTERS if len(w) == 1 else not _tells_quantity(w) for w in words]
    pairs = list(zip(words, called, strict=True))
    return tuple(w for w, is_label in pairs if is_label), tuple(w for w, is_l in pairs if not is_l)


def _tells_quantity(word: str) -> bool:
    return word in WANTED or any(likeness(word, q) >= SURE_NAME for q in _QUANTITIES)
