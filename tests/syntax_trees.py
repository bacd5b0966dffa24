"""Syntax trees of the package's files, parsed once for all tests that read the code."""

import ast
from functools import cache
from pathlib import Path

import teleopdesign

PACKAGE = Path(teleopdesign.__file__).parent


def parsed(folder):
    """File -> its tree, of all files of Python below a folder."""
    return {p: ast.parse(p.read_text(encoding="utf-8")) for p in sorted(folder.rglob("*.py"))}


@cache
def syntax_trees():
    """Those of the package, which nobody changes."""
    return parsed(PACKAGE)
