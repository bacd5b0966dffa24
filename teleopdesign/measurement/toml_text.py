"""TOML as text: strings, keys and inline tables, for everything that writes a TOML file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping

from ..errors import printable


def string_text(text: str) -> str:
    """A basic string of TOML: that of JSON, but for one control character that JSON leaves."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def key_text(name: str) -> str:
    """A key of TOML: bare where TOML allows it, else in quotes."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else string_text(name)


def comment_text(text: str) -> str:
    """A comment of TOML on one line; control characters, which TOML forbids there, as escapes."""
    return f"# {printable(text, keep=chr(9))}".rstrip()


def inline_text(entries: Mapping[str, str]) -> str:
    """An inline table of keys and values, both as TOML text."""
    inside = ", ".join(f"{key} = {value}" for key, value in entries.items())
    return f"{{ {inside} }}" if inside else "{}"
