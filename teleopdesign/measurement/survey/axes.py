"""Which columns of a log belong to one axis, from the parts and the numbers of their names."""

from __future__ import annotations

import re

from ..column_names import bare_name

#: score for a force in the same struct or joint as the position: more than the difference between
#: similar names ("current" 0.98, "effort" 0.9), and less than that of a name of a commanded value
BESIDE = 0.2
#: loss of score for a force whose name has another axis number than the position: as much as
#: physics can add, because two axes that move alike explain each other's forces
ANOTHER_AXIS = 1.0
#: the field of a struct or joint, or a whole name without one; and the numbers of axes ("J2_pos")
_STEM = re.compile(r"(?:^|[./])[^./]*$")
_NUMBERS = re.compile(r"\d+")


def stand_together(one: str, other: str) -> bool:
    """Whether two columns are fields of one struct, or of one joint in a message."""
    stems = {_STEM.sub("", name) for name in (one, other)}
    if stems != {""}:
        return len(stems) == 1
    numbers = {_axis_numbers(name) for name in (one, other)}
    return len(numbers) == 1 and () not in numbers


def _axis_numbers(name: str) -> tuple[str, ...]:
    """Numbers in a name, "J2_pos" -> 2: such numbers count axes."""
    return tuple(_NUMBERS.findall(bare_name(name)))


def of_another_axis(one: str, other: str) -> bool:
    """Whether the names of two columns have numbers of different axes: "J1_current", "J2_angle"."""
    numbers = {_axis_numbers(name) for name in (one, other)}
    return len(numbers) == 2 and () not in numbers
