"""The apparent impedance of a mechanism, measured in simulation as on the device.

The motion is a sinusoid, prescribed or tracked by a position loop. Once cycles repeat, Zhat_M at
that frequency and amplitude is the first harmonic of the force error R_D - R_M over that of the
motion. Bernstein, Lawrence, Pao, World Haptics 2005, section 6 and figures 6 and 7.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from ..base.units import unit_of
from ..diagrams import Diagram
from ..diagrams.units import first_axis
from ..realise.parted import simulated_parted
from ..simulate import Sampling
from ..simulate.sampling import SAMPLED
from .cases import cases_of
from .grid import Amplitude, Grid
from .impedance_map import ImpedanceMap
from .sinusoid import BRISTLE_SHARE, Sinusoid, steady_harmonics


def measured_impedance(
    diagrams: Diagram | Mapping[str, Diagram],
    *,
    amplitude: Amplitude,
    frequency: float | Sequence[float] | np.ndarray,
    drive: str = "",
    motion: str = "L",
    force: str = "E",
    computer: Sampling | Literal["continuous"] = SAMPLED,
    give: float = BRISTLE_SHARE,
) -> ImpedanceMap:
    """Impedance Zhat_M that a hand feels, by simulation, over frequency and amplitude.

    amplitude: of the drive, m or rad: each with each frequency, or a function of frequency (a
        profile, such as `falling_profile(0.01)`);  frequency: Hz
    drive: signal that is the sinusoid; default: the motion itself, prescribed; "L_D": the reference
        of a position loop, which the motion follows as well as the loop can
    motion, force: signals whose first harmonics are divided; for a body with a compliant
        transmission or backlash, a prescribed motion is that of the tip
    computer: how controllers are sampled, or "continuous"
    give: share of the amplitude by which ideal Coulomb friction deflects before it slides; the
        error is proportional to sqrt(give) (1e-5: 0.2 degrees of its phase), the time to
        1/sqrt(give)
    raises ModelError: a frequency or amplitude that is not positive, an unknown signal, or a loop
        that is unstable
    """
    cases = cases_of(diagrams)
    grid = Grid.of(amplitude, frequency)
    shape = (len(cases), *(len(getattr(grid, name)) for name in grid.dims))
    z = np.empty(shape, dtype=complex)
    distortion, unsettled, moved = np.empty(shape), np.empty(shape), np.empty(shape)
    for i, whole in enumerate(cases.values()):
        diagram, led = simulated_parted(whole, motion)
        # one that a loop tracks is the one that sensors see
        read = motion if drive else led
        source = drive or read
        for at, size, f in grid.points:
            sinusoid = Sinusoid(source, size, f, computer=computer, give=give)
            one = steady_harmonics(diagram, sinusoid, signals=(force, read))
            here = (i, *at)
            z[here] = one[force].phasor / one[read].phasor
            distortion[here] = one[force].distortion
            unsettled[here] = max(h.unsettled for h in one.values())
            moved[here] = abs(one[read].phasor)
    axis = first_axis(next(iter(cases.values())))
    length = unit_of("position", axis)
    values = {
        "impedance": (z, unit_of("stiffness", axis)),
        "distortion": (distortion, "1"),
        "unsettled": (unsettled, "1"),
        "motion_amplitude": (moved, length),
    }
    data = grid.label(values, cases=list(cases), length=length)
    data.attrs |= {"drive": drive or motion, "motion": motion, "force": force, "give": give}
    return ImpedanceMap(data)
