"""Source of functions on the memory of the loop: how symbols are read, and results are written.

The last argument of every function is its lane. Quantities of one group lie in consecutive rows,
each row with an entry for each lane.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field

import sympy as sp

from .laws import Names, assignments, indent


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
