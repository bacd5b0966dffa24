"""Whether records determine the parameters that an effect adds to a model.

For a width, such as that of a backlash, a standard error does not tell it: the moments at which a
tip crosses its gap depend on the whole motion before, so the sum of squares has several minima over
the width. There the parameter is fixed at other values, and the other parameters are fitted again.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..base.sentences import with_standard_error
from ..base.units import unit_after_number
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate
from .criteria import CRITERIA
from .evidence import check_squares, whole_score
from .fit import Fit, estimate, fit_squares
from .products import product_of
from .search_plan import EFFORTS


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


@dataclass(frozen=True)
class OpenWidths:
    """The sentences of `explain_open_width` on the fits of one ranking; each is computed once."""

    prepared: Prepared
    #: by the fit's identity, which holds while the fit stands beside it
    known: dict[int, tuple[Fit, str]] = field(default_factory=dict)

    def explain(self, fit: Fit, candidate: Candidate) -> str:
        """The sentence on a fit; "" where the records determine its essential parameters."""
        if not any(p.search.essential for p in candidate.effect.parameters.values()):
            return ""
        if id(fit) not in self.known:
            sentence = explain_open_width(fit, candidate, self.prepared)
            self.known[id(fit)] = (fit, sentence)
        return self.known[id(fit)][1]
