"""Laws as source text: the only place where an expression becomes code that is executed.

An expression is printed with private names of its symbols. A symbol without such a name, or a
function that neither Python nor the package knows, has no source. A system known as code is called
by a name of the package. So no name given by a user can appear in generated code.

Functions of the loop work on its memory: quantities of one group lie in consecutive rows, each row
with an entry for each lane. The last argument of every function is its lane.

Signals are s000_, s001_ ... and blocks b000_, b001_ ... in their order, whatever their names are.
So no name of a user equals a word of the generated source, or a name that the package makes itself
(`s000__velocity`). A diagram with other names gives the same numbers to the last bit. All names
that a user reads are translated back.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.printing.pycode import PythonCodePrinter

from ..base.errors import ModelError, quote
from ..controllers import is_call
from ..diagrams import Diagram, position_symbol

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


def needed_steps(
    results: Iterable[sp.Expr], joined: Mapping[sp.Symbol, sp.Expr]
) -> dict[sp.Symbol, sp.Expr]:
    """The named steps that the results depend on, in their order."""
    wanted = set().union(*(sp.sympify(r, strict=True).free_symbols for r in results))
    needed = {}
    for symbol, expression in reversed(list(joined.items())):
        if symbol in wanted:
            needed[symbol] = expression
            wanted |= expression.free_symbols
    return dict(reversed(list(needed.items())))


def list_inverses(
    expressions: Iterable[sp.Expr], parameters: Collection[sp.Symbol]
) -> tuple[sp.Pow, ...]:
    """Constant divisors in the expressions: inverses of polynomials in the parameters."""
    known = set(parameters)
    inverses = {
        power
        for expression in expressions
        for power in expression.atoms(sp.Pow)
        if power.exp.is_Integer
        and power.exp < 0
        and power.base.free_symbols
        and power.base.free_symbols <= known
        and power.base.is_polynomial()
    }
    return tuple(sorted(inverses, key=sp.default_sort_key))


#: symbol -> the text that reads it
Places = Mapping[sp.Symbol, str]


def locate_entry(first: str, i: int) -> str:
    """Source of the entry of a lane in row i of a group."""
    return f"memory[{first} + {f'{i} * LANES + ' if i else ''}lane]"


def locate_symbols(rows: Mapping[str, Iterable[sp.Symbol]]) -> dict[sp.Symbol, str]:
    """Symbol -> source that reads it, for groups by the first row of each in the memory."""
    return {x: locate_entry(row, i) for row, symbols in rows.items() for i, x in enumerate(symbols)}


def write_function(name: str, arguments: Iterable[str], lines: Iterable[str]) -> str:
    """Source of a function with these lines; its last argument is the lane."""
    body = indent(list(lines) or ["pass"], 4)
    return f"@jitted\ndef {name}({', '.join([*arguments, 'lane'])}):\n{body}\n\n\n"


def write_reader(name: str, many: int) -> str:
    """Source of a function that returns a column of a table as numbers: see `integrator.py`.

    Beyond the last column the function returns the last one: a table of one column is constant.
    """
    numbers = [
        *(f"table[{i}, column]" for i in range(many)),
        "0.0",
    ]  # 0.0: a tuple also without inputs
    held = "    column = min(column, table.shape[1] - 1)\n" if many else ""
    return f"@jitted\ndef {name}(table, column):\n{held}    return ({', '.join(numbers)},)\n\n\n"


@dataclass(frozen=True)
class LawWriter:
    """Writer of the source of some laws: their arguments, and how symbols are read.

    places: symbol -> source that reads it;  names: symbol -> private name
    joined: named steps that results may depend on
    inverses: constant inverse -> the symbol that it is read by
    """

    arguments: tuple[str, ...]
    places: Places
    names: Names
    joined: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)
    inverses: Mapping[sp.Expr, sp.Symbol] = field(default_factory=dict)

    def lines(self, results: Mapping[str, sp.Expr]) -> list[str]:
        """Lines that compute the results under private names, with common parts computed once."""
        needed = needed_steps(results.values(), self.joined)
        needed = {s: sp.sympify(e).xreplace(self.inverses) for s, e in needed.items()}
        results = {name: sp.sympify(e).xreplace(self.inverses) for name, e in results.items()}
        expressions = (*results.values(), *needed.values())
        used = set().union(*(x.free_symbols for x in expressions))
        return [
            *(f"{self.names[x]} = {place}" for x, place in self.places.items() if x in used),
            *assignments({self.names[s]: e for s, e in needed.items()}, self.names),
            *assignments(results, self.names, shared="k"),
        ]

    def function(self, name: str, **rows: Iterable[sp.Expr]) -> str:
        """Source of a function that writes results into the memory; rows: first row -> results."""
        places = {
            locate_entry(to, i): sp.sympify(x, strict=True)
            for to in rows
            for i, x in enumerate(rows[to])
        }
        results = {f"out{i}": x for i, x in enumerate(places.values())}
        lines = [*self.lines(results), *map(" = ".join, zip(places, results, strict=True))]
        return write_function(name, (*self.arguments, *rows), lines)


#: beginning of every private name; ends with "_", so that no such name begins another one
_BEGIN = re.compile(r"\b[sbd]\d{3,}_")
_TITLE = "d000_"


@dataclass(frozen=True)
class PrivateNames:
    """The diagram with private names, and the translation back.

    public: private name -> name of the user;  private: signal -> its private name
    """

    diagram: Diagram
    public: Mapping[str, str]
    private: Mapping[str, str]

    def public_name(self, name: str) -> str:
        """The user's name for a private name, or for one derived from it, such as a velocity."""
        begin = _BEGIN.match(name)
        return name if begin is None else self.public[begin[0]] + name[begin.end() :]

    def public_names(self, *names: str) -> tuple[str, ...]:
        """The user's names, as of `public_name`.

        raises ModelError: two of them are equal, or one is "time"
        """
        owners: dict[str, str] = {"time": "the time"}
        for name in dict.fromkeys(names):
            public = self.public_name(name)
            if public in owners:
                two = sorted(
                    (owners[public], self._describe_signal(name)),
                    key=lambda text: text != "the signal",
                )
                raise ModelError(
                    f'{self.public[_TITLE]}: "{public}" is the name of {" and of ".join(two)}: '
                    "call the signal otherwise"
                )
            owners[public] = self._describe_signal(name)
        return tuple(map(self.public_name, names))

    def _describe_signal(self, name: str) -> str:
        begin = _BEGIN.match(name)
        if begin is None or begin[0] == name:
            return "the signal"
        what = name[begin.end() :].strip("_").replace("_", " ")
        return f"the {what} of {self.public[begin[0]]}"

    @contextmanager
    def in_errors(self) -> Iterator[None]:
        """A context in which errors on the private diagram are raised with the user's names."""
        try:
            yield
        except ModelError as error:
            text = _BEGIN.sub(lambda m: self.public.get(m[0], m[0]), str(error))
            raise type(error)(text) from None


#: fields of the parts of a diagram that hold no names of signals
_NO_SIGNALS = frozenset({"name", "axis", "role", "entry"})


def private_names(diagram: Diagram) -> PrivateNames:
    """The diagram with private names of its signals and blocks; values and wiring are the same."""
    signals = {s: f"s{i:03d}_" for i, s in enumerate(diagram.signals)}
    blocks = {b.name: f"b{i:03d}_" for i, b in enumerate(diagram.blocks)}
    symbols = {position_symbol(s): position_symbol(p) for s, p in signals.items()}

    def renamed(content: Any) -> Any:
        if isinstance(content, str):
            return signals.get(content, "")  # blank: none
        if isinstance(content, tuple):
            return tuple(map(renamed, content))
        if isinstance(content, Mapping):
            return {signals[s]: renamed(x) for s, x in content.items()}
        return content.xreplace(symbols) if isinstance(content, sp.Expr) else content

    def part(one: Any, **more: str) -> Any:
        named = {f.name for f in fields(one)} - _NO_SIGNALS
        return replace(one, **{n: renamed(getattr(one, n)) for n in named}, **more)

    inner = Diagram(
        _TITLE,
        tuple(part(b, name=blocks[b.name]) for b in diagram.blocks),
        tuple(map(part, diagram.junctions)),
        {signals[s]: quantity for s, quantity in diagram.outside.items()},
        renamed(diagram.measured),
        {},
        tuple(map(part, diagram.kinematics)),
        {signals[s]: x for s, x in diagram.pose.items() if s in signals},
    )
    public = {_TITLE: diagram.name} | {
        p: n for table in (signals, blocks) for n, p in table.items()
    }
    return PrivateNames(inner, MappingProxyType(public), MappingProxyType(signals))
