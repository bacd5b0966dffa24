"""The force error to expect of the device as it will be built, as an interval.

The body is drawn within the standard errors of its parameters, each by itself; C and H keep their
numbers. What the diagnosis left unexplained beyond the noise floor is added in squares at the upper
end: nothing says whether a compensation changes this force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..blocks import NINETY_FIVE, Body
from ..diagrams import Diagram
from ..measurement.experiment import Experiment
from ..measurement.prepare import prepare
from ..realise.tips import led_motion
from ..simulate import Sampling, simulate_many
from .assumptions import StatedMotion
from .prediction import BRISTLE_SHARE, CYCLES

#: bodies that are drawn: two groups of lanes, computed together
DRAWS = 32


@dataclass(frozen=True)
class ExpectedError(ByValue):
    """Rms force error about its mean along the stated motion, N or N m; 95 %.

    case: "hybrid", "MBC" or "none": what can be built with the recorded sensors
    simulated: at the estimates;  without: no compensation, at the estimates
    low, high: ends of the interval; NaN: the drawn bodies cannot be simulated
    unexplained: rms force that the diagnosis left unexplained
    """

    case: str
    simulated: float
    low: float
    high: float
    without: float
    unexplained: float


def drawn_values(
    diagram: Diagram, draws: int, *, first_exact: bool = False
) -> dict[str, ArrayLike]:
    """Values of the body within its standard errors, one for each draw, each by itself.

    first_exact: whether the first draw has the estimates
    """
    (body,) = (b.body for b in diagram.bodies if b.name == "Z_M")
    assert isinstance(body, Body)
    random, values = np.random.default_rng(0), dict[str, ArrayLike]()
    for name, value in body.parameters.items():
        if value.fixed or not math.isfinite(value.stderr) or value.stderr == 0:
            continue
        errors = random.standard_normal(draws)
        errors[0] *= not first_exact
        declared = body.parameter(name)
        drawn = np.clip(value.value + value.stderr * errors, declared.lower, declared.upper)
        values[f"Z_M.{name}"] = drawn
    return values or {"Z_M.inertia": np.full(draws, body.parameters["inertia"].value)}


def error_interval(
    diagram: Diagram, motion: StatedMotion, sampling: Sampling
) -> tuple[float, float]:
    """Interval of the force error of one case over the errors of the body's parameters."""
    runs = simulate_many(
        diagram,
        drawn_values(diagram, DRAWS),
        duration=CYCLES / motion.frequency,
        motion={led_motion(diagram, "L"): motion.motion},
        computer=sampling,
        step=sampling.period / 10,
        give=BRISTLE_SHARE * motion.amplitude,
        reduce={"rms": ("E", "rms"), "mean": ("E", "mean")},
        after=(CYCLES - 1) / motion.frequency,
    )
    spread = np.sqrt(np.maximum(runs["rms"].values ** 2 - runs["mean"].values ** 2, 0.0))
    known = spread[np.isfinite(spread)]
    if not known.size:
        return math.nan, math.nan
    middle, half = float(np.mean(known)), NINETY_FIVE * float(np.std(known))
    return max(middle - half, 0.0), middle + half


def unexplained_force(experiment: Experiment, place: str, *, error: float, floor: float) -> float:
    """Rms force (N or N m) that a model leaves beyond the noise floor, on records not fitted.

    error: relative check error of the model;  floor: noise floor, in the same measure
    """
    motions = [s.motion for s in prepare(experiment).stretches if s.motion.body == place]
    force = np.concatenate([m.command + m.interaction for m in motions])
    beyond = math.sqrt(max(error**2 - floor**2, 0.0))
    return beyond * float(np.sqrt(np.mean(force**2)))


def expected_error(
    case: str,
    diagram: Diagram,
    motion: StatedMotion,
    sampling: Sampling,
    *,
    simulated: float,
    without: float,
    unexplained: float,
) -> ExpectedError:
    """The interval of the case that will be built.

    diagram: that case;  simulated, without: its force error, and that without compensation
    """
    try:
        low, high = error_interval(diagram, motion, sampling)
    except ModelError:
        low = high = math.nan
    if not math.isnan(low):
        low, high = min(low, simulated), math.hypot(max(high, simulated), unexplained)
    return ExpectedError(case, simulated, low, high, without, unexplained)
