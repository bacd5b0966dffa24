"""The loop of `integrator.py` without what a structure does not need.

A device without bristles, late signals or a computer has nothing to do in some loops and functions.
The result would not change, but numba infers the types of all that is written.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

#: constants that are zero, or false; and functions that do nothing
_NOTHING = re.compile(r"^(MANY_\w+) = 0$|^(COMPUTER) = False$", re.MULTILINE)
_IDLE = re.compile(r"^def (\w+)\(.*\):\n    pass$", re.MULTILINE)


def needed_loop(laws: str) -> str:
    """Source of the loop around these laws (`Generator.source`)."""
    nothing = frozenset("".join(names) for names in _NOTHING.findall(laws))
    return _write(nothing, frozenset(_IDLE.findall(laws)))


@cache
def _write(nothing: frozenset[str], idle: frozenset[str]) -> str:
    # above the line of "#" are imports for reading the file by itself
    text = Path(__file__).with_name("integrator.py").read_text(encoding="utf-8")
    whole = ast.parse(text.split("#" * 98 + "\n", 1)[1])
    return ast.unparse(_WithoutNothing(nothing, set(idle)).visit(whole))


class _WithoutNothing(ast.NodeTransformer):
    """Leaves out loops over nothing, conditions on it, and calls of functions that do nothing.

    In the file a function is called below its definition only.
    """

    def __init__(self, nothing: frozenset[str], idle: set[str]) -> None:
        self._nothing, self._idle = nothing, idle

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef | None:
        self.generic_visit(node)
        node.body = [x for x in node.body if not _is_text(x)]
        # a function that only prepares numbers returns none
        if all(isinstance(x, ast.Assign) and _is_name(x.targets[0]) for x in node.body):
            self._idle.add(node.name)
            return None
        return node

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        call = node.value
        idle = isinstance(call, ast.Call) and _is_name(call.func, self._idle)
        return None if idle else node

    def visit_For(self, node: ast.For) -> ast.For | None:
        self.generic_visit(node)
        assert isinstance(node.iter, ast.Call)
        many = node.iter.args[0]
        many = many.left if isinstance(many, ast.BinOp) else many
        return None if not node.body or _is_name(many, self._nothing) else node

    def visit_If(self, node: ast.If) -> ast.If | None:
        self.generic_visit(node)
        test = node.test
        if isinstance(test, ast.BoolOp) and isinstance(test.op, ast.And):
            test = test.values[0]
        elif isinstance(test, ast.Compare):
            test = test.left
        return None if not node.body or _is_name(test, self._nothing) else node


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _is_name(node: ast.expr, names: frozenset[str] | set[str] | None = None) -> bool:
    return isinstance(node, ast.Name) and (names is None or node.id in names)
