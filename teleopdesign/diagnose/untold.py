"""Parameters of accepted effects that the records do not determine.

An effect may be certain although its parameters are not: a level at rest that no measured force
reached is an extrapolation, and a record may determine only the product of two parameters. The
file of an effect states what follows from physics (`untold`); this file states what follows from
the records.
"""

from __future__ import annotations

from collections.abc import Sequence

from .candidates import Candidate
from .diagnosis import Untold
from .fit import Fit
from .plausibility import untold_of
from .prepare import Prepared
from .products import product_of
from .rung import Rung

#: standard error over value from which a parameter counts as open: twice as large or nothing lie
#: within two standard errors
OPEN = 0.5
#: part of the least relative error of the open parameters below which a product of them is known
#: far better than any of them
PRODUCT = 0.5


def untold(rungs: Sequence[Rung], prepared: Prepared) -> tuple[Untold, ...]:
    """Parameters of the effects of a ladder that the records do not determine, by the last fit."""
    fit, sentences = rungs[-1].fit, []
    for rung in rungs[1:]:
        added = rung.added
        assert added is not None
        if not fit.model.body(added.at).has(added.effect.name):
            continue
        by_effect = untold_of(added.effect, added.at, fit.model, prepared)
        said = [by_effect or "", known_together(fit, added)]
        sentences += [Untold(added, one) for one in said if one]
    return tuple(sentences)


def known_together(fit: Fit, candidate: Candidate) -> str:
    """A sentence on a product of open parameters that the records determine; "" where none.

    Parameters that are zero, angles and those at a bound have no part in a product.
    """
    product = product_of(fit, f"{candidate.at}.{candidate.effect.name}")
    if product is None or max(product.errors) < OPEN:
        return ""
    if product.known >= PRODUCT * min(product.errors):
        return ""
    each = ", ".join(f"{100 * error:.2g} %" for error in product.errors)
    return f"{product} is known within {100 * product.known:.2g} %, each factor only within {each}"
