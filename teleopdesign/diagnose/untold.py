"""What records cannot tell of the parameters of accepted effects, though the effects stand.

An effect may be there beyond doubt while its parameters are not: a level at rest that no force ever
reached is an extrapolation, and of two parameters a record may show one product. What follows from
physics an effect's own file says (`untold`); what follows from the records is seen here.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..measurement.filtering import Array
from .candidates import Candidate
from .diagnosis import Untold
from .fit import Fit
from .plausibility import untold_of
from .prepare import Prepared
from .rung import Rung

#: standard error over value from which a parameter counts as open: twice as large or nothing lie
#: within two standard errors
OPEN = 0.5
#: part of the least relative error of the open parameters below which a product of them is known
#: far better than any of them
PRODUCT = 0.5
#: powers of a product below which a parameter hardly counts in it
POWER = 0.1


def untold(rungs: Sequence[Rung], prepared: Prepared) -> tuple[Untold, ...]:
    """What the records cannot tell of the effects of a ladder, by its last fit; in their order."""
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
    """The product of an effect's open parameters that the records do tell; "" where there is none.

    Parameters that are zero, angles and those at a bound have no part in a product.
    """
    start, model = f"{candidate.at}.{candidate.effect.name}.", fit.model
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
        return ""
    values = np.array([abs(model.parameters[n].value) for n in names])
    errors = np.array([model.parameters[n].stderr for n in names]) / values
    powers, known = best_product(_by_relative_change(fit, names, values), errors)
    counting = [i for i, p in enumerate(powers) if abs(p) >= POWER]
    is_open = any(errors[i] >= OPEN for i in counting)
    if len(counting) < 2 or not is_open or known >= PRODUCT * min(errors[i] for i in counting):
        return ""
    product = " * ".join(_power(names[i].rpartition(".")[2], powers[i]) for i in counting)
    each = ", ".join(f"{100 * errors[i]:.2g} %" for i in counting)
    return f"{product} is known to {100 * known:.2g} %, each of them alone to {each}"


def best_product(columns: Array, errors: Array) -> tuple[Array, float]:
    """Powers (k,), the largest 1, of the product that is known best, and its relative error.

    columns: (rows, k) of the residual by relative changes, what others can make up for taken out
    errors: (k,) relative standard errors of each alone
    """
    shares = np.linalg.pinv(columns.T @ columns, rcond=1e-12, hermitian=True)
    spread = np.sqrt(np.maximum(np.diag(shares), 1e-300))
    covariance = shares / np.outer(spread, spread) * np.outer(errors, errors)
    _, vectors = np.linalg.eigh(covariance)
    powers = vectors[:, 0]
    powers = powers / powers[np.argmax(np.abs(powers))]
    return powers, float(np.sqrt(max(powers @ covariance @ powers, 0.0)))


def _by_relative_change(fit: Fit, names: Sequence[str], values: Array) -> Array:
    """Residual by relative changes of parameters (rows, k), without what the others make up for."""
    ours = [fit.free.index(n) for n in names]
    rest = [i for i in range(len(fit.free)) if i not in ours]
    columns = fit.jacobian[:, ours] / fit.scale[ours] * values
    others = fit.jacobian[:, rest]
    if not rest:
        return columns
    return columns - others @ np.linalg.lstsq(others, columns, rcond=1e-10)[0]


def _power(name: str, power: float) -> str:
    return name if abs(power - 1.0) < 0.05 else f"{name}^{power:.1f}"
