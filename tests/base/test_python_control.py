"""python-control enters the package by one file, so that another version of it changes one file."""

import ast

from syntax_trees import PACKAGE, import_statements, syntax_trees


def imported(tree):
    """Modules that a file imports by their full names when it runs; types may name them too."""
    for node in import_statements(tree, for_types=False):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif not node.level:
            yield node.module


def test_one_file_imports_python_control():
    importers = {
        path.relative_to(PACKAGE).as_posix()
        for path, tree in syntax_trees().items()
        if any(name.split(".")[0] == "control" for name in imported(tree))
    }
    assert importers == {"base/python_control.py"}
