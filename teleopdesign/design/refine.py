"""Tune the numbers of C and H for the least force error, under the conditions that keep them safe.

Free numbers: the velocity a of a smoothed cancellation, or the stiffness of a Dahl cancellation;
gain k and velocity b of H. Conditions: the cancelled level is kept (passivity), a is not below its
proposal (one encoder count), the stiffness not above it (P43, bristle length), k not above it
(delay of the loop), and b (1 + k) >= a k (P13). The objective is the simulated force error of the
hybrid along the stated motion, rms about its mean.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown
from ..controllers import Controller
from .cancellation import smoothing_name
from .outcome import Design
from .prediction import simulated_error

#: factor on the proposed number, up and down, within which the search looks for a better one
FARTHEST = 30.0
#: relative distance to a bound within which a number counts as at the bound
AT_BOUND = 0.01


@dataclass(frozen=True, eq=False)
class TunedControllers(Shown, ByValue):
    """C and H after the search.

    before, after: force error of the hybrid as proposed and as tuned, N or N m, rms
    at_bound: numbers at the limit of a condition or of the search range
    simulations: number of simulations that the search took
    """

    cancellation: Controller | None
    force_feedback: Controller
    before: float
    after: float
    at_bound: tuple[str, ...]
    simulations: int


def refine(design: Design, *, simulations: int = 60) -> TunedControllers:
    """Search for a smaller force error from the numbers of a design; every condition still holds.

    simulations: largest number of simulations
    raises ModelError: the proposed controllers cannot be simulated
    """
    from scipy.optimize import minimize

    start, bounds = _range(design)
    names = list(start)
    low, high = np.log([bounds[n] for n in names]).T
    diagram = design.prediction.hybrid
    cost: dict[tuple[float, ...], float] = {}

    def error(point: np.ndarray) -> float:
        values = dict(zip(names, np.exp(np.clip(point, low, high)).tolist(), strict=True))
        values = _raise_corner(values)
        key = tuple(values.values())
        if key not in cost:
            try:
                cost[key] = simulated_error(
                    diagram.with_values(values), design.prediction.motion, design.sampling
                )
            except ModelError:
                cost[key] = math.inf  # grows beyond all bounds
        return cost[key]

    at = np.log([start[n] for n in names])
    before = error(at)
    if not math.isfinite(before):
        raise ModelError("refine: the controllers that were proposed cannot be simulated")
    # a simplex that reaches into the range from the proposal, which lies on some of its bounds
    steps = np.where(at - low > high - at, -1.0, 1.0) * np.minimum(0.4, (high - low) / 2)
    simplex = np.vstack([at, at + np.diag(steps)])
    minimum = minimize(
        error,
        at,
        method="Nelder-Mead",
        bounds=list(zip(low, high, strict=True)),
        options={"maxfev": simulations, "initial_simplex": simplex, "xatol": 0.01, "fatol": 1e-6},
    )
    values = np.exp(np.clip(minimum.x, low, high)).tolist()
    best = _raise_corner(dict(zip(names, values, strict=True)))
    best_diagram = diagram.with_values(best)
    held = [
        n.partition(".")[2]
        for n in names
        if min(abs(best[n] / end - 1) for end in bounds[n]) < AT_BOUND
    ]
    controllers = {c.name: c.controller for c in best_diagram.controls}
    cancellation, feedback = controllers.get("C"), controllers["H"]
    assert isinstance(feedback, Controller)
    return TunedControllers(
        cancellation if isinstance(cancellation, Controller) else None,
        feedback,
        before,
        float(minimum.fun),
        tuple(held),
        len(cost),
    )


def _range(design: Design) -> tuple[dict[str, float], dict[str, tuple[float, float]]]:
    """Start and bounds of the numbers that are searched, by their names in the diagram."""
    h = design.force_feedback.controller.names()
    k, b = h["velocity_schedule.gain"], h["velocity_schedule.scheduling_velocity"]
    start = {"H.velocity_schedule.gain": k, "H.velocity_schedule.scheduling_velocity": b}
    bounds = {
        "H.velocity_schedule.gain": (k / FARTHEST, k),
        "H.velocity_schedule.scheduling_velocity": (b / FARTHEST, b * FARTHEST),
    }
    if design.cancellation is not None:
        c = design.cancellation.controller.names()
        if (smoothing := smoothing_name(c)) is not None:
            a = c[smoothing]
            start[f"C.{smoothing}"] = a
            bounds[f"C.{smoothing}"] = (a, a * FARTHEST)
        else:
            law = design.cancellation.controller.stages[0].law
            bristle = law.bristle_stiffness or "presliding.stiffness"
            if (stiffness := c.get(f"{law.name}.{bristle}")) is not None:
                start[f"C.{law.name}.{bristle}"] = stiffness
                bounds[f"C.{law.name}.{bristle}"] = (stiffness / FARTHEST, stiffness)
    return start, bounds


def _raise_corner(values: dict[str, float]) -> dict[str, float]:
    """The values, with b increased if P13 requires it: b (1 + k) >= a k."""
    smoothing = smoothing_name(values, block="C.")
    a = 0.0 if smoothing is None else values[smoothing]
    k = values["H.velocity_schedule.gain"]
    b = max(values["H.velocity_schedule.scheduling_velocity"], a * k / (1 + k))
    return {**values, "H.velocity_schedule.scheduling_velocity": b}
