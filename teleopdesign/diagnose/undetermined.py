"""Parameters of accepted effects that the records do not determine.

An effect may be certain although its parameters are not: a level at rest that no measured force
reached is an extrapolation, and a record may determine only the product of two parameters. The file
of an effect states the consequences of physics (`undetermined`), this file those of the records.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..base.errors import ModelError
from ..base.sentences import percent
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate, list_look_alikes
from .criteria import CRITERIA
from .evidence import whole_score
from .fit import Fit, estimate
from .identifiability import product_of
from .plausibility import implausible_effects, undetermined_of
from .rung import Rung
from .statements import Undetermined


def find_undetermined(
    rungs: Sequence[Rung], prepared: Prepared, *, estimated_on: Prepared
) -> tuple[Undetermined, ...]:
    """Parameters of the effects of a ladder that the records do not determine, by the last fit.

    prepared: the whole records;  estimated_on: their part on which the fits were made
    """
    fit, sentences = rungs[-1].fit, []
    for rung in rungs[1:]:
        added = rung.added
        assert added is not None
        if not fit.model.body(added.at).has(added.effect.name):
            continue
        by_effect = undetermined_of(added.effect, added.at, fit.model, prepared)
        statements = [
            by_effect or alike_on_records(fit, rung, estimated_on),
            known_together(fit, added),
        ]
        sentences += [Undetermined(added, one) for one in statements if one]
    return tuple(sentences)


def alike_on_records(fit: Fit, rung: Rung, prepared: Prepared) -> str:
    """A sentence where the records hardly distinguish an effect from its look-alike; else "".

    fit: of the last model;  rung: that added the effect

    For example gravity, and a spring with its rest position (`spring` and `bias`): over much of a
    turn the two differ, but where more than noise is left the records may not show the difference.
    """
    if prepared.is_linked:  # the links of an arm include gravity
        return ""
    candidate = rung.added
    assert candidate is not None
    body = fit.model.body(candidate.at)
    for other in (c.effect for c in list_look_alikes(candidate, fit.model)):
        more = len(candidate.effect.parameters) > len(other.parameters) and not body.has("bias")
        names = (other.name, *(["bias"] if more and "bias" in fit.model.known else []))
        try:
            model = fit.model.without_effect(candidate.effect.name, at=candidate.at)
            for name in names:
                start = _start_of(Candidate(fit.model.known[name], candidate.at), rung)
                model = model.with_effect(name, at=candidate.at, values=start)
        except ModelError:  # another effect needs it
            return ""
        instead = estimate(model, prepared)
        if whole_score(instead, fit) >= CRITERIA.indistinguishable:
            continue
        if (other.name, candidate.at) in implausible_effects(instead.model, prepared):
            continue
        return (
            f"these records hardly distinguish it from {' and '.join(f'`{n}`' for n in names)}, "
            f"with which {percent(instead.check_error, '.3g')} of the force would be left"
        )
    return ""


def _start_of(candidate: Candidate, rung: Rung) -> dict[str, float] | None:
    """The values that a candidate had beside the model before the rung; None: it was not fitted."""
    for one in () if rung.ranking is None else rung.ranking.ranked:
        if one.candidate.key == candidate.key:
            values = one.fit.model.parameters
            full = f"{candidate.at}.{candidate.effect.name}"
            return {n: values[f"{full}.{n}"].value for n in candidate.effect.parameters}
    return None


def known_together(fit: Fit, candidate: Candidate) -> str:
    """A sentence on a product of open parameters that the records determine; "" where none.

    Parameters that are zero, angles and those at a bound have no part in a product.
    """
    product = product_of(fit, f"{candidate.at}.{candidate.effect.name}")
    if product is None or max(product.errors) < CRITERIA.open_error:
        return ""
    # known far better than each of them: by the same part
    if product.known >= CRITERIA.open_error * min(product.errors):
        return ""
    known, each = percent(product.known, ".2g"), [percent(e, ".2g") for e in product.errors]
    return f"{product} is known within {known}, each factor only within {', '.join(each)}"


def open_parameters_line(model: Model) -> str | None:
    """A sentence where every estimated parameter of a model is open; else None."""
    estimated = [value for value in model.parameters.values() if not value.fixed]
    known = [v for v in estimated if not v.stderr >= CRITERIA.open_error * abs(v.value)]
    if not estimated or known:
        return None
    return (
        "records: no parameter of the model is determined, each standard error is more than half "
        "of its value: a small error then says nothing of the machine. Record a motion that "
        "reverses and changes its speed"
    )
