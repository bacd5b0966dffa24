"""Measured frequency responses: from python-control data, from arrays, or from simulation.

The apparent impedance of a mechanism is measured in simulation as on the device. The motion is a
sinusoid, prescribed or tracked by a position loop. Once cycles repeat, Zhat_M at that frequency and
amplitude is the first harmonic of the force error R_D - R_M over that of the motion. Bernstein,
Lawrence, Pao, World Haptics 2005, section 6 and figures 6 and 7.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..base.errors import ModelError
from ..base.units import unit_of
from ..diagrams import Diagram
from ..diagrams.units import first_axis
from ..realise.simulated import simulated_parted
from ..simulate import Sampling
from ..simulate.sampling import SAMPLED
from .impedance_map import Amplitude, Grid, ImpedanceMap
from .response import FrequencyResponse, cases_of, phase_of, ratio_unit
from .sinusoid import BRISTLE_SHARE, Sinusoid, steady_harmonics

if TYPE_CHECKING:
    import control


def measured_response(
    values: control.FrequencyResponseData | np.ndarray | Sequence[complex],
    *,
    frequency: np.ndarray | Sequence[float] | None = None,
    output: str = "R_M",
    input: str = "R_D",
    unit: str = "1",
    case: str = "measured",
) -> FrequencyResponse:
    """A measured response, drawn as points in the plots of the model.

    values: `control.FRD` of one input and one output, or complex numbers (n,) at `frequency` in Hz
    output, input: signals;  unit: of output per input
    raises ModelError: another shape, or frequency missing, not rising or not positive
    """
    if not isinstance(values, np.ndarray | Sequence):
        data, omega = np.asarray(values.frdata), np.asarray(values.omega)
        if data.ndim == 3 and data.shape[:2] != (1, 1):
            raise ModelError(
                f"measured_response: found {data.shape[1]} inputs and {data.shape[0]} outputs, "
                "expected one of each: index the data"
            )
        numbers, f = data.reshape(-1), omega / (2 * np.pi)
    elif frequency is None:
        raise ModelError("measured_response: arrays need frequency, in Hz")
    else:
        numbers, f = np.asarray(values, dtype=complex), np.asarray(frequency, dtype=float)
    if numbers.shape != f.shape or f.ndim != 1:
        raise ModelError(
            f"measured_response: values of shape {numbers.shape} at frequencies of shape {f.shape}"
        )
    if not len(f) or f[0] <= 0 or (np.diff(f) <= 0).any():
        raise ModelError("measured_response: frequency must be positive and rise")
    return _points(numbers[None, :], [case], f, output, input, unit)


def simulated_response(
    diagrams: Diagram | Mapping[str, Diagram],
    *,
    amplitude: float,
    frequency: np.ndarray | Sequence[float],
    output: str = "R_M",
    input: str = "R_D",
    computer: Sampling | Literal["continuous"] = SAMPLED,
    give: float = BRISTLE_SHARE,
) -> FrequencyResponse:
    """First harmonic of `output` over that of `input`, from a simulation with a sinusoid.

    amplitude: of `input`, in its unit; the response of a nonlinear system depends on it
    If all effects have a linear form, `bode` gives the same. Other arguments are those of
    `measured_impedance`.
    """
    cases = cases_of(diagrams)
    f = np.asarray(frequency, dtype=float)
    rows = np.empty((len(cases), len(f)), dtype=complex)
    for i, diagram in enumerate(cases.values()):
        for j, one in enumerate(f):
            drive = Sinusoid(input, amplitude, float(one), computer=computer, give=give)
            harmonics = steady_harmonics(diagram, drive, signals=(output, input))
            rows[i, j] = harmonics[output].phasor / harmonics[input].phasor
    unit = ratio_unit(next(iter(cases.values())), output, input)
    return _points(rows, list(cases), f, output, input, unit)


def _points(
    values: np.ndarray, cases: list[str], f: np.ndarray, output: str, source: str, unit: str
) -> FrequencyResponse:
    size, phase = np.abs(values), phase_of(values, f)
    return FrequencyResponse(
        tuple(cases), f, size, phase, unit, output, source, left_out={}, measured=True
    )


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
