"""Errors of the package, in one line: where, what the value was, what was expected, a near name."""

from collections.abc import Iterable
from difflib import get_close_matches

_LONGEST_QUOTE = 60  # characters of a user's text that a message repeats


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
