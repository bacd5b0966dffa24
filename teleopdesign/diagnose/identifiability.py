"""Whether records determine the parameters that an effect adds to a model.

For a width, such as that of a backlash, a standard error does not tell it: the moments at which a
tip crosses its gap depend on the whole motion before, so the sum of squares has several minima over
the width. There the parameter is fixed at other values, and the other parameters are fitted again.

Records may determine a product of parameters although no single factor: a friction level and the
speed below which it acts, or a spring and the mass on it. Along a valley of nearly equal squares
each parameter changes much, but a product of their powers hardly changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.sentences import with_standard_error
from ..base.units import unit_after_number
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate
from .criteria import CRITERIA
from .evidence import check_squares, whole_score
from .fit import Fit, estimate, fit_squares
from .search_plan import EFFORTS

#: a parameter with a smaller power (absolute value) in a product is left out of the product
POWER = 0.1


@dataclass(frozen=True, eq=False)
class Product:
    """The best determined product of powers of an effect's open parameters.

    names: full names of the parameters;  powers: the largest is 1
    errors: relative standard error of each parameter alone
    known: relative standard error of the product
    """

    names: tuple[str, ...]
    powers: tuple[float, ...]
    errors: tuple[float, ...]
    known: float

    def __str__(self) -> str:
        short = (n.rpartition(".")[2] for n in self.names)
        parts = (_power(n, p) for n, p in zip(short, self.powers, strict=True))
        return " * ".join(parts)


def product_of(fit: Fit, effect: str) -> Product | None:
    """The product of an effect's parameters with the least error; None: fewer than two take part.

    There is none either where a change of one parameter is the same as a change of others: then the
    error of each alone is that of a sum, and tells nothing of their product.

    Parameters that are zero, at a bound or without standard error, and angles, have no part in a
    product.

    effect: with its place, "device.stribeck"
    """
    start, model = f"{effect}.", fit.model
    names = [
        n
        for n in fit.free
        if n.startswith(start)
        and n not in fit.at_bound
        and model.declared(n).quantity != "angle"
        and model.parameters[n].value != 0.0
        and np.isfinite(model.parameters[n].stderr)
    ]
    if len(names) < 2:
        return None
    values = np.array([abs(model.parameters[n].value) for n in names])
    errors = np.array([model.parameters[n].stderr for n in names]) / values
    columns = _relative_columns(fit, names, values)
    if are_dependent(columns):
        return None
    powers, known = best_product(columns, errors)
    counting = [i for i, p in enumerate(powers) if abs(p) >= POWER]
    if len(counting) < 2:
        return None
    return Product(
        tuple(names[i] for i in counting),
        tuple(float(powers[i]) for i in counting),
        tuple(float(errors[i]) for i in counting),
        known,
    )


def are_dependent(columns: Array) -> bool:
    """Whether columns (rows, k) are linearly dependent, whatever their lengths; zero ones are.

    A part of one that lies outside of the others, and is lost in the squares, counts as nothing:
    `best_product` works with squares.
    """
    lengths = np.linalg.norm(columns, axis=0)
    if not lengths.all():
        return True
    return bool(np.linalg.matrix_rank(columns / lengths, rtol=1e-6) < len(lengths))


def best_product(columns: Array, errors: Array) -> tuple[Array, float]:
    """Powers (k,), the largest 1, of the best determined product, and its relative standard error.

    columns: (rows, k) derivatives of the residual by relative changes, without the span of the
        other parameters
    errors: (k,) relative standard error of each parameter alone
    """
    shares = np.linalg.pinv(columns.T @ columns, rcond=1e-12, hermitian=True)
    spread = np.sqrt(np.maximum(np.diag(shares), 1e-300))
    covariance = shares / np.outer(spread, spread) * np.outer(errors, errors)
    _, vectors = np.linalg.eigh(covariance)
    powers = vectors[:, 0]
    powers = powers / powers[np.argmax(np.abs(powers))]
    return powers, float(np.sqrt(max(powers @ covariance @ powers, 0.0)))


def _relative_columns(fit: Fit, names: Sequence[str], values: Array) -> Array:
    """Derivatives (rows, k) by relative changes, less their projection on the other parameters."""
    ours = [fit.free.index(n) for n in names]
    rest = [i for i in range(len(fit.free)) if i not in ours]
    columns = fit.jacobian[:, ours] / fit.scale[ours] * values
    others = fit.jacobian[:, rest]
    if not rest:
        return columns
    return columns - others @ np.linalg.lstsq(others, columns, rcond=1e-10)[0]


def _power(name: str, power: float) -> str:
    return name if f"{power:.1f}" == "1.0" else f"{name}^{power:.1f}"


def is_identifiable(fit: Fit, base: Fit) -> bool:
    """Whether the new parameters are determined and the base's parameters cannot imitate them.

    Each new parameter must differ from its value of absence by more than its standard error (an
    angle must be known within half a turn); a strength by more, an essential parameter by most.
    Exempt are optional parameters, and those that are not essential in a product that is known.
    An effect that explains most, and of which some product is known, may have further open
    parameters.
    At least one new parameter must change the residual in a way that the base's parameters cannot.
    """
    most = explains_most(base, fit)
    new = [i for i, n in enumerate(fit.free) if n not in base.free]
    effects = {fit.free[i].rpartition(".")[0] for i in new}
    known = {one: list_known_in_product(fit, one) for one in effects}
    for i in new:
        name = fit.free[i]
        value, declared = fit.model.parameters[name], fit.model.declared(name)
        together = known[name.rpartition(".")[0]]
        is_open = name in together or (most and together)
        if declared.optional or (is_open and not declared.search.essential):
            continue
        away = np.pi if declared.quantity == "angle" else fit.model.from_absence(name)
        if not value.stderr * _errors_from_absence(fit.model, name) < away:
            return False
    old = [i for i, n in enumerate(fit.free) if n in base.free]
    for i in new:
        column = fit.jacobian[:, i]
        size = float(np.linalg.norm(column))
        if size == 0.0:
            continue
        if not old:
            return True
        old_columns = fit.jacobian[:, old]
        rest = column - old_columns @ np.linalg.lstsq(old_columns, column, rcond=1e-10)[0]
        if float(np.linalg.norm(rest)) > CRITERIA.least_unique_share * size:
            return True
    return False


def _errors_from_absence(model: Model, name: str) -> float:
    """Standard errors by which a parameter must differ from the value where its effect is absent.

    One where the parameter is neither essential nor a strength: other parameters show the effect.
    """
    if model.declared(name).search.essential:
        return CRITERIA.significance
    return CRITERIA.interval if is_strength(model, name) else 1.0


def explains_most(before: Fit, after: Fit) -> bool:
    """Whether an effect removes most of the squares, on the fit records and on the check records.

    Then one known product of its parameters is enough. For example, records may show only the end
    of a friction that falls with speed: then its level and its characteristic speed can grow
    together without limit.
    """
    return all(
        squares(after) < (1.0 - CRITERIA.mostly) * squares(before)
        for squares in (fit_squares, check_squares)
    )


def is_strength(model: Model, name: str) -> bool:
    """Whether an effect is absent at a finite value of this parameter, such as zero."""
    place, local_name = model.locate(name)
    effect, _, parameter = local_name.partition(".")
    absent = model.body(place).effect(effect).absent.get(parameter) if parameter else None
    return absent is not None and bool(np.isfinite(absent))


def list_known_in_product(fit: Fit, effect: str) -> frozenset[str]:
    """Parameters of an effect that surely differ from zero while the others of a product are held.

    The effect is then present, although the records leave open by which of these parameters.

    effect: with its place, "device.stribeck"
    """
    product = product_of(fit, effect)
    if product is None:
        return frozenset()
    powers = zip(product.names, product.powers, strict=True)
    return frozenset(n for n, p in powers if CRITERIA.indistinguishable * product.known < abs(p))


def doubt(fit: Fit, candidate: Candidate, *, most: Fit | None = None) -> str:
    """Which essential parameter or strength of an accepted effect may be that of absence, in words.

    The standard errors are those at the end of a ladder, with the errors of the readings. Other
    parameters may be open, and so may parameters of a known product.

    most: where the effect removed most of the squares (`explains_most`), the fit before its
        standard errors included those of the readings: the effect is there, and simulated readings
        speak of its values only
    returns: "" where there is no such parameter
    """
    start = f"{candidate.at}.{candidate.effect.name}"
    together = list_known_in_product(fit, start)
    is_there = most is not None and bool(list_known_in_product(most, start))
    for name, declared in candidate.effect.parameters.items():
        full = f"{start}.{name}"
        if full not in fit.free or declared.optional or full in together:
            continue
        if not (is_strength(fit.model, full) or declared.search.essential):
            continue
        value = fit.model.parameters[full]
        if is_there and not declared.search.essential:
            continue
        if not CRITERIA.interval * value.stderr < fit.model.from_absence(full):
            unit = unit_after_number(fit.model.unit(full))
            best = with_standard_error(value.value, value.stderr)
            return f"{name} = {best}{unit}: within the sensor errors the effect may be absent"
    return ""


def explain_open_width(fit: Fit, candidate: Candidate, prepared: Prepared) -> str:
    """A sentence on another value of an essential parameter that fits as well; "": none does.

    The parameter is held at a part and at a multiple of its value, by `Criteria.significance`:
    where the squares are a parabola, a quarter of what differs from zero by four standard errors
    is three off. The other parameters are fitted again from their values.
    """
    for name, declared in candidate.effect.parameters.items():
        full = f"{candidate.at}.{candidate.effect.name}.{name}"
        if not declared.search.essential or full not in fit.free:
            continue
        best = fit.model.parameters[full]
        for other in (best.value / CRITERIA.significance, best.value * CRITERIA.significance):
            if not declared.lower <= other <= declared.upper:
                continue
            held = fit.model.with_values({full: replace(best, value=other, fixed=True)})
            again = estimate(held, prepared, effort=EFFORTS.rough)
            if whole_score(again, fit) < CRITERIA.indistinguishable:
                unit = unit_after_number(fit.model.unit(full))
                return (
                    f"{name} = {other:.3g}{unit} fits as well as {best.value:.3g}{unit}: these "
                    "records do not determine it"
                )
    return ""
