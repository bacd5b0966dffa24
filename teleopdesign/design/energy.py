"""Search for energy that the compensated device releases, over sinusoids of many sizes and speeds.

The hand moves the device along a prescribed sinusoid. The energy that the hand puts in over a
steady cycle is negative where the device releases energy. The simulation has all identified
effects, encoder, sampling and delay. The result is evidence for the simulated motions, and no proof
for others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..base.errors import ModelError
from ..base.units import unit_of
from ..diagrams import Diagram
from ..passivity import Claim, Evidence
from ..realise.reach import Reach
from ..realise.tips import led_motion
from ..simulate import Sampling
from .prediction import steady_cycle
from .stated_motion import StatedMotion

#: amplitudes and frequencies of the simulated motions, over those of the stated motion
SIZES, FREQUENCIES = (0.1, 0.3, 1.0), (1.0, 3.0, 10.0, 30.0)


@dataclass(frozen=True)
class CycleEnergy:
    """Energy that the hand puts in per cycle of a motion, J; -inf: signals grow without bounds."""

    motion: StatedMotion
    energy: float


def motions_around(motion: StatedMotion, reach: Reach) -> Iterator[StatedMotion]:
    """The stated motion, smaller and faster ones, up to the recorded speed."""
    for size in SIZES:
        for faster in FREQUENCIES:
            one = replace(
                motion, amplitude=size * motion.amplitude, frequency=faster * motion.frequency
            )
            if one.peak_speed <= reach.peak_speed:
                yield one


def energy_taken(diagram: Diagram, motion: StatedMotion, sampling: Sampling) -> CycleEnergy:
    """Energy that the hand puts in over a steady cycle, from a simulation."""
    try:
        cycle = steady_cycle(diagram, motion, sampling)
    except ModelError:
        return CycleEnergy(motion, float("-inf"))
    power = cycle["E"].values * cycle[f"{led_motion(diagram, 'L')}_velocity"].values
    return CycleEnergy(motion, float(np.mean(power) / motion.frequency))


def energy_claim(
    diagram: Diagram, motion: StatedMotion, reach: Reach, sampling: Sampling, *, axis: str
) -> Claim:
    """Evidence, not proof, on whether the device takes energy along every simulated motion."""
    trials = [energy_taken(diagram, m, sampling) for m in motions_around(motion, reach)]
    supplying = [t for t in trials if t.energy < 0]
    # where it releases energy, the slowest such motion says from where on
    shown = min(supplying, key=lambda t: t.motion.frequency) if supplying else _least_energy(trials)
    size, unit = shown.motion.amplitude, unit_of("position", axis)
    frequencies = [t.motion.frequency for t in trials]
    words = "releases energy along" if supplying else "takes least along"
    searched = (
        f"{len(trials)} sinusoids, {min(frequencies):.3g} to {max(frequencies):.3g} Hz, simulated "
        f"with sampling, delay and encoder; it {words} {size:.3g} {unit} at "
        f"{shown.motion.frequency:.3g} Hz"
    )
    if supplying:
        searched += f" and {len(supplying) - 1} more"
    statement = "the device takes energy from the hand"
    return Claim(statement, Evidence(not supplying, searched, shown.energy, "J a cycle"))


def _least_energy(trials: list[CycleEnergy]) -> CycleEnergy:
    return min(trials, key=lambda t: t.energy / t.motion.amplitude)
