"""A frequency response from recorded signals, with its coherence and standard errors.

Spectra are averaged over windows (Welch) and narrow bands of frequency. The coherence
c = |S_xy|^2 / (S_xx S_yy) is the part of the output's power that a linear response to the input
explains; friction lowers it like a disturbance. Noise of the input makes S_xy / S_xx too small,
noise of the output S_yy / S_yx too large: |H| is in the middle, and its interval contains both.
With n independent averages the further standard error of ln |H|, and that of the phase (rad), is
sqrt((1 - c) / (2 n c)); Bendat and Piersol, Random Data, 2010, table 9.6.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

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
