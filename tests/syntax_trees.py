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


def import_statements(node, *, for_types=True):
    """Statements that import, at any depth;  for_types: also those that only type checkers read."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import | ast.ImportFrom):
            yield child
        elif isinstance(child, ast.stmt | ast.excepthandler | ast.match_case):
            # no expression imports: most of a tree need not be looked at
            is_for_types = isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test)
            if for_types or not is_for_types:
                yield from import_statements(child, for_types=for_types)
