"""All equations of a linear diagram as polynomials in s, without cancellation.

A control law contributes the equations of its states, an effect its numerator and denominator. So
each mode appears as often as there are states for it. A transfer function shows less: it lacks the
modes of one block that another block cancels.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

import sympy as sp

from ...blocks import Body
from ...controllers import (
    Controller,
    Stage,
    exact_decimal,
    make_exact,
    parameter_symbol,
    resolvent,
)
from ...derive.polynomials import fraction
from ...diagrams import (
    Attached,
    Control,
    Diagram,
    Junction,
    Kinematics,
    Linked,
    Moving,
    position_symbol,
)
from ...effects import Effect
from ...realise.lti import S

#: an equation: unknown -> its polynomial in `S`; the sum of polynomial times unknown is zero
Equation = dict[str, sp.Poly]
_ONE = sp.Poly(1, S, domain="QQ")
#: input of a control law, and the motion along which its force acts
_DRIVE, _MOVED = sp.Symbol("drive"), sp.Symbol("moved")


def polynomial_in_s(expression: sp.Expr | int) -> sp.Poly:
    """The expression as a polynomial in `S` with exact numbers.

    raises PolynomialError: the expression is no polynomial in `S`
    """
    return sp.Poly(make_exact(sp.sympify(expression)), S, domain="QQ")


def ratio(form: sp.Expr) -> tuple[sp.Poly, sp.Poly]:
    """Numerator and denominator of a rational form in `S`, coprime."""
    above, below = sp.fraction(sp.cancel(make_exact(sp.sympify(form))))
    return polynomial_in_s(above), polynomial_in_s(below)


def stage_rows(
    stage: Stage, symbols: Mapping[str, sp.Symbol] | None = None
) -> tuple[list[list[sp.Expr]], list[sp.Expr]]:
    """Equations of a control law in continuous time at speed 0, in exact numbers.

    symbols: parameters that remain symbols
    returns: for the rate of each state a row of coefficients of the states, the input and the
        motion, (n, n + 2); and one such row for the output. `S` enters through velocities only
    """
    if stage.law.dead_time:  # one of no time: another is no ratio of polynomials
        return [], [sp.S(1), sp.S(0)]
    alone, known = Controller((stage,)), symbols or {}
    velocity = S * _MOVED
    signals = {"input": _DRIVE, "velocity": velocity, "speed": sp.S(0), "travel_rate": velocity}
    made = alone.equation("law", {**signals, "period": sp.S(0)})
    numbers = {
        parameter_symbol("law", n): known.get(n, exact_decimal(x)) for n, x in alone.names().items()
    }
    unknown = [*made.rates, _DRIVE, _MOVED]

    def row(expression: sp.Expr) -> list[sp.Expr]:
        placed = make_exact(sp.sympify(expression).subs(numbers))
        return [sp.diff(placed, x) for x in unknown]

    return [row(rate) for rate in made.rates.values()], row(made.output)


def stage_denominator(stage: Stage) -> sp.Poly:
    """det(s I - A) of a law: a root for each state, also where the output hides the state."""
    rates, _ = stage_rows(stage)
    n = len(rates)
    a = [[fraction(sp.Rational(x)) for x in row[:n]] for row in rates]
    nothing = [Fraction(0)] * n
    below, _ = resolvent(a, nothing, nothing)
    return sp.Poly([sp.Rational(c) for c in below], S, domain="QQ")


def effect_forms(part: object) -> tuple[list[sp.Expr], list[sp.Expr]]:
    """Linear forms of a body's effects: impedances (N/m), and stages of the actuation."""
    body = getattr(part, "body", None)
    if not isinstance(body, Body):
        return [], []
    numbers = {s: exact_decimal(x) for s, x in body.numbers().items()}

    def of(effects: Iterable[Effect]) -> list[sp.Expr]:
        forms = (e.linear_form(S) for e in effects)
        return [make_exact(sp.sympify(f).subs(numbers)) for f in forms if f is not None]

    acting = [e for e in body.effects if e.role == "actuation"]
    return of(e for e in body.effects if e not in acting), of(acting)


def effect_modes(
    body: object, numbers: Mapping[sp.Symbol, sp.Expr] | None = None
) -> tuple[sp.Expr, sp.Expr]:
    """det(s I - A) of all linear effects of a body, and of the stages of its actuation.

    Each has a root for each state, also where no force shows the state.
    numbers: values of the parameters; default: those of the body
    """
    if not isinstance(body, Body):
        return sp.S(1), sp.S(1)
    numbers = numbers or {s: exact_decimal(x) for s, x in body.numbers().items()}
    products = {True: sp.S(1), False: sp.S(1)}
    for effect in body.effects:
        if not effect.states or effect.linear_form(S) is None:
            continue
        states = effect.state_symbols()
        rates = effect.rates()
        a = sp.Matrix([[sp.diff(rates[n], x) for x in states.values()] for n in states])
        whole = (S * sp.eye(len(states)) - a).det(method="berkowitz")
        products[effect.role == "actuation"] *= make_exact(whole.subs(numbers))
    return sp.expand(products[False]), sp.expand(products[True])


def unshown_by_effects(diagram: Diagram) -> sp.Poly:
    """Modes of effects that the force of the effect does not show: a polynomial in `S`."""
    whole, shown = _ONE, _ONE
    for part in diagram.blocks:
        if isinstance(part, Moving | Attached):
            for modes in effect_modes(part.body):
                whole *= polynomial_in_s(modes)
            for form in (form for forms in effect_forms(part) for form in forms):
                shown *= ratio(form)[1]
    return whole.quo(shown)


def denominators(diagram: Diagram) -> sp.Poly:
    """Product of the denominators of all laws and effects, each as often as it occurs."""
    product = _ONE
    for part in diagram.blocks:
        if isinstance(part, Control):
            for stage in stages_of(part):
                product *= stage_denominator(stage)
        elif not isinstance(part, Linked):
            for form in (form for forms in effect_forms(part) for form in forms):
                product *= ratio(form)[1]
    return product


def stages_of(part: Control) -> Sequence[Stage]:
    """The laws of a controller in series; the controller is known, with values."""
    assert isinstance(part.controller, Controller)
    return part.controller.stages


class _Writer:
    """Collects equations, and makes names for the inner states of blocks."""

    def __init__(self) -> None:
        self.equations: list[Equation] = []

    def add(self, *terms: tuple[str, sp.Poly]) -> None:
        equation: Equation = {}
        for name, factor in terms:
            equation[name] = equation.get(name, sp.Poly(0, S, domain="QQ")) + factor
        self.equations.append(equation)

    def through(self, form: sp.Expr, signal: str) -> tuple[str, sp.Poly]:
        """A signal passed through the ratio p/q: (w, p), with a new state w and q w = signal."""
        above, below = ratio(form)
        if below == _ONE:
            return signal, above
        inside = f"state {len(self.equations)}"
        self.add((inside, below), (signal, -_ONE))
        return inside, above


def equations_in_full(diagram: Diagram, *, standing: bool = False) -> list[Equation]:
    """Equations of all signals and states of a linear diagram, with all outside signals zero.

    diagram: with values, linear, without dead times; a body with a structure is two bodies
    standing: leave out the equations of bodies that forces move
    raises PolynomialError: a form that is no ratio of polynomials
    """
    writer = _Writer()
    for part in diagram.parts:
        if isinstance(part, Moving) and standing:
            continue
        if isinstance(part, Moving):
            forces, acting = effect_forms(part)
            signal, factor = part.command, _ONE
            for form in acting:
                if factor != _ONE:
                    name = f"state {len(writer.equations)}"
                    writer.add((name, _ONE), (signal, -factor))
                    signal = name
                signal, factor = writer.through(form, signal)
            loads = [(s, -polynomial_in_s(sp.sympify(w))) for s, w in part.loads.items()]
            resistance = _impedance(writer, part, forces)
            writer.add(*resistance, (signal, -factor), *loads)
        elif isinstance(part, Attached):
            resistance = _impedance(writer, part, effect_forms(part)[0])
            writer.add((part.force, _ONE), *((n, -part.sign * p) for n, p in resistance))
        elif isinstance(part, Linked):
            for i, force in enumerate(part.forces):
                terms = [
                    (part.motions[j], -part.sign * polynomial_in_s(part.body.entry(i, j, S)))
                    for row, j in part.entries
                    if row == i
                ]
                writer.add((force, _ONE), *terms)
        elif isinstance(part, Control):
            _write_controller(writer, part)
        else:
            shares = part.terms if isinstance(part, Junction) else _slopes(part)
            weights = ((s, -polynomial_in_s(sp.sympify(w))) for s, w in shares.items())
            writer.add((part.output, _ONE), *weights)
    outside = set(diagram.outside)
    return [{n: p for n, p in row.items() if n not in outside} for row in writer.equations]


def _slopes(part: Kinematics) -> dict[str, sp.Expr]:
    return {n: sp.diff(part.expression, position_symbol(n)) for n in part.inputs}


def equations_of(part: Control) -> list[Equation]:
    """Equations of a controller alone; its input and its motion are among the unknowns."""
    writer = _Writer()
    _write_controller(writer, part)
    return writer.equations


def _impedance(
    writer: _Writer, part: Moving | Attached, forms: Sequence[sp.Expr]
) -> list[tuple[str, sp.Poly]]:
    body = part.body
    assert isinstance(body, Body)
    inertia = sp.Poly(exact_decimal(body.parameters["inertia"].value) * S**2, S, domain="QQ")
    return [(part.motion, inertia), *(writer.through(form, part.motion) for form in forms)]


def _write_controller(writer: _Writer, part: Control) -> None:
    """Add the equations of the states and the output of each law of a controller."""
    signal, last = part.input, len(stages_of(part)) - 1
    moved = part.motion or part.input
    for k, stage in enumerate(stages_of(part)):
        rates, output = stage_rows(stage)
        names = [f"{part.name} state {k} {i}" for i in range(len(rates))]
        inputs = [*names, signal, moved]
        for name, row in zip(names, rates, strict=True):
            terms = zip(inputs, (-polynomial_in_s(x) for x in row), strict=True)
            writer.add((name, polynomial_in_s(S)), *terms)
        signal = part.output if k == last else f"{part.name} output {k}"
        terms = zip(inputs, (-polynomial_in_s(x) for x in output), strict=True)
        writer.add((signal, _ONE), *terms)
