"""One long line is decided at once, whatever it holds: no search begins anew at each character."""

import pytest
from clock import takes_less_than

from teleopdesign.base.toml import parse_toml

#: characters: a search that begins anew at each takes a minute
LENGTH = 60_000
DOTS = "." * 100
PARTS = ["-", "a . ", "'", '\\"', "[", "9", '# "', " "]


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("begin", [DOTS, f"# {DOTS}", f'a = "{DOTS}', f"a.{DOTS} = "])
def test_a_long_line_of_toml_is_read_or_refused_at_once(begin, part):
    with takes_less_than(2):
        try:
            parse_toml(begin + part * (LENGTH // len(part)) + "\n")
        except (ValueError, RecursionError) as problem:
            assert str(problem)


@pytest.mark.parametrize(
    ("text", "is_long"),
    [
        (".".join(["a"] * 100) + " = 1", True),
        (" . ".join(["a", '"b c"', "'d'"] * 34) + " = 1", True),
        ("x = {" + ".".join(["a"] * 100) + " = 1}", True),
        (".".join(["a"] * 99) + " = 1", False),
        ('a = "' + ".".join(["a"] * 200) + '"', False),
        ('a = "\\"' + ".".join(["a"] * 200) + '"', False),
    ],
)
def test_keys_of_a_hundred_words_are_refused_and_texts_are_not(text, is_long):
    if is_long:
        with pytest.raises(ValueError, match="100 words or more"):
            parse_toml(text)
    else:
        assert parse_toml(text)
