"""Numbers of Bernstein, Lawrence, Pao, World Haptics 2005, as far as they can be read.

The text of the paper that is in circulation lost its digits 0 and 1. Every number below has the
readings that fit the rest, the reading that is used, and a confidence. No test compares with a
number of low confidence.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

from ...base.frozen import Catalogue
from ...blocks import Body, Value
from ...controllers import controller, scheduled_force_feedback
from ...effects import EFFECTS
from ..wiring import Diagram
from .haptic_interface import haptic_interface


@dataclass(frozen=True)
class Reading:
    """A number (SI) that the paper does not show clearly: used value, other readings, and reason.

    readings: values that the print allows;  confidence: 0 to 1, that the value is the authors'
    """

    value: float
    unit: str
    readings: tuple[float, ...]
    confidence: float
    why: str


READINGS: Mapping[str, Reading] = Catalogue(
    {
        "coulomb_level": Reading(
            0.5, "N", (0.05, 0.15, 0.5, 1.5), 0.85, "fits the force axis beside the inertial force"
        ),
        "smoothing_velocity": Reading(
            0.015, "m/s", (0.005, 0.015, 0.05, 0.15), 0.45, "removes most of the step at 94 mm/s"
        ),
        "gain": Reading(5.0, "1", (5.0, 15.0, 50.0), 0.6, "leaves a margin for delay"),
        "scheduling_velocity": Reading(
            0.08, "m/s", (0.008, 0.08, 0.018, 0.18, 0.8), 0.6, "residual friction falls with speed"
        ),
        "bandwidth": Reading(
            20.0, "Hz", (2.0, 12.0, 20.0, 120.0, 200.0), 0.8, "the four cases merge above 20 Hz"
        ),
        "load": Reading(0.5, "kg", (0.005, 0.015, 0.05, 0.15, 0.5, 0.51), 0.6, "stands for a hand"),
        "mass": Reading(0.15, "kg", (0.15,), 0.3, "not printed; fits a corner near 20 Hz"),
        "frequency": Reading(1.5, "Hz", (0.5, 1.5), 0.95, "with 10 mm fills the velocity axis"),
        "amplitude": Reading(0.01, "m", (0.001, 0.01, 0.1), 0.95, "with 1.5 Hz fills the axis"),
        "sample_period": Reading(1e-3, "s", (1e-3,), 0.3, "not printed; usual"),
        "position_gain": Reading(
            2e4, "N/m", (2.0, 20.0, 200.0, 2e3, 1.2e4, 2e4), 0.3, "stable loop, simplest digits"
        ),
        "position_zero": Reading(
            2 * pi, "rad/s", (2 * pi, 12 * pi, 20 * pi), 0.3, "stable loop, simplest digits"
        ),
        "position_pole": Reading(
            100 * pi,
            "rad/s",
            (pi, 10 * pi, 100 * pi, 1000 * pi),
            0.3,
            "stable loop, simplest digits",
        ),
    },
    "reading",
)


def read_open_number(name: str) -> float:
    """The value (SI) that is used for an unclear number of the paper, by its name in `READINGS`.

    raises ModelError: no reading of that name, with the nearest one
    """
    return READINGS[name].value


def world_haptics_2005(*, position_loop: bool = False) -> Diagram:
    """The haptic interface with hybrid compensation, with the readings that are used.

    Force feedback H is analog, the cancellation C sampled; `position_loop` adds K and the load.
    """
    level = read_open_number("coulomb_level")
    device = Body(
        "prismatic",
        {"inertia": Value(read_open_number("mass")), "coulomb.level": Value(level)},
        (EFFECTS["coulomb"],),
    )
    lead = {n: read_open_number(f"position_{n}") for n in ("gain", "zero", "pole")}
    smoothing = {"level": level, "smoothing_velocity": read_open_number("smoothing_velocity")}
    return haptic_interface(
        device,
        hand=Body("prismatic", {"inertia": Value(read_open_number("load"))})
        if position_loop
        else None,
        cancellation=controller("smoothed_coulomb", smoothing),
        force_feedback=scheduled_force_feedback(
            gain=read_open_number("gain"),
            scheduling_velocity=read_open_number("scheduling_velocity"),
            bandwidth=read_open_number("bandwidth"),
        ),
        position_loop=controller("lead", lead) if position_loop else None,
        analog=("H",),
    )


def diagram() -> Diagram:
    """With the position loop of its experiments."""
    return world_haptics_2005(position_loop=True)
