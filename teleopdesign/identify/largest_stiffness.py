"""The largest stiffness of a Dahl cancellation that does not oscillate, by simulation of the loop.

Mahvash and Okamura (ICRA 2006) raise sigma_D until the joint oscillates; this module does so in
simulation, by bisection. The loop gets an initial speed (kick) and no other input. It oscillates if
the rms speed of the last quarter of the time exceeds `decay` times that of the second quarter, and
`rest` times the kick; friction that stops the body, or damping, makes it fall below. A simulation
that grows without bound oscillates as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base.errors import GrowsWithoutBound, ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown
from ..blocks import Body
from ..diagrams import Diagram
from ..simulate import Sampling, Simulation, simulate


@dataclass(frozen=True, eq=False)
class LargestStiffness(Shown, ByValue):
    """The largest stiffness without oscillation, N/m.

    stiffness: inf if the largest simulated one does not oscillate, 0 if the smallest does
    oscillates: the smallest that oscillated, inf if none did
    simulations: number of simulations;  kick: initial speed, m/s;  decay: of the criterion
    axis: of the device; on a revolute axis the units are N m/rad and rad/s
    """

    stiffness: float
    oscillates: float
    simulations: int
    kick: float
    decay: float
    axis: str = "prismatic"


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
    smallest, largest: range of the stiffness, N/m;  kick: initial speed, m/s;  duration: s
    decay, rest: of the criterion, see the module
    precision: relative, of the result;  step, give: of the simulation, see `simulate`
    raises ModelError: the diagram has no Dahl cancellation, the range is empty, or a simulation is
        refused, such as a step that does not divide the computer's delay
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
        except GrowsWithoutBound:
            return True
        return keeps_moving(run, decay=decay, floor=rest * abs(kick))

    bracket = _bisect(oscillates, smallest, largest, precision)
    axis = next(b.body.axis for b in diagram.bodies if isinstance(b.body, Body))
    return LargestStiffness(*bracket, simulations, kick, decay, axis)


def keeps_moving(run: Simulation, *, decay: float, floor: float) -> bool:
    """Whether the last quarter's rms speed exceeds `decay` times the second's, and `floor`."""
    speed = run["L_velocity"].values
    quarters = np.array_split(speed, 4)
    second, last = (float(np.sqrt(np.mean(quarters[k] ** 2))) for k in (1, 3))
    return last > max(decay * second, floor)


def _bisect(
    oscillates: Callable[[float], bool], smallest: float, largest: float, precision: float
) -> tuple[float, float]:
    """(largest that does not oscillate, smallest that does), to a relative precision.

    As in the papers' experiment, from below: doubled until it oscillates, then bisected.
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
