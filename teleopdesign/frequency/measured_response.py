"""Measured frequency responses: from data, from recorded signals, or from simulation.

The apparent impedance of a mechanism is measured in simulation as on the device. The motion is a
sinusoid, prescribed or tracked by a position loop. Once cycles repeat, Zhat_M at that frequency and
amplitude is the first harmonic of the force error R_D - R_M over that of the motion. Bernstein,
Lawrence, Pao, World Haptics 2005, section 6 and figures 6 and 7.

Spectra of recorded signals are averaged over windows (Welch) and narrow bands of frequency. The
coherence c = |S_xy|^2 / (S_xx S_yy) is the part of the output's power that a linear response to the
input explains; friction lowers it like a disturbance. Noise of the input makes S_xy / S_xx too
small, noise of the output S_yy / S_yx too large: |H| is in the middle, and its interval has both.
With n independent averages the further standard error of ln |H|, and that of the phase (rad), is
sqrt((1 - c) / (2 n c)); Bendat and Piersol, Random Data, 2010, table 9.6.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ModelError
from ..base.units import unit_of
from ..blocks import NINETY_FIVE
from ..diagrams import Diagram
from ..diagrams.units import first_axis
from ..realise.simulated import simulated_parted
from ..simulate import Sampling
from ..simulate.sampling import SAMPLED
from .confidence import ResponseBand
from .impedance_map import Amplitude, Grid, ImpedanceMap
from .response import Array, FrequencyResponse, cases_of, phase_of, ratio_unit
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


#: independent averages per window: Hann windows that overlap by half share a little
OF_WINDOWS = 0.95
#: independent averages per line of a spectrum: those of a Hann window are 1.5 lines wide
OF_LINES = 1 / 1.5
#: bands of frequency in a decade, so narrow that a mass keeps its slope within one
BANDS = 20
#: fewest windows: with fewer the coherence is near 1 whatever was recorded
WINDOWS = 6


def recorded_response(
    input_signal: Sequence[Array],
    output_signal: Sequence[Array],
    *,
    sample_time: float,
    up_to: float | None = None,
    output: str = "E",
    input: str = "L",
    unit: str = "1",
) -> FrequencyResponse:
    """The response of a recorded output to a recorded input, drawn as points.

    H is NaN where a coherence is no larger than chance alone makes it.

    input_signal, output_signal: stretches of (n,) each
    sample_time: s;  up_to: highest frequency, Hz; None: a quarter of the sample rate
    output, input: names of the signals;  unit: of output per input
    raises ModelError: signals of different lengths, too short for six windows, or at rest
    """
    windows, f, spectra = _spectra(input_signal, output_signal, sample_time)
    # the two lowest lines hold what is left of the trend
    used = (f >= 2 * f[1]) & (f <= (up_to or 0.25 / sample_time)) & (np.abs(spectra[:2]) > 0).all(0)
    f, spectra = f[used], spectra[:, used]
    if not len(f):
        raise ModelError("recorded_response: found no frequency at which both signals move")
    band = np.floor(BANDS * np.log10(f / f[:1])).astype(int)
    _, first, lines = np.unique(band, return_index=True, return_counts=True)
    at = np.add.reduceat(f, first) / lines
    xx, yy, xy = np.add.reduceat(spectra, first, axis=1) / lines
    n = OF_WINDOWS * windows * np.maximum(OF_LINES * lines, 1.0)
    coherence = np.clip(np.abs(xy) ** 2 / (xx * yy).real, 1e-12, 1.0)
    # 95 % of the coherences of signals that have nothing in common are below it
    sure = coherence > 1.0 - 0.05 ** (1.0 / np.maximum(n - 1.0, 0.1))
    size, phase = np.full((2, 1, len(at)), np.nan)
    size[0, sure] = np.sqrt((yy / xx).real)[sure]
    if sure.any():
        phase[:, sure] = phase_of(xy[None, sure], at[sure])
    error = np.sqrt((1.0 - coherence) / (2.0 * n * coherence))
    wide = error - 0.5 * np.log(coherence) / NINETY_FIVE
    return FrequencyResponse(
        ("measured",),
        at,
        size,
        phase,
        unit,
        output,
        input,
        left_out={},
        measured=True,
        band=ResponseBand(wide[None, :], np.degrees(error)[None, :]),
        coherence=coherence[None, :],
    )


def _spectra(
    inputs: Sequence[Array], outputs: Sequence[Array], sample_time: float
) -> tuple[int, Array, NDArray[np.complex128]]:
    """Number of windows, lines (n,) in Hz, and spectra of input, output and both (3, n).

    A window is an eighth of all stretches together, at most the longest stretch.
    """
    from scipy.signal import csd  # its import takes longer than a Bode plot

    lengths = [len(x) for x in inputs]
    if lengths != [len(y) for y in outputs] or not lengths:
        raise ModelError("recorded_response: expected an input and an output of the same length")
    rows = max(min(sum(lengths) // 8, max(lengths)), 1)
    pairs = [(x, y) for x, y in zip(inputs, outputs, strict=True) if len(x) >= rows]
    counts = [2 * (len(x) - rows) // rows + 1 for x, _ in pairs]
    if sum(counts) < WINDOWS or rows < 16:
        raise ModelError(
            f"recorded_response: found {sum(counts)} windows of {rows} samples, expected at least "
            f"{WINDOWS} of 16"
        )
    half = rows - rows // 2
    how: dict[str, Any] = {
        "fs": 1 / sample_time,
        "nperseg": rows,
        "noverlap": half,
        "detrend": "linear",
    }
    made = [[csd(*both, **how) for both in ((x, x), (y, y), (x, y))] for x, y in pairs]
    spectra = np.array([[s for _, s in row] for row in made], dtype=complex)
    lines = np.asarray(made[0][0][0], dtype=float)
    return sum(counts), lines, np.average(spectra, axis=0, weights=counts)
