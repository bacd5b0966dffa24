"""TOML as text: strings, keys and inline tables, for everything that writes a TOML file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping

#: control characters that a comment may not hold: all but the tab
_CONTROL = re.compile(r"[\x00-\x08\x0a-\x1f\x7f]")


def string_text(text: str) -> str:
    """A basic string of TOML: that of JSON, but for one control character that JSON leaves."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def key_text(name: str) -> str:
    """A key of TOML: bare where TOML allows it, else in quotes."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else string_text(name)


def comment_text(text: str) -> str:
    """A comment of TOML on one line; control characters, which TOML forbids there, as escapes."""
    return f"# {_CONTROL.sub(lambda one: _escape(one[0]), text)}".rstrip()


def _escape(character: str) -> str:
    return f"\\x{ord(character):02x}"


def inline_text(entries: Mapping[str, str]) -> str:
    """An inline table of keys and values, both as TOML text."""
    inside = ", ".join(f"{key} = {value}" for key, value in entries.items())
    return f"{{ {inside} }}" if inside else "{}"
