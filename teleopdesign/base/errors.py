"""Errors of the package, and names that it accepts.

A message is one line: where, what the value was, what was expected, a near name. A name is a plain
word, so that it can be shown, looked up and written into any file. Generated source contains none
of these names: each has a private stand-in there (`realise.laws`).
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable
from difflib import get_close_matches

_LONGEST_QUOTE = 60  # characters of a user's text that a message repeats
_MOST_NAMED = 20  # names that a message lists


class TeleopDesignError(Exception):
    """Base of every error that the package raises on purpose."""

    def __init__(self, message: str) -> None:
        # A user's text may hold line breaks and control characters; a message stays one line.
        super().__init__(printable(message))


class ExperimentError(TeleopDesignError):
    """A file of an experiment, or an entry in it, cannot be used."""


class ModelError(TeleopDesignError):
    """A model, diagram or effect is inconsistent."""


class UnknownSignal(ModelError):
    """A diagram has no such signal, state or motion, whatever its parameters are."""


class UnstableLoop(ModelError):
    """A loop is unstable without any change, so that it has no stability margin."""


class GrowsWithoutBound(ModelError):
    """Signals of a simulation grow beyond all bounds: the loop is unstable.

    words: text that every such message contains
    """

    words = "grow beyond all bounds"


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The name in `known` that a person who wrote `word` probably meant; None if none is close."""
    names = list(known)
    for name in names:
        if name.lower() == word.lower():
            return name
    matches = get_close_matches(word, names, n=1, cutoff=0.6)
    if matches:
        return matches[0]
    by_lower_case = {name.lower(): name for name in reversed(names)}
    matches = get_close_matches(word.lower(), by_lower_case, n=1, cutoff=0.6)
    return by_lower_case[matches[0]] if matches else None


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """End of a message: '; did you mean "x"?', or nothing if no known name is close.

    word: the text in place of a name; a value that is not a text is close to no name
    """
    match = nearest(word, known) if isinstance(word, str) else None
    return "" if match is None else f'; did you mean "{match}"?'


def unknown(kind: str, name: object, known: Iterable[object]) -> str:
    """What is wrong with a name: 'no law "dhal", has coulomb, dahl; did you mean "dahl"?'.

    kind: of what the name stands for
    """
    names = [str(one) for one in known]
    more = f", ... ({len(names)} in all)" if len(names) > _MOST_NAMED else ""
    listed = f"{', '.join(names[:_MOST_NAMED])}{more}" or "none"
    return f"no {kind} {quote(str(name))}, has {listed}{did_you_mean(str(name), names)}"


def quote(text: str) -> str:
    """`text` in double quotes, shortened if it is long."""
    if len(text) > _LONGEST_QUOTE:
        text = text[: _LONGEST_QUOTE - 3] + "..."
    return f'"{text}"'


def printable(text: str, *, keep: str = "") -> str:
    """`text` with its control characters, marks of direction and line breaks escaped.

    keep: characters that are not escaped
    """
    return "".join(c if c.isprintable() or c in keep else _escape(c) for c in text)


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")


#: characters; the longest name in the package has 30. What is longer is no name but a text.
LONGEST = 100
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)


def check_name(name: object, *, where: str) -> str:
    """The name unchanged, if it is made of ASCII letters, digits and underscores, no digit first.

    where: beginning of a message
    raises ModelError: the name is too long, has other characters or is a keyword of Python; the
        message proposes a valid name where there is one
    """
    if not isinstance(name, str):
        raise ModelError(f"{where}: found {type(name).__name__}, expected a name")
    if len(name) > LONGEST:
        raise ModelError(
            f"{where}: found the name {quote(name)} of {len(name)} characters, "
            f"expected at most {LONGEST}"
        )
    if not _WORD.fullmatch(name):
        raise ModelError(
            f"{where}: found the name {quote(name)}, expected letters (a to z), digits and "
            f"underscores, no digit first{did_you_mean(name, [_mend(name)])}"
        )
    if keyword.iskeyword(name):
        raise ModelError(
            f"{where}: found the name {quote(name)}, a word of Python that no expression can "
            f'hold; did you mean "{name}_"?'
        )
    return name


def _mend(name: str) -> str:
    """The name with an underscore in place of characters that are not allowed."""
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    return f"_{word}" if word[:1].isdigit() else word
