"""What a name may be: of a signal, a block, a parameter, wherever a file or a call states it.

A name is a plain word, so that it can be shown, looked up and written into any file. No generated
source holds it: there each name has a private stand-in (`realise.private_names`).
"""

from __future__ import annotations

import keyword
import re

from .errors import ModelError, did_you_mean, quote

#: characters; the longest name in the package has 30. What is longer is no name but a text.
LONGEST = 100
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)


def check_name(name: object, *, where: str, dotted: bool = False) -> str:
    """The name itself, where it is one: ASCII letters, digits and underscores, no digit first.

    where: beginning of a message;  dotted: words joined by dots, such as "coulomb.level"
    raises ModelError: anything else, with a name that is near to it
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
    """The name with an underscore for everything that it may not hold."""
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    return f"_{word}" if word[:1].isdigit() else word
