"""Docstrings as the package writes them (plain text, indented equations), made readable HTML."""

from __future__ import annotations

import re
from textwrap import dedent, indent
from typing import Any

from sphinx.application import Sphinx

_ENTRY = re.compile(r"(?:raises )?[A-Za-z_][\w, ]*: ")


def blocks(text: str) -> list[tuple[str, list[str]]]:
    """Paragraphs of a docstring: ("code" | "entries" | "text", lines)."""
    parts = []
    for part in re.split(r"\n\s*\n", dedent(text).strip("\n")):
        lines = part.split("\n")
        if all(line.startswith("    ") for line in lines if line.strip()):
            if parts and parts[-1][0] == "code":
                parts[-1][1].extend(["", *dedent(part).split("\n")])
                continue
            parts.append(("code", dedent(part).split("\n")))
        elif parts and _ENTRY.match(lines[0]):
            parts.append(("entries", lines))
        else:
            parts.append(("text", lines))
    return parts


def entries(lines: list[str]) -> list[tuple[str, str]]:
    """(name, text) of "name: text" lines; two spaces after ";" part entries on one line."""
    pairs: list[tuple[str, str]] = []
    for line in lines:
        for piece in re.split(r";  +", line.strip()):
            match = _ENTRY.match(piece)
            if match and not line.startswith(" "):
                pairs.append((match.group().removesuffix(": "), piece[match.end() :]))
            elif pairs:
                name, text = pairs[-1]
                pairs[-1] = (name, f"{text} {piece}")
            else:
                pairs.append(("", piece))
    return pairs


def escaped(text: str) -> str:
    """Plain text as reStructuredText; `name` becomes a literal."""
    parts = re.split(r"`([^`]+)`", text)
    plain = [re.sub(r"([\\*|_])", r"\\\1", p) for p in parts[::2]]
    quoted = [f"``{p}``" for p in parts[1::2]]
    out = plain[0]
    for literal, rest in zip(quoted, plain[1:], strict=True):
        out += f"{literal}{_apart(rest)}"
    return out


def _apart(rest: str) -> str:
    return f"\\ {rest}" if rest[:1].isalnum() else rest


def as_rst(text: str) -> list[str]:
    """A docstring of the package as lines of reStructuredText."""
    out: list[str] = []
    for kind, lines in blocks(text):
        if kind == "code":
            language = "pycon" if lines[0].startswith(">>>") else "text"
            out += [f".. code-block:: {language}", "", *indent("\n".join(lines), "   ").split("\n")]
        elif kind == "entries":
            for name, meaning in entries(lines):
                mark = f"**{escaped(name)}**: " if name else ""
                out.append(f"- {mark}{escaped(meaning)}")
        else:
            out.append(escaped(" ".join(line.strip() for line in lines)))
        out.append("")
    return out


def _process(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = as_rst("\n".join(lines))


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("autodoc-process-docstring", _process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
