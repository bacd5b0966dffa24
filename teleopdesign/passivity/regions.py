"""The region of two parameters in which a claim holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base.frozen import ByValue
from ..base.shown import Shown
from .claims.claim import Claim


@dataclass(frozen=True, eq=False)
class Region(Shown, ByValue):
    """Status of a claim at each point of a grid of two parameters.

    x, y: values of the parameters, (n,) and (m,)
    status: "proved", "refuted", "evidence" or "unknown", (m, n)
    holds: 1 where the claim holds, 0 where not, NaN where unknown, (m, n)
    """

    x: np.ndarray
    y: np.ndarray
    status: np.ndarray
    holds: np.ndarray


def region(claim: Callable[[float, float], Claim], x: np.ndarray, y: np.ndarray) -> Region:
    """Judge claim(x, y) at every point of a grid, each point alone.

    Between the points nothing is known.

    claim: a function of two numbers that returns a `Claim`
    x, y: values of the parameters, (n,) and (m,)
    """
    claims = [[claim(float(a), float(b)) for a in x] for b in y]
    status = np.array([[c.status for c in row] for row in claims])
    holds = np.array(
        [[np.nan if c.holds is None else float(c.holds) for c in row] for row in claims]
    )
    return Region(np.asarray(x, dtype=float), np.asarray(y, dtype=float), status, holds)
