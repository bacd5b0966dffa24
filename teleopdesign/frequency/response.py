"""Frequency response between signals: the symbolic transfer function with values inserted.

From several inputs to several outputs the same equations are solved at each frequency instead: the
symbolic forms of a diagram of many axes would fill pages.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..base.errors import ModelError, did_you_mean
from ..base.files import write_netcdf
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..derive import symbol_values, with_values
from ..derive.elimination import rows
from ..diagrams import Diagram, Moving
from ..realise.lti import linear_blocks, numerical
from ..realise.parted import linear_parted
from ..realise.tips import linear_tips

if TYPE_CHECKING:
    import control
    import matplotlib.figure
    import xarray


Array = NDArray[np.float64]
#: powers of frequency between which a magnitude lies, and the highest phase (deg) at its start:
#: limits halfway between whole powers
_STARTS = (
    (-np.inf, -2.5, 89.0), (-2.5, -0.5, 91.0), (0.5, 2.5, 269.0), (2.5, np.inf, 271.0),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class FrequencyResponse(Shown, ByValue):
    """Magnitude and phase of each case over frequency.

    The phase of a magnitude that falls begins from -270 to 90 degrees, of one that rises from -90
    to 270, of a level one from -180 to 180: a mass has -180 degrees from force to position.

    frequency: Hz, (n,);  magnitude: in `unit`, (cases, n);  phase: degrees, unwrapped, (cases, n)
    output, input: signals;  left_out: case -> names without linear form
    speed: m/s or rad/s, at which smoothed friction and schedules are frozen
    measured: whether the response was measured: it is drawn as points instead of lines
    """

    cases: tuple[str, ...]
    frequency: Array
    magnitude: Array
    phase: Array
    unit: str
    output: str
    input: str
    left_out: Mapping[str, tuple[str, ...]]
    speed: float = 0.0
    measured: bool = False

    @cached_property
    def data(self) -> xarray.Dataset:
        """Magnitude and phase over `case` and `frequency`, with their units."""
        import xarray  # its import takes longer than a Bode plot

        dims = ("case", "frequency")
        further = {"measured": 1} if self.measured else {"speed": self.speed}
        return xarray.Dataset(
            {
                "magnitude": (dims, self.magnitude, {"units": self.unit}),
                "phase": (dims, self.phase, {"units": "deg"}),
            },
            {"case": list(self.cases), "frequency": ("frequency", self.frequency, {"units": "Hz"})},
            {"output": self.output, "input": self.input, **further},
        )

    def row(self, case: str = "") -> int:
        """Row of a case (default: the first) in magnitude and phase.

        raises ModelError: no case of that name
        """
        if case and case not in self.cases:
            raise ModelError(
                f'frequency response: no case "{case}", has {", ".join(self.cases)}'
                f"{did_you_mean(case, self.cases)}"
            )
        return self.cases.index(case) if case else 0

    def values(self, case: str = "") -> NDArray[np.complex128]:
        """Complex response over frequency, (n,), of a case; default: the first."""
        k = self.row(case)
        return np.asarray(self.magnitude[k] * np.exp(1j * np.radians(self.phase[k])))

    def is_zero(self, case: str = "") -> bool:
        """Whether a case (default: the first) is zero at every frequency: it has no decibels."""
        return not self.magnitude[self.row(case)].any()

    def as_frd(self, case: str = "") -> control.FrequencyResponseData:
        """A case (default: the first) as python-control frequency response data, in rad/s."""
        from ..base import python_control as control

        return control.frd(self.values(case), 2 * np.pi * self.frequency)

    def plot(
        self, *, measured: FrequencyResponse | None = None, columns: Literal[1, 2] = 1
    ) -> matplotlib.figure.Figure:
        """Bode plot, one line for each case.

        measured: drawn as points in the same plot;  columns: of the page, 3.5 in or 7.16 in wide
        """
        return figure_of(self, measured=measured, columns=columns)

    def plot_nyquist(
        self, *, measured: FrequencyResponse | None = None, columns: Literal[1, 2] = 1
    ) -> matplotlib.figure.Figure:
        """Plot the imaginary against the real part, one line for each case; see `plot`."""
        return figure_of(self, kind="nyquist", measured=measured, columns=columns)

    def to_netcdf(self, path: str | Path) -> None:
        """Write magnitude and phase with their units to a netCDF file."""
        write_netcdf(path, self.data)


def bode(
    diagrams: Diagram | Mapping[str, Diagram],
    *,
    output: str = "R_M",
    input: str = "R_D",
    given: str | tuple[str, ...] = "",
    frequency: np.ndarray | Sequence[float] | None = None,
    speed: float = 0.0,
) -> FrequencyResponse:
    """Frequency response from one signal to another, for one diagram or several cases.

    A controller in discrete time is sampled and held, up to half its sampling rate.

    given: prescribed motions; output "E", input and given "L" give the apparent mechanism impedance
        Zhat_M. For a body with a compliant transmission, the motion of the tip is prescribed
    frequency: Hz, default 0.1 to 1000
    speed: m/s or rad/s, at which smoothed friction and schedules are frozen
    """
    cases = cases_of(diagrams)
    f = np.geomspace(0.1, 1000.0, 2001) if frequency is None else np.asarray(frequency, dtype=float)
    if f.ndim != 1 or not np.all(np.isfinite(f)) or np.any(f < 0):
        raise ModelError("bode: frequency: expected numbers in Hz from 0, in one row")
    rows, left_out = [], {}
    for name, diagram in cases.items():
        expression, linear = with_values(
            diagram, output=output, input=input, given=given, speed=speed, held=True
        )
        rows.append(numerical(expression)(2j * np.pi * f))
        left_out[name] = linear.left_out
    values = np.array(rows)
    return FrequencyResponse(
        tuple(cases),
        f,
        np.abs(values),
        phase_of(values, f),
        ratio_unit(linear_tips(diagram), output, input),
        output,
        input,
        left_out,
        speed=abs(speed),
    )


def phase_of(values: NDArray[np.complex128], frequency: Array) -> Array:
    """Phase (degrees, unwrapped) of complex values (cases, n) over frequency (n,) in Hz."""
    phase = np.degrees(np.unwrap(np.angle(values), axis=1))
    turns = (phase[:, 0] - _highest_start(np.abs(values), frequency)) / 360
    return np.asarray(phase - 360 * np.ceil(turns)[:, None])


def _highest_start(size: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Highest phase (deg) at which the phase of each magnitude (cases, n) may begin.

    A magnitude that falls begins from -270 to 90 degrees, one that rises from -90 to 270, a level
    one from -180 to 180: so a mass has -180 degrees from force to position, and 180 back. The ends
    differ by a degree, because such a phase is computed on either side of it: a third power may
    have 270 degrees, an integrator with a gain below 0 has 90.
    """
    first = np.flatnonzero(frequency > 0)[:2]
    highest = np.full(len(size), 181.0)
    if len(first) < 2 or not frequency[first[0]] < frequency[first[1]]:
        return highest
    with np.errstate(all="ignore"):
        ratio = np.log(size[:, first[1]] / size[:, first[0]])
    steepness = ratio / np.log(frequency[first[1]] / frequency[first[0]])
    for least, most, high in _STARTS:
        highest[(least < steepness) & (steepness < most)] = high
    return highest


def ratio_unit(diagram: Diagram, output: str, source: str) -> str:
    """Unit of one signal over another; "1" if their units are equal."""
    from ..simulate.units import signal_units

    units = signal_units(diagram)
    above, below = units(output), units(source)
    return "1" if above == below else f"{above}/{below}"


def cases_of(diagrams: Diagram | Mapping[str, Diagram]) -> dict[str, Diagram]:
    """Case -> diagram; a single diagram has its name as case. Raises ModelError: no diagram."""
    if isinstance(diagrams, Diagram):
        return {diagrams.name: diagrams}
    if not diagrams:
        raise ModelError("diagrams: found none, expected a diagram, or several by case")
    return dict(diagrams)


@dataclass(frozen=True, eq=False)
class MatrixResponse(Shown, ByValue):
    """Response of several outputs to several inputs.

    data: complex, over frequency (Hz), output and input;  left_out: names without linear form
    """

    data: xarray.DataArray
    left_out: tuple[str, ...]

    def singular_values(self) -> np.ndarray:
        """Gains over all directions, (frequencies, min(outputs, inputs)), largest first."""
        return np.linalg.svd(self.data.values, compute_uv=False)

    def frd(self) -> control.FRD:
        """The response as a python-control frequency response."""
        from ..base import python_control as control

        values = np.moveaxis(self.data.values, 0, -1)
        return control.frd(values, 2 * np.pi * self.data["frequency"].values)


def matrix_response(
    diagram: Diagram,
    outputs: Sequence[str],
    inputs: Sequence[str],
    frequency: np.ndarray | Sequence[float],
    *,
    given: Sequence[str] = (),
    speed: float = 0.0,
) -> MatrixResponse:
    """Response of each output to each input, with all other inputs zero.

    frequency: (n,), Hz
    given: prescribed motions, in place of the forces that drive them; for a body with a compliant
        transmission, the motion of its tip
    speed: at which smoothed friction and schedules are frozen, m/s or rad/s
    raises ModelError: an unknown signal, an input that is not free, a loop without a solution
    """
    import xarray

    diagram, led = linear_parted(diagram, tuple(given))
    inputs, outputs = ([led.get(n, n) for n in names] for names in (inputs, outputs))
    given = list(led.values())
    drivers = {b.motion: b.driver for b in diagram.blocks if isinstance(b, Moving)}
    free = [s for s in diagram.outside if s not in {drivers.get(m) for m in given}]
    free += given
    for name in (*outputs, *inputs):
        diagram.signal(name)
    if bound := [name for name in inputs if name not in free]:
        raise ModelError(f'{diagram.name}: signal "{bound[0]}" is not from outside')
    unknown = [s for s in diagram.signals if s not in free]
    form = linear_blocks(diagram, speed=speed, held=True)
    values = symbol_values(form)
    s = 2j * np.pi * np.asarray(frequency, dtype=float)
    system = rows(diagram)
    matrix = np.zeros((len(s), len(system), len(unknown)), dtype=complex)
    right = np.zeros((len(s), len(system), len(inputs)), dtype=complex)
    for i, row in enumerate(system):
        for name, coefficient in row.items():
            target, names, sign = (right, inputs, -1) if name in inputs else (matrix, unknown, 1)
            if name in names:
                over = numerical(sp.sympify(coefficient).xreplace(values))
                target[:, i, names.index(name)] = sign * over(s)
    try:
        solved = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        raise ModelError(f"{diagram.name}: the wiring does not determine all signals") from None
    # a free signal responds to itself
    chosen = [
        solved[:, unknown.index(o)]
        if o in unknown
        else np.tile(np.array([complex(o == i) for i in inputs]), (len(s), 1))
        for o in outputs
    ]
    data = xarray.DataArray(
        np.stack(chosen, axis=1),
        {
            "frequency": ("frequency", np.asarray(frequency), {"units": "Hz"}),
            "output": list(outputs),
            "input": list(inputs),
        },
        ("frequency", "output", "input"),
    )
    return MatrixResponse(data, form.left_out)
