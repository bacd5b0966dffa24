"""Whether records determine what an effect adds to a model."""

from __future__ import annotations

import numpy as np

from ..model import Model
from ..quantity import unit_after_number
from ..standard_error import with_standard_error
from .candidates import Candidate
from .criteria import CRITERIA, Criteria
from .evidence import check_squares
from .fit import Fit, fit_squares
from .products import product_of


def is_identifiable(fit: Fit, base: Fit, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether the new parameters are determined and the base's parameters cannot imitate them.

    Each must be further from absence than its standard error (an angle within half a turn) unless
    the effect is there without it or a product of its parameters is known; a strength by more, what
    is essential to it surely so; and some must change the residual in a unique way. An effect
    that explains most, and of which some product is known, may have open parameters.
    """
    most = explains_most(base, fit, criteria=criteria)
    new = [i for i, n in enumerate(fit.free) if n not in base.free]
    effects = {fit.free[i].rpartition(".")[0] for i in new}
    known = {one: list_known_in_product(fit, one, criteria=criteria) for one in effects}
    for i in new:
        name = fit.free[i]
        value, declared = fit.model.parameters[name], fit.model.declared(name)
        together = known[name.rpartition(".")[0]]
        is_open = name in together or (most and together)
        if declared.optional or (is_open and not declared.search.essential):
            continue
        away = np.pi if declared.quantity == "angle" else fit.model.from_absence(name)
        if not value.stderr * _errors_from_absence(fit.model, name, criteria) < away:
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
        if float(np.linalg.norm(rest)) > criteria.least_unique_share * size:
            return True
    return False


def _errors_from_absence(model: Model, name: str, criteria: Criteria) -> float:
    """Standard errors by which a parameter must differ from the value where its effect is absent.

    One, for what is neither essential nor a strength: the effect stands on the others.
    """
    if model.declared(name).search.essential:
        return criteria.surely
    return criteria.strong if is_strength(model, name) else 1.0


def explains_most(before: Fit, after: Fit, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether an effect takes away most squares of both uses.

    Then one product of its parameters that is known is enough. Of a friction that falls with speed
    only the end may be seen: its level and where it falls run together to any size.
    """
    return all(
        squares(after) < (1.0 - criteria.mostly) * squares(before)
        for squares in (fit_squares, check_squares)
    )


def is_strength(model: Model, name: str) -> bool:
    """Whether an effect is absent where this parameter of it has a finite value, such as zero."""
    place, local_name = model.locate(name)
    effect, _, parameter = local_name.partition(".")
    absent = model.body(place).effect(effect).absent.get(parameter) if parameter else None
    return absent is not None and bool(np.isfinite(absent))


def list_known_in_product(
    fit: Fit, effect: str, *, criteria: Criteria = CRITERIA
) -> frozenset[str]:
    """Parameters of an effect that differ surely from zero, the others of a product held.

    The effect is there, though along such a valley the records leave open by which of them.
    effect: with its place, "device.stribeck"
    """
    product = product_of(fit, effect)
    if product is None:
        return frozenset()
    powers = zip(product.names, product.powers, strict=True)
    return frozenset(n for n, p in powers if criteria.close * product.known < abs(p))


def doubt(
    fit: Fit,
    candidate: Candidate,
    *,
    most: bool = False,
    criteria: Criteria = CRITERIA,
) -> str:
    """Which parameter an accepted effect stands on and the stated errors do not tell from absence.

    By the errors at the end of a ladder, which hold what the readings themselves bring in. Others
    of its parameters may be open, and so may those of which a product is known. "": none
    most: whether the effect took away most of what was left (`explains_most`)
    """
    start = f"{candidate.at}.{candidate.effect.name}"
    together = list_known_in_product(fit, start, criteria=criteria)
    for name, declared in candidate.effect.parameters.items():
        full = f"{start}.{name}"
        if full not in fit.free or declared.optional or full in together:
            continue
        if not (is_strength(fit.model, full) or declared.search.essential):
            continue
        value = fit.model.parameters[full]
        if most and together and not declared.search.essential:
            continue
        if not criteria.strong * value.stderr < fit.model.from_absence(full):
            unit = unit_after_number(fit.model.unit(full))
            best = with_standard_error(value.value, value.stderr)
            return f"{name} = {best}{unit}: within the sensor errors the effect may be absent"
    return ""
