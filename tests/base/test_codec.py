"""Dataclasses as plain data and back: the same again, or one line that says what is wrong."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.codec import (
    INLINE,
    NEVER,
    OMIT,
    At,
    DataForm,
    Error,
    Filled,
    InUnit,
    Size,
    from_data,
    to_data,
)
from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.frozen import is_same


@dataclass(frozen=True)
class Box:
    left: Size
    alone: Annotated[float, At("box.alone")]


@dataclass(frozen=True)
class Row:
    name: str
    error: Error = math.nan
    alike: tuple[str, ...] = ()

    ALSO_WRITTEN: ClassVar[Mapping[str, str]] = {"count": "count"}

    @property
    def count(self):
        return len(self.alike)


@dataclass(frozen=True)
class Whole:
    verdict: Literal["a", "b"]
    rows: Annotated[tuple[Row, ...], Filled(1)]
    box: Annotated[Box | None, INLINE] = None
    limit: Annotated[float, InUnit("Hz")] = math.nan
    where: Annotated[str, At("limit.where")] = ""
    parts: Annotated[Mapping[str, Row], OMIT] = field(default_factory=dict)
    number: complex = 0j
    anything: Any = None
    secret: Annotated[int, NEVER] = 0


FORMS = {complex: DataForm(lambda z: [z.real, z.imag], lambda data, where: complex(*data))}
NUMBERS = st.floats(0, 1e300) | st.just(math.nan)
ROWS = st.builds(Row, st.text(), NUMBERS, st.lists(st.text(), max_size=3).map(tuple))
WHOLES = st.builds(
    Whole,
    st.sampled_from("ab"),
    st.lists(ROWS, min_size=1, max_size=3).map(tuple),
    st.none() | st.builds(Box, st.floats(0, 1e9), NUMBERS),
    NUMBERS,
    st.text(),
    st.dictionaries(st.text(), ROWS, max_size=2),
    st.complex_numbers(allow_nan=False, allow_infinity=False),
    st.none() | st.lists(st.integers()),
)


@given(WHOLES)
def test_what_is_read_is_what_was_written(whole):
    text = json.dumps(to_data(whole, FORMS), allow_nan=False)
    assert is_same(from_data(Whole, json.loads(text), "", FORMS), whole)


PLAIN = {"verdict": "a", "rows": [{"name": "x"}]}


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"verdict": "c"}, 'w.verdict: found "c", expected "a" or "b"'),
        ({"rows": []}, "w.rows: found 0 entries, expected 1 or more"),
        ({"rows": [{}]}, r'w.rows\[1\]: no key "name"'),
        ({"rows": [{"name": 1}]}, r"w.rows\[1\].name: found a whole number, expected a text"),
        ({"rows": [{"name": "x", "error": -1}]}, r"error: found -1, expected a finite number, 0"),
        ({"left": 10**400}, "w.left: found inf, expected a finite number"),
        ({"left": 1, "box": 3}, "w.box: found a whole number, expected a table"),
        ({"limit": {}}, 'w.limit: no key "value"'),
    ],
)
def test_what_is_wrong_is_one_line_with_its_place(changed, message):
    with pytest.raises(ExperimentError, match=message) as caught:
        from_data(Whole, PLAIN | changed, "w", FORMS)
    assert "\n" not in str(caught.value)
