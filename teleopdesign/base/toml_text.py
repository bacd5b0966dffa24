"""TOML as text: strings, keys and inline tables, for all functions that write a TOML file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping

from .errors import printable


def string_text(text: str) -> str:
    """A basic string of TOML: as in JSON, with one more control character escaped."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def key_text(name: str) -> str:
    """A key of TOML: bare where TOML allows it, else in quotes."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else string_text(name)


def comment_text(text: str) -> str:
    """A TOML comment on one line; control characters, which TOML forbids there, are escaped."""
    return f"# {printable(text, keep=chr(9))}".rstrip()


def inline_text(entries: Mapping[str, str]) -> str:
    """An inline table; keys and values are TOML text already."""
    inside = ", ".join(f"{key} = {value}" for key, value in entries.items())
    return f"{{ {inside} }}" if inside else "{}"
