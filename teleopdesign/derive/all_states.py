"""All equations of a linear diagram, with every state: nothing cancels before it is counted.

    P(s, e^(-s T), v) w = 0

The unknowns w are all signals and all states of laws and effects. The coefficients are polynomials
in s, in values v that stay symbols, and in one symbol for e^(-s T) of each dead time. So each
mode occurs as often as there are states for it. A transfer function shows less: it lacks the modes
of one block that another block cancels.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import Controller, exact_decimal, make_exact, parameter_symbol
from ..diagrams import (
    Attached,
    Control,
    Diagram,
    Junction,
    Kinematics,
    Linked,
    Moving,
    position_symbol,
    with_shared_states,
)
from ..diagrams.wiring import acts_along_another
from ..effects import Effect, sort_by_action
from ..realise.lti import S
from ..realise.tips import with_tips
from .linear_rows import (
    DRIVE,
    LATE,
    MOVED,
    SPEED,
    OfLaw,
    Row,
    late_symbols,
    rows_of_effect,
    rows_of_law,
    solve,
)


@dataclass(frozen=True)
class AllStates:
    """The equations of a diagram.

    rows: one for each unknown, polynomials in `ring`: in s, the values, `GAIN`, the dead times
    times: symbol of e^(-s T) -> T: a number, or the symbol of a value
    outside: signals from outside; they occur in the rows and are no unknowns
    """

    ring: Any
    rows: tuple[Row, ...]
    times: Mapping[sp.Symbol, sp.Expr]
    outside: tuple[str, ...]
    name: str

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names of all signals and states, without those from outside."""
        names = dict.fromkeys(n for row in self.rows for n in row)
        return tuple(n for n in names if n not in self.outside)

    def determinant(self, more: Sequence[Row] = ()) -> Any:
        """Determinant with all signals from outside zero, or with further equations for them.

        more: equations of some signals from outside, which become unknowns
        returns: a polynomial; zero where the equations do not determine all signals
        """
        return solve(self.rows_between((), (), more), (), (), self.ring)[0]

    def solve(
        self, wanted: Sequence[str], given: Sequence[str], more: Sequence[Row] = ()
    ) -> tuple[Any, list[list[Any]]]:
        """(d, N) with wanted = N given/d; all other signals from outside are zero.

        given: signals or new names that `more` defines;  more: further equations
        returns: d = 0 where the equations do not determine the signals
        """
        return solve(self.rows_between(wanted, given, more), wanted, given, self.ring)

    def rows_between(
        self, wanted: Sequence[str], given: Sequence[str], more: Sequence[Row]
    ) -> list[Row]:
        """All equations without the signals from outside that are zero; arguments: as `solve`."""
        zero = set(self.outside) - {*wanted, *given, *(n for row in more for n in row)}
        return [{n: c for n, c in row.items() if n not in zero} for row in (*self.rows, *more)]


def all_states(
    diagram: Diagram,
    *,
    values: Mapping[str, sp.Symbol] | None = None,
    gains: Mapping[str, sp.Expr] | None = None,
    speed: float = 0.0,
) -> AllStates:
    """The equations of a linear diagram with values; parts without a linear form are left out.

    values: name of a value of the diagram -> the symbol that takes its place
    gains: name of a controller -> factor of its output, a number or a symbol
    speed: m/s or rad/s, at which smoothed friction and schedules are frozen
    raises ModelError: a block without values, or a value that is in no coefficient
    raises PolynomialError: a coefficient that is no ratio of polynomials
    """
    diagram = with_shared_states(with_tips(diagram))
    writer = _Writer(diagram, values or {}, gains or {}, exact_decimal(abs(speed)))
    for part in diagram.parts:
        writer.write(part)
    return writer.finish()


def is_well_posed(diagram: Diagram, states: AllStates) -> bool:
    """Whether no loop of the diagram has exactly the gain -1 at high frequency.

    Such a loop determines its signals, but at the least change of a gain it has a mode that decays
    or grows without limit. Then the determinant has a lower power of s than with other gains.

    states: of the diagram, without symbols for values
    """
    others = {c.name: 1 + sp.Rational(1, sp.prime(50 + k)) for k, c in enumerate(diagram.controls)}
    elsewhere = all_states(diagram, gains=others)
    return bool(elsewhere.determinant().degree() == states.determinant().degree())


@dataclass
class _Writer:
    """Collects equations with sympy expressions as coefficients."""

    diagram: Diagram
    values: Mapping[str, sp.Symbol]
    gains: Mapping[str, sp.Expr]
    speed: sp.Expr
    rows: list[dict[str, sp.Expr]] = field(default_factory=list)
    marks: dict[sp.Expr, sp.Symbol] = field(default_factory=dict)
    placed: set[str] = field(default_factory=set)

    def add(self, terms: Iterable[tuple[str, sp.Expr]], numbers: Mapping[Any, Any]) -> None:
        """Add an equation; numbers: symbols of the coefficients -> their exact values."""
        row: dict[str, sp.Expr] = {}
        for name, coefficient in terms:
            if coefficient != 0:
                row[name] = row.get(name, sp.S(0)) + self._place(coefficient, numbers)
        self.rows.append({n: c for n, c in row.items() if c != 0})

    def _place(self, coefficient: Any, numbers: Mapping[Any, Any]) -> sp.Expr:
        e = sp.sympify(coefficient)
        if not e.is_Rational:
            e = make_exact(e.xreplace(numbers))
        return e.replace(LATE, self._mark) if e.has(LATE) else e

    def _mark(self, time: sp.Expr) -> sp.Expr:
        if time == 0:
            return sp.S(1)
        return self.marks.setdefault(time, sp.Dummy(f"late_{len(self.marks)}"))

    def write(self, part: Any) -> None:
        """Add the equations of one part."""
        if isinstance(part, Moving):
            self._write_moving(part)
        elif isinstance(part, Attached):
            self.add([(part.force, -part.sign), *self._resistance(part)], self._numbers(part))
        elif isinstance(part, Linked):
            for i, force in enumerate(part.forces):
                columns = (j for k, j in part.entries if k == i)
                terms = [(part.motions[j], -part.sign * part.body.entry(i, j, S)) for j in columns]
                self.add([(force, sp.S(1)), *terms], {})
        elif isinstance(part, Control):
            self._write_control(part)
        else:
            shares = part.terms if isinstance(part, Junction) else _slopes(part)
            here = self.diagram.here
            self.add([(part.output, sp.S(1)), *((n, -here(w)) for n, w in shares.items())], {})

    def _numbers(self, part: Moving | Attached) -> dict[sp.Symbol, sp.Expr]:
        if not isinstance(part.body, Body):
            raise ModelError(
                f"{self.diagram.name}: {part.name} is known by its name only, no values"
            )
        parameters = part.body.parameters
        return {
            symbol: self._value(f"{part.name}.{n}", parameters[n].value)
            for n, symbol in part.body.symbols().items()
        }

    def _value(self, name: str, number: float) -> sp.Expr:
        """The symbol of a value, or its exact number."""
        if name not in self.values:
            return exact_decimal(number)
        self.placed.add(name)
        return self.values[name]

    def _resistance(self, part: Moving | Attached) -> list[tuple[str, sp.Expr]]:
        """Terms of the force that resists the motion of a body; states get their equations."""
        numbers, body = self._numbers(part), part.body
        assert isinstance(body, Body)
        terms = [(part.motion, body.symbols()["inertia"] * S**2)]
        for effect in body.effects:
            if effect.linear and effect.role != "actuation":
                terms += self._effect(part.name, effect, {MOVED: part.motion}, numbers)
        return terms

    def _effect(
        self, block: str, effect: Effect, signals: Mapping[Any, str], numbers: Mapping[Any, Any]
    ) -> list[tuple[str, sp.Expr]]:
        """Terms of the output of an effect;  signals: symbol of an input -> its name."""
        names, rates, output = rows_of_effect(effect)
        states = [f"{block}.{effect.name}.{n}" for n in names]
        inputs = [*states, *(signals.get(x, "") for x in (DRIVE, MOVED))]
        self._states(states, rates, inputs, numbers)
        return [(n, c) for n, c in zip(inputs, output, strict=True) if c != 0]

    def _states(
        self,
        states: Sequence[str],
        rates: Sequence[Sequence[sp.Expr]],
        inputs: Sequence[str],
        numbers: Mapping[Any, Any],
    ) -> None:
        for state, row in zip(states, rates, strict=True):
            self.add([(state, S), *((n, -c) for n, c in zip(inputs, row, strict=True))], numbers)

    def _write_moving(self, part: Moving) -> None:
        numbers, signal = self._numbers(part), part.command
        assert isinstance(part.body, Body)
        for effect in sort_by_action(part.body.effects, "actuation"):
            if effect.linear:
                acting = f"{part.name}.{effect.name}"
                terms = self._effect(part.name, effect, {DRIVE: signal}, numbers)
                self.add([(acting, sp.S(1)), *((n, -c) for n, c in terms)], numbers)
                signal = acting
        loads = [(n, -self.diagram.here(w)) for n, w in part.loads.items()]
        self.add([*self._resistance(part), (signal, sp.S(-1)), *loads], numbers)

    def _write_control(self, part: Control) -> None:
        law = part.controller
        if not isinstance(law, Controller):
            raise ModelError(
                f"{self.diagram.name}: {part.name} is known by its name only, no values"
            )
        factor = self.gains.get(part.name, sp.S(1))
        if not all(stage.law.linear for stage in law.stages):
            self.add([(part.output, sp.S(1))], {})
            return
        signal = part.input
        moved = part.motion if acts_along_another(self.diagram, part) else part.input
        for k, stage in enumerate(law.stages):
            is_last = k == len(law.stages) - 1
            names, rates, output = rows_of_law(OfLaw(stage.law, stage))
            numbers: dict[sp.Expr, sp.Expr] = {SPEED: self.speed}
            for n, x in stage.values.items():
                value = self._value(f"{part.name}.{stage.name}.{n}", x)
                numbers[parameter_symbol("law", f"law.{n}")] = value
            states = [f"{part.name}.{stage.name}.{n}" for n in names]
            inputs = [*states, signal, moved]
            self._states(states, rates, inputs, numbers)
            signal = part.output if is_last else f"{part.name}.{stage.name}"
            gain = factor if is_last else sp.S(1)
            terms = [(n, -gain * c) for n, c in zip(inputs, output, strict=True)]
            self.add([(signal, sp.S(1)), *terms], numbers)
        if not law.stages:
            self.add([(part.output, sp.S(1)), (part.input, -factor)], {})

    def finish(self) -> AllStates:
        """The equations as polynomials."""
        if lost := [n for n in self.values if n not in self.placed]:
            raise ModelError(f"{self.diagram.name}: {lost[0]} is in no coefficient as such")
        free = {x for gain in self.gains.values() for x in gain.free_symbols}
        times, powers = late_symbols(self.marks)
        placed = {mark: powers[time] for time, mark in self.marks.items()}
        symbols = (S, *self.values.values(), *sorted(free, key=str), *times)
        ring, *_ = sp.ring(symbols, sp.QQ)
        late = ({n: c.xreplace(placed) for n, c in row.items()} for row in self.rows)
        rows = tuple(_as_polynomials(row, ring) for row in (late if placed else self.rows))
        return AllStates(ring, rows, times, tuple(self.diagram.outside), self.diagram.name)


def _slopes(part: Kinematics) -> dict[str, sp.Expr]:
    return {n: sp.diff(part.expression, position_symbol(n)) for n in part.inputs}


def _as_polynomials(row: Mapping[str, sp.Expr], ring: Any) -> Row:
    """The equation times its common denominator, which depends on values alone."""
    if all(c.is_Rational for c in row.values()):
        return {n: ring(sp.QQ(int(c.p), int(c.q))) for n, c in row.items()}
    sides = {n: sp.fraction(sp.together(c)) for n, c in row.items()}
    below = sp.lcm_list([q for _, q in sides.values()])
    made = {n: ring.from_expr(sp.expand(p * sp.cancel(below / q))) for n, (p, q) in sides.items()}
    return {n: p for n, p in made.items() if p}
