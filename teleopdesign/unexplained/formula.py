"""A sparse formula for a dependence: fitted on fit records, kept if it holds on check records."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from ..base.units import unit_of
from ..diagnose.criteria import CRITERIA
from ..diagnose.evidence import gain_score
from ..diagnose.fit import standard_errors
from ..measurement.filtering import Array
from .dependence import Columns, Dependence, predict_held_out
from .library import FormulaTerm, terms_of, wave_number
from .rows import Rows, StretchSignals
from .shapes import POSITION_WAVE, TIME_WAVE, Shape, columns_from

#: symbol of each variable in a formula
SYMBOLS = {
    "position": "x",
    "speed": "|v|",
    "velocity": "v",
    "acceleration": "a",
    "actuator_force": "u",
    "load": "|u|",
    "interaction_force": "f_h",
    "time": "t",
    "since_reversal": "t_r",
    "travel": "s_r",
}
#: carrier -> text of the factor of f in a formula
FACTORS = {"friction": " sgn v", "damping": " v", "mass": " a", "lost command": " u"}
#: a formula is kept if its gain on the check rows is at least this part of that of a smooth curve
HOLDS = 0.95
#: most terms
MOST = 2


@dataclass(frozen=True)
class Formula:
    """Sum of coefficients times terms of one variable; times the carrier of the shape.

    coefficients, errors: (k,), two for a sinusoid
    share: part of the smooth curve's gain on the checked rows
    """

    shape: Shape
    terms: tuple[FormulaTerm, ...]
    coefficients: Array
    errors: Array
    share: float

    def values(self, u: Array) -> Array:
        """f at values of the variable."""
        return np.asarray(self.coefficients @ np.vstack([t.values(u) for t in self.terms]))

    def split(self) -> list[tuple[FormulaTerm, Array]]:
        """Each term with its coefficients."""
        return list(zip(self.terms, self._parts(self.coefficients), strict=True))

    def split_errors(self) -> list[Array]:
        """The standard errors of each term's coefficients."""
        return self._parts(self.errors)

    def _parts(self, values: Array) -> list[Array]:
        edges = np.cumsum([t.functions for t in self.terms])[:-1]
        return list(np.split(values, edges))


def formula_for(rows: Rows, beside: Columns, dependence: Dependence) -> Formula | None:
    """The formula with the fewest terms that explains as much as the smooth curve; None: none does.

    beside: columns of the model's parameters and of earlier dependences
    """
    variable = dependence.shape.variable
    if variable is None or variable.signed:
        return None
    terms = _terms(rows, beside, dependence)
    every = _columns(rows, dependence.shape, tuple(terms)).values[rows.learnt]
    chosen: tuple[FormulaTerm, ...] = ()
    for _ in range(MOST):
        explained = beside.beside(_columns(rows, dependence.shape, chosen)) if chosen else beside
        search = _Search.beside(rows, explained)
        ranked = search.rank(terms, every)
        # what has no number to search is simpler
        simple = [t for t in ranked if not t.is_searched]
        for term in dict.fromkeys((*simple[:1], ranked[0])):
            longer = (*chosen, _refine_number(rows, search, dependence.shape, term))
            formula = _checked_formula(rows, beside, dependence, longer)
            if formula is not None:
                return formula
        chosen = longer
    return None


def _terms(rows: Rows, beside: Columns, dependence: Dependence) -> list[FormulaTerm]:
    variable = dependence.shape.variable
    assert variable is not None
    if variable.wave:
        return [FormulaTerm("wave", float(dependence.knots[0]))]
    waving = {"position": POSITION_WAVE, "time": TIME_WAVE}.get(variable.name)
    if waving is None:
        return terms_of(variable, dependence.knots, 0.0)
    target = rows.residual * rows.root
    left = target - beside.values @ beside.solve(target, rows.learnt)
    wave = wave_number(rows, left, replace(dependence.shape, variable=waving))
    return terms_of(variable, dependence.knots, wave)


@dataclass(frozen=True)
class _Search:
    """Residual on the learning rows, orthogonal to columns with free coefficients.

    span: orthonormal columns (n, k);  left: (n,), orthogonal to them
    """

    span: Array
    left: Array

    @classmethod
    def beside(cls, rows: Rows, columns: Columns) -> _Search:
        span = np.linalg.qr(columns.values[rows.learnt])[0]
        target = (rows.residual * rows.root)[rows.learnt]
        return cls(span, target - span @ (span.T @ target))

    def gains(self, columns: Array) -> Array:
        """Squares that each column removes alone (k,)."""
        beyond_span = columns - self.span @ (self.span.T @ columns)
        size = np.sum(beyond_span**2, axis=0)
        kept = size > 1e-8 * np.sum(columns**2, axis=0)
        return np.where(kept, (beyond_span.T @ self.left) ** 2 / np.where(kept, size, 1.0), 0.0)

    def rank(self, terms: list[FormulaTerm], columns: Array) -> list[FormulaTerm]:
        """The terms in the order of the squares that they remove; a sinusoid has two columns."""
        gains, at, each = self.gains(columns), 0, []
        for term in terms:
            each.append(float(gains[at : at + term.functions].sum()))
            at += term.functions
        return [terms[i] for i in np.argsort(-np.array(each), kind="stable")]


def _columns(rows: Rows, shape: Shape, terms: tuple[FormulaTerm, ...]) -> Columns:
    variable = shape.variable
    assert variable is not None

    def functions(along: StretchSignals) -> Array:
        u = along.signals[variable.name]
        known = np.isfinite(u)
        return np.vstack([t.values(np.where(known, u, 0.0)) for t in terms]) * known

    values = columns_from(shape, rows, functions) * rows.root[:, None]
    return Columns(values, np.zeros((values.shape[1],) * 2))


def _refine_number(rows: Rows, search: _Search, shape: Shape, term: FormulaTerm) -> FormulaTerm:
    """The term with its number optimised near its value on the grid."""
    if not term.is_searched or term.kind == "wave":  # a wave number is searched already
        return term

    def lost(n: float) -> float:
        columns = _columns(rows, shape, (FormulaTerm(term.kind, n),)).values[rows.learnt]
        return -float(search.gains(columns)[0])

    wide = 0.25 * abs(term.number)
    bounds = (term.number - wide, term.number + wide)
    minimum = minimize_scalar(lost, bounds=bounds, method="bounded", options={"maxiter": 12})
    return FormulaTerm(term.kind, float(minimum.x))


def _checked_formula(
    rows: Rows, beside: Columns, dependence: Dependence, terms: tuple[FormulaTerm, ...]
) -> Formula | None:
    """The formula of these terms, if each is significant and they hold on the checked rows."""
    columns = _columns(rows, dependence.shape, terms)
    together = beside.beside(columns)
    after = predict_held_out(rows, together)
    before = float(dependence.before @ dependence.before)
    share = (before - float(after @ after)) / (before - dependence.squares)
    sure = gain_score(dependence.before, after, rows.blocks[rows.checked]) > CRITERIA.significance
    learnt, k = rows.learnt, columns.values.shape[1]
    target = rows.residual * rows.root
    value = together.solve(target, learnt)
    left = (target - together.values @ value)[learnt]
    errors = standard_errors(together.values[learnt], left, rows.blocks[learnt])[-k:]
    formula = Formula(dependence.shape, terms, value[-k:], errors, share)
    is_significant = all(
        np.hypot.reduce(c) > CRITERIA.indistinguishable * np.hypot.reduce(e)
        for (_, c), e in zip(formula.split(), formula.split_errors(), strict=True)
    )
    # a dependence that is a sinusoid is its formula
    holds = dependence.shape.is_wave or (share > HOLDS and sure and is_significant)
    return formula if holds else None


def formula_text(formula: Formula, axis: str) -> str:
    """The formula with its numbers in SI units: "F = 1.5 x v (N s/m, m)"."""
    shape = formula.shape
    assert shape.variable is not None
    u = SYMBOLS[shape.variable.name]
    parts = [_term(t, c, u) for t, c in formula.split()]
    text = parts[0] + "".join(f" - {p[1:]}" if p[0] == "-" else f" + {p}" for p in parts[1:])
    if len(parts) > 1 and shape.carrier.name in FACTORS:
        text = f"({text})"
    units = [unit_of(q, axis) for q in (shape.carrier.quantity, shape.variable.quantity)]
    units_text = ", ".join(dict.fromkeys(u.replace("*", " ") for u in units if u != "1"))
    return f"F = {text}{FACTORS.get(shape.carrier.name, '')} ({units_text})"


def _term(term: FormulaTerm, c: Array, u: str) -> str:
    n = f"{abs(term.number):.3g}"
    if term.kind == "power":
        return f"{c[0]:.3g} {u}" + ("" if term.number == 1 else f"^{term.number:g}")
    if term.kind == "decay":
        return f"{c[0]:.3g} exp(-{u} / {n})"
    if term.kind == "bell":
        return f"{c[0]:.3g} exp(-({u} / {n})^2)"
    if term.kind == "beyond":
        return f"{c[0]:.3g} ({u} - clip({u}, {n}))"
    sign = "-" if term.number > 0 else "+"
    if term.kind == "above":
        return f"{c[0]:.3g} max(0, {u} {sign} {n})"
    if term.kind == "below":
        return f"{c[0]:.3g} max(0, {term.number:.3g} - {u})"
    size, phase = math.hypot(*c), math.atan2(c[0], c[1])
    return (
        f"{size:.3g} sin(2 pi {term.number:.5g} {u} {'+' if phase >= 0 else '-'} {abs(phase):.3g})"
    )
