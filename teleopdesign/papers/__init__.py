"""The statements of the two papers, P1 to P65, with the code that proves, checks or refutes them.

Every file whose name does not begin with `_` holds the statements of one topic. This module
collects them in `STATEMENTS`.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from types import MappingProxyType

from ..base.errors import ModelError, did_you_mean
from ._proof import Correction, NotProved, ProofSteps
from ._statement import HOW, Figure, Numbers, Paper, Result, Statement, check

__all__ = [
    "HOW",
    "STATEMENTS",
    "Figure",
    "NotProved",
    "Numbers",
    "Paper",
    "ProofSteps",
    "Correction",
    "Result",
    "Statement",
    "check",
    "find_statement",
]


def _statements() -> Mapping[str, Statement]:
    by_number: dict[int, Statement] = {}
    for module in pkgutil.iter_modules(__path__):
        if module.name.startswith("_"):
            continue
        for thing in vars(importlib.import_module(f"{__name__}.{module.name}")).values():
            if isinstance(thing, Statement):
                if thing.number in by_number:
                    raise ModelError(f"papers: {thing.name} is there twice, in {module.name} too")
                by_number[thing.number] = thing
    return MappingProxyType({by_number[n].name: by_number[n] for n in sorted(by_number)})


#: name, P1 to P65 -> statement, in order
STATEMENTS: Mapping[str, Statement] = _statements()


def find_statement(name: str) -> Statement:
    """The statement of the papers with that name, such as "P16".

    raises ModelError: no such statement; the message names the nearest one
    """
    if name not in STATEMENTS:
        known = list(STATEMENTS)
        raise ModelError(
            f'check-papers: no statement "{name}", expected {known[0]} to {known[-1]}'
            f"{did_you_mean(name, known)}"
        )
    return STATEMENTS[name]
