"""The largest stiffness of a Dahl cancellation that does not oscillate, by simulation of the loop.

Mahvash and Okamura (ICRA 2006) raise sigma_D until the joint oscillates; so does this, by bisection
in simulation. The loop is kicked and left alone. It oscillates where the rms speed of the last
quarter of the time is more than `decay` of that of the second quarter, and more than `rest` of the
kick; friction that stops the body, or damping, makes it fall below. A simulation that grows beyond
all bounds oscillates too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..blocks import Body
from ..by_value import ByValue
from ..diagrams import Diagram
from ..errors import ModelError
from ..quantity import unit_of
from ..simulate import Sampling, Simulation, simulate


@dataclass(frozen=True, eq=False)
class LargestStiffness(ByValue):
    """The largest stiffness without oscillation, N/m.

    stiffness: inf where the largest one simulated does not oscillate, 0 where the smallest does
    oscillates: the smallest that was seen to oscillate, inf where none was;
    simulations: their number
    kick: initial speed, m/s;  decay: of the criterion
    axis: of the device; on a revolute one N m/rad and rad/s
    """

    stiffness: float
    oscillates: float
    simulations: int
    kick: float
    decay: float
    axis: str = "prismatic"

    def __repr__(self) -> str:
        unit, speed = unit_of("stiffness", self.axis), unit_of("velocity", self.axis)
        return (
            f"Largest stiffness without oscillation: {self.stiffness:.4g} {unit}, "
            f"{self.oscillates:.4g} {unit} oscillates ({self.simulations} simulations of a kick of "
            f"{self.kick:g} {speed}; it oscillates where more than {self.decay:g} of the rms "
            "speed is left)"
        )


def largest_stiffness_without_oscillation(
    diagram: Diagram,
    *,
    smallest: float,
    largest: float,
    kick: float,
    duration: float,
    computer: Sampling,
    decay: float = 0.5,
    rest: float = 0.02,
    precision: float = 0.02,
    step: float = 1e-4,
    give: float = 1e-6,
) -> LargestStiffness:
    """Raise the stiffness of the block C, a `dahl` cancellation, until the loop oscillates.

    diagram: a haptic interface with a hand and a Dahl cancellation C
    smallest, largest: stiffness simulated, N/m;  kick: initial speed, m/s;  duration: s
    precision: relative, of the result;  step, give: of the simulation, see `simulate`
    raises ModelError: the diagram has no Dahl cancellation, or the range is empty
    """
    name = "C.dahl.stiffness"
    if name not in diagram.values:
        raise ModelError(f"{diagram.name}: largest_stiffness: no block C with the law dahl")
    if not 0 < smallest < largest:
        raise ModelError(
            f"largest_stiffness: smallest = {smallest:g} N/m, expected above 0 and below largest = "
            f"{largest:g} N/m"
        )
    simulations = 0

    def oscillates(stiffness: float) -> bool:
        nonlocal simulations
        simulations += 1
        try:
            run = simulate(
                diagram.with_values({name: stiffness}),
                duration=duration,
                initial={"L_velocity": kick},
                computer=computer,
                step=step,
                give=give,
            )
        except ModelError:
            return True  # signals grow beyond all bounds
        return keeps_moving(run, decay=decay, floor=rest * abs(kick))

    bracket = _bisect(oscillates, smallest, largest, precision)
    axis = next(b.body.axis for b in diagram.bodies if isinstance(b.body, Body))
    return LargestStiffness(*bracket, simulations, kick, decay, axis)


def keeps_moving(run: Simulation, *, decay: float, floor: float) -> bool:
    """Whether the rms speed of the last quarter is above `decay` of the second's, and `floor`."""
    speed = run["L_velocity"].values
    quarters = np.array_split(speed, 4)
    second, last = (float(np.sqrt(np.mean(quarters[k] ** 2))) for k in (1, 3))
    return last > max(decay * second, floor)


def _bisect(
    oscillates: Callable[[float], bool], smallest: float, largest: float, precision: float
) -> tuple[float, float]:
    """(largest that does not oscillate, smallest that does), to a relative precision.

    As the papers' experiment does it, from below: doubled until it oscillates, then bisected.
    """
    if oscillates(smallest):
        return 0.0, smallest
    low, high = smallest, smallest
    while high < largest:
        high = min(2 * high, largest)
        if oscillates(high):
            break
        low = high
    else:
        return float("inf"), float("inf")
    while high - low > precision * low:
        middle = (low + high) / 2
        if oscillates(middle):
            high = middle
        else:
            low = middle
    return low, high
