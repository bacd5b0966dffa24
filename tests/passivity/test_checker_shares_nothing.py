"""A checker that shared code with the prover would accept the prover's mistakes."""

import ast
import sys

from syntax_trees import PACKAGE, syntax_trees

CHECKER = PACKAGE / "passivity" / "checker"
#: they write certificates, and check those of a file
READERS = {"passivity/claims/certificate.py", "commands/passivity.py"}


def imported(tree):
    """Level and dotted name of each import of a module."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                yield node.level, f"{node.module or ''}.{alias.name}"
        elif isinstance(node, ast.Import):
            yield from ((0, alias.name) for alias in node.names)


def test_the_checker_imports_itself_and_the_standard_library_alone():
    trees = {path: tree for path, tree in syntax_trees().items() if CHECKER in path.parents}
    assert len(trees) > 5
    for path, tree in trees.items():
        for level, name in imported(tree):
            assert level == 1 or name.split(".")[0] in sys.stdlib_module_names, (path, name)


def test_no_prover_imports_the_checker():
    users = {
        path.relative_to(PACKAGE).as_posix()
        for path, tree in syntax_trees().items()
        if CHECKER not in path.parents
        for level, name in imported(tree)
        if level and "checker" in name.split(".")
    }
    assert users == READERS
