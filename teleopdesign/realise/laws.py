"""Laws as source text: the only place where an expression becomes code that is executed.

An expression is printed with private names of its symbols. A symbol without such a name, or a
function that neither Python nor the package knows, has no source. A system known as code is called
by a name of the package. So no name given by a user can appear in generated code.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.printing.pycode import PythonCodePrinter

from ..base.errors import ModelError, quote
from ..controllers import is_call

#: symbol -> its private name in the source
Names = Mapping[sp.Symbol, str]


class _Printer(PythonCodePrinter):
    """Python of the functions of `math`; symbols by their private names, in sympy's order."""

    def __init__(self, names: Names) -> None:
        super().__init__({"fully_qualified_modules": False})
        self.names = names

    def _print_AppliedUndef(self, expr: AppliedUndef) -> str:
        return f"{expr.func}({', '.join(self._print(x) for x in expr.args)})"

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        if expr not in self.names:
            raise ModelError(f"a law holds {quote(expr.name)}, which nothing gives: no source")
        return self.names[expr]


def source_of(expression: sp.Expr, names: Names) -> str:
    """The expression as one line of Python.

    raises ModelError: a symbol has no private name, or a function has no known source
    """
    functions = (f for f in expression.atoms(AppliedUndef) if not is_call(f))
    if strangers := sorted(str(f.func) for f in functions):
        raise ModelError(f"a law holds the function {quote(strangers[0])}, which has no source")
    text = str(_Printer(names).doprint(expression))
    if "\n" in text or "#" in text:  # how sympy marks what it cannot print
        raise ModelError(f"a law holds {quote(text.splitlines()[-1])}, which has no source")
    return text


def assignments(results: Mapping[str, sp.Expr], names: Names, *, shared: str = "") -> list[str]:
    """Lines that compute the results, each under its private name.

    shared: beginning of the names of common parts, which are computed once; "": no common parts
    raises ModelError: as `source_of`
    """
    if not shared:
        return [f"{name} = {source_of(e, names)}" for name, e in results.items()]
    common, out = sp.cse(list(results.values()), symbols=sp.numbered_symbols("k"))
    known = {**names, **{symbol: f"{shared}{i}" for i, (symbol, _) in enumerate(common)}}
    lines = [f"{known[symbol]} = {source_of(e, known)}" for symbol, e in common]
    pairs = zip(results, out, strict=True)
    return [*lines, *(f"{name} = {source_of(e, known)}" for name, e in pairs)]


def indent(lines: Sequence[str], depth: int) -> str:
    """Lines of source, indented by `depth` spaces."""
    return "\n".join(" " * depth + line for line in lines)
