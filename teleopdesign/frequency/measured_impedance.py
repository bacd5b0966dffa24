"""The apparent impedance of a mechanism, measured in simulation as on the device.

The motion is a sinusoid, prescribed or tracked by a position loop; once cycles repeat, the first
harmonic of the force error R_D - R_M over that of the motion is Zhat_M at that frequency and
amplitude. Bernstein, Lawrence, Pao, World Haptics 2005, section 6 and figures 6 and 7.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np

from ..diagrams import Diagram
from ..errors import ModelError
from ..quantity import unit_of
from ..simulate import Sampling
from ..simulate.prepared import SAMPLED
from .impedance_map import ImpedanceMap
from .sinusoid import GIVE, Sinusoid, settled_harmonics

Amplitude = float | Sequence[float] | np.ndarray | Callable[[np.ndarray], np.ndarray]


def falling(amplitude: float, *, exponent: float = 0.8) -> Callable[[np.ndarray], np.ndarray]:
    """The profile amplitude * (f / 1 Hz)^-exponent; 0.8 is that of figure 7 of the paper."""
    return lambda frequency: amplitude * np.asarray(frequency, dtype=float) ** -exponent


def measured_impedance(
    diagrams: Diagram | Mapping[str, Diagram],
    *,
    amplitude: Amplitude,
    frequency: float | Sequence[float] | np.ndarray,
    drive: str = "",
    motion: str = "L",
    force: str = "E",
    computer: Sampling | Literal["continuous"] = SAMPLED,
    give: float = GIVE,
) -> ImpedanceMap:
    """Zhat_M of one diagram or several cases over frequency and amplitude.

    amplitude: of the drive, m or rad: each with each frequency, or a function of frequency (a
        profile, such as `falling(0.01)`);  frequency: Hz
    drive: signal that is the sinusoid; default the motion itself, prescribed; "L_D": the reference
        of a position loop, which the motion then follows as well as the loop can
    motion, force: signals whose first harmonics are divided
    computer: how controllers are sampled, or "continuous"
    give: share of the amplitude by which ideal Coulomb friction gives before it slides; sqrt(give)
        sets the error (1e-5: 0.2 degrees of its phase), 1/sqrt(give) the time
    raises ModelError: a frequency or amplitude that is not positive, a signal that is not there, or
        a loop that is unstable
    """
    import xarray

    cases = {diagrams.name: diagrams} if isinstance(diagrams, Diagram) else dict(diagrams)
    frequencies = _positive("frequency", frequency)
    profile = callable(amplitude)
    sizes = _positive("amplitude", amplitude(frequencies) if callable(amplitude) else amplitude)
    shape = (len(cases), len(frequencies), *(() if profile else (len(sizes),)))
    found = {n: np.empty(shape) for n in ("distortion", "change", "motion_amplitude")}
    z = np.empty(shape, dtype=complex)
    for i, diagram in enumerate(cases.values()):
        for j, f in enumerate(frequencies):
            for k, size in enumerate(sizes[j : j + 1] if profile else sizes):
                at = (i, j) if profile else (i, j, k)
                sinusoid = Sinusoid(
                    drive or motion, float(size), float(f), computer=computer, give=give
                )
                one = settled_harmonics(diagram, sinusoid, signals=(force, motion))
                z[at] = one[force].phasor / one[motion].phasor
                found["distortion"][at] = one[force].distortion
                found["change"][at] = max(h.change for h in one.values())
                found["motion_amplitude"][at] = abs(one[motion].phasor)
    dims = ("case", "frequency", *(() if profile else ("amplitude",)))
    axis = _axis(next(iter(cases.values())))
    length = unit_of("position", axis)
    units = {"distortion": "1", "change": "1", "motion_amplitude": length}
    data = {"impedance": (dims, z, {"units": unit_of("stiffness", axis)})}
    data |= {n: (dims, values, {"units": units[n]}) for n, values in found.items()}
    coordinates = {
        "case": list(cases),
        "frequency": ("frequency", frequencies, {"units": "Hz"}),
        "amplitude": ("frequency" if profile else "amplitude", sizes, {"units": length}),
    }
    attrs = {"drive": drive or motion, "motion": motion, "force": force, "give": give}
    return ImpedanceMap(xarray.Dataset(data, coordinates, attrs))


def _positive(what: str, values: float | Sequence[float] | np.ndarray) -> np.ndarray:
    found = np.atleast_1d(np.asarray(values, dtype=float))
    if found.ndim != 1 or not found.size or not (np.isfinite(found) & (found > 0)).all():
        raise ModelError(f"measured impedance: {what} must be positive numbers, found {values}")
    return found


def _axis(diagram: Diagram) -> str:
    return next((b.body.axis for b in diagram.bodies if hasattr(b.body, "axis")), "prismatic")
