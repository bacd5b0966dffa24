"""Transfer functions and impedances from the wiring, symbolic; blocks need not commute.

Every block acts from the left on its signal. Signals are eliminated one by one in a fixed order; an
inverse appears only where a signal stands on both sides of its equation.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from time import monotonic
from types import MappingProxyType

import sympy as sp

from ..diagrams import Attached, Control, Diagram, Moving
from ..diagrams.wiring import Part
from ..errors import ModelError
from .noncommutative import counterexample
from .printing import as_latex, as_text, block_symbol, with_gamma

#: signal -> coefficient, acting from the left; the sum over all is zero
Row = dict[str, sp.Expr]
_OUTPUT = "output asked for"


def rows(diagram: Diagram) -> list[Row]:
    """One equation (sum = 0) for each block and junction."""
    found: list[Row] = []
    for part in diagram.parts:
        if isinstance(part, Moving):
            command = -block_symbol(f"A_{part.name}") if has_actuation(part) else sp.S(-1)
            terms = [(part.motion, block_symbol(part.name)), (part.command, command)]
            terms += [(s, sp.S(-sign)) for s, sign in part.loads.items()]
        elif isinstance(part, Attached):
            terms = [(part.force, sp.S(1)), (part.motion, -part.sign * block_symbol(part.name))]
        elif isinstance(part, Control):
            terms = [(part.output, sp.S(1)), (part.input, -block_symbol(part.name))]
        else:
            terms = [(part.output, sp.S(1)), *((s, sp.S(-g)) for s, g in part.terms.items())]
        found.append(_row(terms))
    return found


def _row(terms: list[tuple[str, sp.Expr]]) -> Row:
    """Terms by their signal: a part may take the signal that it makes."""
    row: Row = {}
    for signal, coefficient in terms:
        row[signal] = row.get(signal, sp.S(0)) + coefficient
    return {signal: c for signal, c in row.items() if c != 0}


def has_actuation(part: Moving) -> bool:
    """Whether effects stand between the command and the force that acts on this body."""
    return any(e.role == "actuation" for e in getattr(part.body, "effects", ()))


def transfer(
    diagram: Diagram,
    output: str,
    inputs: tuple[str, ...] | None = None,
    *,
    given: str = "",
    seconds: float = math.inf,
) -> dict[str, sp.Expr]:
    """Coefficients of `output` = sum of coefficient * input.

    inputs: signals from outside (default: all); those left out are zero
    given: a motion that is prescribed, in place of the outside force that drives it
    seconds: after which it is given up
    raises ModelError: unknown signal, a loop without a solution, or more seconds than given
    """
    until = monotonic() + seconds
    diagram.signal(output)
    free = dict.fromkeys(diagram.outside)
    if given:
        free[given] = None
        free.pop(_driver(diagram, given), None)
    for name in inputs or ():
        diagram.signal(name)
        if name not in free:
            raise ModelError(f'{diagram.name}: signal "{name}" is not from outside')
    chosen = tuple(free) if inputs is None else inputs
    # a name of its own for the output, so that what is inverted is an impedance, as in the papers
    system = [*rows(diagram), {_OUTPUT: sp.S(1), output: sp.S(-1)}]
    unknown = [s for s in diagram.signals if s not in free]
    for signal in _order(unknown, output, diagram):
        if monotonic() > until:
            raise ModelError(f'{diagram.name}: "{output}" was not derived within {seconds:g} s')
        _eliminate(system, signal, diagram)
    row = next(r for r in system if _OUTPUT in r)
    return {s: _product(sp.S(-1), row.get(s, sp.S(0))) for s in chosen}


def _driver(diagram: Diagram, motion: str) -> str:
    for block in diagram.blocks:
        if isinstance(block, Moving) and block.motion == motion:
            return block.driver
    raise ModelError(f'{diagram.name}: "{motion}" is no motion of a body that forces move')


def _order(unknown: list[str], output: str, diagram: Diagram) -> list[str]:
    """Forces first, then the output, motions last."""
    motions = [b.motion for b in diagram.blocks if isinstance(b, Moving)]
    forces = [s for s in unknown if s not in motions]
    forces.sort(key=lambda s: s == output)
    return [*forces, *(m for m in motions if m in unknown)]


def _eliminate(system: list[Row], signal: str, diagram: Diagram) -> None:
    having = [r for r in system if signal in r]
    able = [r for r in having if _OUTPUT not in r and not _vanishes(r[signal])]
    if not able:
        raise ModelError(_undetermined(diagram, signal))
    plain = [r for r in able if r[signal] in (sp.S(1), sp.S(-1))]
    own = [r for r in plain if next(iter(r)) == signal]  # the equation that makes the signal
    pivot = (own or plain or able)[0]
    system[:] = [r for r in system if r is not pivot]
    sign = sp.S(-1 if _mostly_negative(pivot[signal]) else 1)
    inverse = sp.Pow(_product(sign, pivot[signal]), -1)
    value = {s: _product(inverse, _product(-sign, c)) for s, c in pivot.items() if s != signal}
    for row in (r for r in having if r is not pivot):
        factor = row.pop(signal)
        for s, c in value.items():
            total = row.get(s, sp.S(0)) + _product(factor, c)
            if total == 0:
                row.pop(s, None)
            else:
                row[s] = total


def _vanishes(coefficient: sp.Expr) -> bool:
    """Whether a sum with inverses in it is zero, as seen exactly on random rational matrices."""
    if not (coefficient.is_Add and any(p.exp < 0 for p in coefficient.atoms(sp.Pow))):
        return False
    return counterexample(coefficient, sp.S(0), tries=1) is None


def _undetermined(diagram: Diagram, signal: str) -> str:
    loop = loop_of(diagram, signal)
    if not loop:
        return f'{diagram.name}: the wiring does not determine "{signal}"'
    return f"{diagram.name}: the loop {' -> '.join((*loop, loop[0]))} has no solution"


def loop_of(diagram: Diagram, signal: str) -> tuple[str, ...]:
    """The shortest loop through a signal, of junctions alone where there is one; () if none."""
    for parts in (diagram.junctions, diagram.parts):
        makers = {s: part for part in parts for s in part.outputs}
        before: dict[str, str] = {}
        reached = [signal]
        for at in reached:
            part = makers.get(at)
            for taken in () if part is None else _taken(part):
                if taken == signal:
                    return _back(before, at, signal)
                if taken not in before:
                    before[taken] = at
                    reached.append(taken)
    return ()


def _taken(part: Part) -> tuple[str, ...]:
    # of a controller the motion only sets where its law is frozen
    return (part.input,) if isinstance(part, Control) else part.inputs


def _back(before: Mapping[str, str], at: str, signal: str) -> tuple[str, ...]:
    """From the signal along the search, which ran against the wires, so in their order."""
    way = [at]
    while way[-1] != signal:
        way.append(before[way[-1]])
    return (signal, *way[:-1])


def _mostly_negative(expression: sp.Expr) -> bool:
    terms = sp.Add.make_args(expression)
    return 2 * sum(bool(t.as_coeff_Mul()[0] < 0) for t in terms) > len(terms)


def _product(left: sp.Expr, right: sp.Expr) -> sp.Expr:
    # a plain number is carried into a sum, so that like terms meet
    if right.is_Add and left.is_Number:
        return sp.Add(*(left * a for a in right.args))
    if left.is_Add and right.is_Number:
        return sp.Add(*(a * right for a in left.args))
    return left * right


@dataclass(frozen=True)
class TransferFunctions:
    """Symbolic transfer functions by name; `Gamma` stands for I + H where the diagram has H."""

    diagram: Diagram
    expressions: Mapping[str, sp.Expr]
    texts: Mapping[str, str]

    def __getitem__(self, name: str) -> sp.Expr:
        if name not in self.expressions:
            raise ModelError(f'transfer functions: no "{name}", have {", ".join(self.expressions)}')
        return self.expressions[name]

    def text(self) -> str:
        """One line for each: name = expression."""
        return "\n".join(f"{n} = {as_text(e)}    ({self.texts[n]})" for n, e in self._short())

    def latex(self) -> str:
        """An align environment's body, one line for each."""
        return " \\\\\n".join(f"{_LATEX.get(n, n)} &= {as_latex(e)}" for n, e in self._short())

    def _short(self) -> list[tuple[str, sp.Expr]]:
        return [(n, with_gamma(e)) for n, e in self.expressions.items()]

    def __repr__(self) -> str:
        return self.text()

    def _repr_latex_(self) -> str:
        return f"$$\\begin{{aligned}}{self.latex()}\\end{{aligned}}$$"


_LATEX = {
    "T_o": "T_o",
    "T_MBC": r"T_{\mathrm{MBC}}",
    "T_FF": r"T_{\mathrm{FF}}",
    "T_H": "T_H",
    "Zhat_M": r"\hat Z_M",
    "L/L_D": "L/L_D",
    "L/R_V": "L/R_V",
}


def transfer_functions(diagram: Diagram) -> TransferFunctions:
    """T_o, T_MBC, T_FF, T_H (R_D to R_M at R_V = 0) and Zhat_M = (R_D - R_M)/L; L with a loop K.

    Those for which the diagram has the blocks; each is derived from the diagram without the others.
    Bernstein, Lawrence, Pao, World Haptics 2005, eqs (2) to (5) and (7), figure 4.
    """
    cases = named_cases(diagram)
    found = {name: case.derived() for name, case in cases.items()}
    texts = {name: case.text for name, case in cases.items()}
    return TransferFunctions(diagram, MappingProxyType(found), MappingProxyType(texts))


@dataclass(frozen=True)
class Case:
    """What a transfer function is of: from `input` to `output` of a diagram, all else zero.

    given: a motion that is prescribed, as in `transfer`;  text: for a reader
    """

    diagram: Diagram
    output: str
    input: str
    given: str
    text: str

    def derived(self, *, seconds: float = math.inf) -> sp.Expr:
        """The expression in the blocks; arguments and errors as of `transfer`."""
        own = transfer(self.diagram, self.output, (self.input,), given=self.given, seconds=seconds)
        return own[self.input]


def named_cases(diagram: Diagram) -> dict[str, Case]:
    """The transfer functions of a haptic interface that have a name, see `transfer_functions`."""
    force = diagram.opened("K")
    found: dict[str, Case] = {}
    if diagram.has("Z_H"):
        cases = {"T_o": ("C", "H"), "T_MBC": ("H",), "T_FF": ("C",), "T_H": ()}
        for name, gone in cases.items():
            if all(diagram.has(b) for b in {"C", "H"} - set(gone)):
                found[name] = Case(force.without(*gone), "R_M", "R_D", "", _TEXTS[name])
    found["Zhat_M"] = Case(force, "E", "L", "L", _TEXTS["Zhat_M"])
    if diagram.has("K"):
        for signal in ("L_D", "R_V"):
            found[f"L/{signal}"] = Case(diagram, "L", signal, "", "position loop closed")
    return found


_TEXTS = {
    "T_o": "R_D to R_M, uncompensated",
    "T_MBC": "R_D to R_M, motion-based cancellation",
    "T_FF": "R_D to R_M, force feedback",
    "T_H": "R_D to R_M, hybrid",
    "Zhat_M": "L to R_D - R_M: apparent mechanism impedance",
}


def return_difference(diagram: Diagram, name: str) -> sp.Expr:
    """1 - loop gain at the output of controller `name`: what must keep the loop stable."""
    block = diagram.block(name)
    if not isinstance(block, Control):
        raise ModelError(f"{diagram.name}: {name} is no controller, its loop cannot be opened")
    back = transfer(diagram.opened(name), block.input, (block.output,))[block.output]
    return sp.S(1) - _product(block_symbol(name), back)
