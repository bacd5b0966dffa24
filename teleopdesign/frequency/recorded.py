"""A frequency response from recorded signals, with its coherence and standard errors.

Spectra are averaged over windows (Welch) and over narrow bands of frequency. The response is
H = S_xy / S_xx, with the coherence c = |S_xy|^2 / (S_xx S_yy): the part of the output's power that
a linear response to the input explains. With n independent averages the standard error of ln |H|
and of the phase (rad) is sqrt((1 - c) / (2 n c)); Bendat and Piersol, Random Data, 2010, table 9.6.
Friction lowers the coherence like a disturbance.

Where a coherence is no larger than chance alone makes it, H is NaN.

Noise of the input makes |H| too small: the true one lies between S_xy / S_xx and S_yy / S_yx. Their
ratio is c, and no averaging makes it smaller.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ModelError
from ..blocks import NINETY_FIVE
from .confidence import ResponseBand
from .response import Array, FrequencyResponse, phase_of

#: independent averages per window: Hann windows that overlap by half share a little
OF_WINDOWS = 0.95
#: independent averages per line of a spectrum: those of a Hann window are 1.5 lines wide
OF_LINES = 1 / 1.5
#: bands of frequency in a decade, so narrow that a mass keeps its slope within one
BANDS = 20
#: fewest windows: with fewer the coherence is near 1 whatever was recorded
WINDOWS = 6


def recorded_response(
    input_signal: Array | Sequence[Array],
    output_signal: Array | Sequence[Array],
    *,
    sample_time: float,
    up_to: float | None = None,
    window: float | None = None,
    output: str = "E",
    input: str = "L",
    unit: str = "1",
    noise: Literal["output", "both"] = "output",
) -> FrequencyResponse:
    """The response of a recorded output to a recorded input, drawn as points.

    input_signal, output_signal: (n,) each, or several stretches of them
    sample_time: s;  up_to: highest frequency, Hz; None: a quarter of the sample rate
    window: s; None: an eighth of all stretches together, at most the longest stretch
    output, input: names of the signals;  unit: of output per input
    noise: "output": S_xy / S_xx, right where the input is free of noise; "both": |H| in the middle
        of the two bounds, and its interval contains both
    raises ModelError: signals of different lengths, or too short for six windows
    """
    sources, results = _stretches(input_signal), _stretches(output_signal)
    pairs = list(zip(sources, results, strict=False))
    if len(sources) != len(results) or any(x.shape != y.shape or x.ndim != 1 for x, y in pairs):
        raise ModelError("recorded_response: expected an input and an output of the same length")
    longest, whole = max(len(x) for x, _ in pairs), sum(len(x) for x, _ in pairs)
    rows = round(window / sample_time) if window else whole // 8
    rows = min(rows, longest)
    starts = [
        (k, a)
        for k, (x, _) in enumerate(pairs)
        for a in range(0, len(x) - rows + 1, rows // 2 or 1)
    ]
    if len(starts) < WINDOWS or rows < 16:
        raise ModelError(
            f"recorded_response: found {len(starts)} windows of {rows} samples, expected at least "
            f"{WINDOWS} of 16"
        )
    f, spectra = _spectra(pairs, starts, rows, sample_time)
    # the two lowest lines hold what is left of the trend
    used = (f >= 2 * f[1]) & (f <= (up_to or 0.25 / sample_time))
    return _response(
        _bands_of(f[used], [one[used] for one in spectra]),
        OF_WINDOWS * len(starts),
        noise,
        (output, input, unit),
    )


def _spectra(
    pairs: Sequence[tuple[Array, Array]],
    starts: Sequence[tuple[int, int]],
    rows: int,
    sample_time: float,
) -> tuple[Array, list[NDArray[np.complex128]]]:
    """Frequency of each line (Hz), and mean spectra of input, output and both over the windows.

    starts: of each window, its stretch and its first sample
    """
    hann = np.hanning(rows + 1)[:-1]
    lines = np.array(
        [
            [np.fft.rfft(hann * _without_trend(signal[a : a + rows])) for signal in pairs[k]]
            for k, a in starts
        ]
    )
    x, y = lines[:, 0], lines[:, 1]
    products = (np.abs(x) ** 2, np.abs(y) ** 2, np.conj(x) * y)
    means = [np.asarray(np.mean(one, axis=0), dtype=complex) for one in products]
    return np.asarray(np.fft.rfftfreq(rows, sample_time), dtype=float), means


def _response(
    bands: tuple[Array, Array, Array, NDArray[np.complex128], Array],
    windows: float,
    noise: Literal["output", "both"],
    names: tuple[str, str, str],
) -> FrequencyResponse:
    """The response with its errors; bands: as `_bands_of`;  names: output, input and unit."""
    at, xx, yy, xy, averages = bands
    n = windows * averages
    coherence = np.clip(np.abs(xy) ** 2 / (xx * yy), 1e-12, 1.0)
    phase_error = np.sqrt((1.0 - coherence) / (2.0 * n * coherence))
    values, error = xy / xx, phase_error
    if noise == "both":
        half = -0.5 * np.log(coherence)
        values, error = values * np.exp(half), error + half / NINETY_FIVE
    # 95 % of the coherences of signals that have nothing in common are below it
    sure = coherence > 1.0 - 0.05 ** (1.0 / np.maximum(n - 1.0, 0.1))
    phase = np.full(len(at), np.nan)
    if sure.any():
        phase[sure] = phase_of(values[None, sure], at[sure])[0]
    return FrequencyResponse(
        ("measured",),
        at,
        np.where(sure, np.abs(values), np.nan)[None, :],
        phase[None, :],
        names[2],
        *names[:2],
        left_out={},
        measured=True,
        band=ResponseBand(error[None, :], np.degrees(phase_error)[None, :]),
        coherence=coherence[None, :],
    )


def _stretches(signal: Array | Sequence[Array]) -> list[Array]:
    each = [signal] if isinstance(signal, np.ndarray) else signal
    return [np.asarray(one, dtype=float) for one in each]


def _without_trend(values: Array) -> Array:
    """The values less their straight line, (n,)."""
    at = np.linspace(-1.0, 1.0, len(values))
    return values - np.mean(values) - at * (at @ values) / (at @ at)


def _bands_of(
    f: Array, spectra: Sequence[NDArray[np.complex128]]
) -> tuple[Array, Array, Array, NDArray[np.complex128], Array]:
    """Middle of each band (Hz), spectra of input, output and both in it, and its averages."""
    band = np.floor(BANDS * np.log10(f / f[0])).astype(int)
    _, first, lines = np.unique(band, return_index=True, return_counts=True)
    xx, yy, xy, middle = (np.add.reduceat(one, first) / lines for one in (*spectra, f))
    good = (np.abs(xx) > 0) & (np.abs(yy) > 0)
    averages: Array = np.maximum(OF_LINES * lines, 1.0)
    xx, yy, middle = (np.real(one[good]) for one in (xx, yy, middle))
    return middle, xx, yy, np.asarray(xy[good], dtype=complex), averages[good]
