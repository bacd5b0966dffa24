"""Products of parameters that the records determine, although no single factor is determined.

Examples are a friction level and the speed below which it acts, or a spring and the mass on it.
Along a valley of nearly equal squares each parameter changes much, but a product of their powers
hardly changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from .fit import Fit

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
