"""A law of a body along its signals, such as its friction level, with a standard error.

The standard error is bounded by the sum of abs(dlaw/dp) times the error of each parameter p. For
any correlation of the parameters it is not larger.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy as sp

from ..blocks import Body
from ..measurement.filtering import Array


def law_along(body: Body, law: sp.Expr, signals: Mapping[sp.Symbol, Any]) -> tuple[Array, Array]:
    """The law and the bound of its standard error, both in the broadcast shape of the signals.

    law: on symbols of the body's parameters and of the signals
    signals: symbol of `effects.SIGNALS` or of a hidden state -> array
    Parameters that are fixed, or have no standard error, count as exact.
    """
    numbers, symbols, names = body.numbers(), body.symbols(), list(signals)
    values = [np.asarray(v, dtype=float) for v in signals.values()]
    shape = np.broadcast_shapes(*(v.shape for v in values))

    def at(expression: sp.Expr) -> Array:
        call = sp.lambdify(names, expression.subs(numbers), "numpy")
        return np.broadcast_to(np.asarray(call(*values), dtype=float), shape)

    error = np.zeros(shape)
    for name, value in body.parameters.items():
        if not value.fixed and math.isfinite(value.stderr) and law.has(symbols[name]):
            error = error + np.abs(at(sp.diff(law, symbols[name]))) * value.stderr
    return at(law), error
