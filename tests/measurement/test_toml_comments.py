"""Comments in the TOML files that the package writes: a user's text in them breaks no file."""

import tomllib

from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.toml import comment_text


@given(st.text(st.characters(exclude_categories=["Cs"])))
def test_no_text_in_a_comment_adds_to_a_file_or_makes_it_unreadable(text):
    assert tomllib.loads(f"{comment_text(text)}\na = 1") == {"a": 1}


def test_a_control_character_is_shown_and_a_tab_stays():
    assert comment_text("in \x1fPA\tor\nmore") == "# in \\x1fPA\tor\\nmore"
