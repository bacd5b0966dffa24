"""The names that signals, blocks and parameters may have, in files and in calls.

A name is a plain word, so that it can be shown, looked up and written into any file. Generated
source contains none of these names: each has a private stand-in there (`realise.private_names`).
"""

from __future__ import annotations

import keyword
import re

from .errors import ModelError, did_you_mean, quote

#: characters; the longest name in the package has 30. What is longer is no name but a text.
LONGEST = 100
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)


def check_name(name: object, *, where: str, dotted: bool = False) -> str:
    """The name unchanged, if it is made of ASCII letters, digits and underscores, no digit first.

    where: beginning of a message;  dotted: accept words joined by dots, such as "coulomb.level"
    raises ModelError: the name is too long, has other characters or is a keyword of Python; the
        message proposes a valid name where there is one
    """
    if not isinstance(name, str):
        raise ModelError(f"{where}: found {type(name).__name__}, expected a name")
    words = name.split(".") if dotted else [name]
    if len(name) > LONGEST:
        raise ModelError(
            f"{where}: found the name {quote(name)} of {len(name)} characters, "
            f"expected at most {LONGEST}"
        )
    if not all(_WORD.fullmatch(word) for word in words):
        raise ModelError(
            f"{where}: found the name {quote(name)}, expected letters (a to z), digits and "
            f"underscores, no digit first{did_you_mean(name, [_mend(name)])}"
        )
    if any(keyword.iskeyword(word) for word in words):
        raise ModelError(
            f"{where}: found the name {quote(name)}, a word of Python that no expression can "
            f'hold; did you mean "{name}_"?'
        )
    return name


def _mend(name: str) -> str:
    """The name with an underscore in place of characters that are not allowed."""
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    return f"_{word}" if word[:1].isdigit() else word
