"""python-control enters the package by one file, so that another version of it changes one file."""

import ast
from pathlib import Path

import teleopdesign as td

PACKAGE = Path(td.__file__).parent


def imported(path):
    """Modules that a file imports by their full names when it runs; types may name them too."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for_types = {
        inner
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    for node in set(ast.walk(tree)) - for_types:
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module


def test_one_file_imports_python_control():
    importers = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if any(name.split(".")[0] == "control" for name in imported(path))
    }
    assert importers == {"base/python_control.py"}
