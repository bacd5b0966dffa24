"""Frequency response between signals: the symbolic transfer function with values inserted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ModelError, did_you_mean
from ..base.files import write_netcdf
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..derive import with_values
from ..diagrams import Diagram
from ..realise.lti import numerical
from ..realise.tips import linear_tips
from .confidence import ParameterCovariance, ResponseBand, confidence_band
from .frozen_friction import cancellations_left_over, growing_modes, with_frozen_friction

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
    speed: m/s or rad/s, at which friction, its cancellation and schedules are frozen
    amplitude: m or rad, of the motion for which nonlinear laws have their first harmonic; 0: none
    unstable: case -> modes of the whole diagram that grow, in words; "" where none does, and no
        entry where that is not known
    left_over: case -> controllers that cancel friction while friction is left out
    measured: whether the response was measured: it is drawn as points instead of lines
    band: standard errors, drawn as a band of 95 %, or as bars at points; None: not known
    coherence: of a measured response, (cases, n), 0 to 1; None: not known
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
    amplitude: float = 0.0
    unstable: Mapping[str, str] = field(default_factory=dict)
    left_over: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    band: ResponseBand | None = None
    coherence: Array | None = None

    @cached_property
    def data(self) -> xarray.Dataset:
        """Magnitude, phase, standard errors and coherence over `case` and `frequency`, with units.

        The standard error of the magnitude is relative.
        """
        import xarray  # its import takes longer than a Bode plot

        dims = ("case", "frequency")
        further = {"measured": 1} if self.measured else {"speed": self.speed}
        made = {"magnitude": (self.magnitude, self.unit), "phase": (self.phase, "deg")}
        if self.band is not None:
            made["magnitude_error"] = self.band.log_magnitude, "1"
            made["phase_error"] = self.band.phase, "deg"
        if self.coherence is not None:
            made["coherence"] = self.coherence, "1"
        return xarray.Dataset(
            {name: (dims, values, {"units": unit}) for name, (values, unit) in made.items()},
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
        """Bode plot, one line for each case, with its band of 95 % where the response has one.

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
    amplitude: float = 0.0,
    covariance: ParameterCovariance | None = None,
) -> FrequencyResponse:
    """Frequency response from one signal to another, for one diagram or several cases.

    Friction has no linear form. It enters as a damper at a stated speed, or by its first harmonic
    at a stated amplitude; else it is left out, and the result says so. Whether modes of the whole
    diagram grow, in continuous time, is part of the result.

    A controller in discrete time is sampled and held, up to half its sampling rate.

    given: prescribed motions; output "E", input and given "L" give the apparent mechanism impedance
        Zhat_M. For a body with a compliant transmission, the motion of the tip is prescribed
    frequency: Hz, default 0.1 to 1000
    speed: m/s or rad/s, at which friction, its cancellation and schedules are frozen
    amplitude: m or rad, of the motion "L" at every frequency: nonlinear laws have their describing
        functions there, as in `quasi_linear_impedance`; default: at 200 frequencies
    covariance: of fitted parameters, such as `diagnosis.covariance()`: the response has a band
    raises ModelError: frequencies below 0, speed and amplitude together, no describing function

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> hand = td.hand(mass=0.1, damping=5.0, stiffness=200.0)
        >>> response = td.bode(td.haptic_interface(device, hand=hand), frequency=[1.0, 10.0])
        >>> response.magnitude.round(3)
        array([[1.028, 0.343]])
    """
    cases = cases_of(diagrams)
    if amplitude and speed:
        raise ModelError("bode: speed and amplitude: found both, expected one of them")
    f = _frequencies(frequency, steps=200 if amplitude else 2001)
    signals = _Signals(output, input, given)

    def case_of(one: Diagram, stability: bool = True) -> _Case:
        if amplitude:
            return _first_harmonics(one, signals, amplitude, f)
        return _freeze(one, signals, abs(speed), f, stability=stability)

    made = {name: case_of(one) for name, one in cases.items()}
    values = np.array([one.values for one in made.values()])
    band = None
    if covariance is not None:
        band = confidence_band(lambda one: case_of(one, False).values, cases.values(), covariance)
    return FrequencyResponse(
        tuple(cases),
        f,
        np.abs(values),
        phase_of(values, f),
        ratio_unit(linear_tips(next(iter(cases.values()))), output, input),
        output,
        input,
        {name: one.left_out for name, one in made.items()},
        speed=abs(speed),
        amplitude=amplitude,
        unstable={n: one.modes for n, one in made.items() if one.modes is not None},
        left_over={name: one.left_over for name, one in made.items()},
        band=band,
    )


def _frequencies(stated: np.ndarray | Sequence[float] | None, *, steps: int) -> Array:
    """The stated frequencies, or so many steps from 0.1 to 1000 Hz."""
    f = np.geomspace(0.1, 1000.0, steps) if stated is None else np.asarray(stated, float)
    if f.ndim != 1 or not np.all(np.isfinite(f)) or np.any(f < 0):
        raise ModelError("bode: frequency: expected numbers in Hz from 0, in one row")
    return f


class _Signals(NamedTuple):
    output: str
    input: str
    given: str | tuple[str, ...]


class _Case(NamedTuple):
    """One case of a response: values over frequency, what is left out, modes that grow."""

    values: NDArray[np.complex128]
    left_out: tuple[str, ...] = ()
    left_over: tuple[str, ...] = ()
    modes: str | None = None


def _first_harmonics(diagram: Diagram, of: _Signals, amplitude: float, f: Array) -> _Case:
    from .quasi_linear import quasi_linear  # it simulates

    return _Case(quasi_linear(diagram, of.output, of.input, of.given, amplitude, f))


def _freeze(diagram: Diagram, of: _Signals, speed: float, f: Array, *, stability: bool) -> _Case:
    frozen = with_frozen_friction(diagram, speed) if speed else diagram
    expression, linear = with_values(
        frozen, output=of.output, input=of.input, given=of.given, speed=speed, held=True
    )
    modes = None if of.given or not stability else growing_modes(frozen, speed=speed)
    over = cancellations_left_over(frozen, linear.left_out)
    return _Case(numerical(expression)(2j * np.pi * f), linear.left_out, over, modes)


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
    return "1" if above == below else f"{above}/({below})" if "*" in below else f"{above}/{below}"


def cases_of(diagrams: Diagram | Mapping[str, Diagram]) -> dict[str, Diagram]:
    """Case -> diagram; a single diagram has its name as case. Raises ModelError: no diagram."""
    if isinstance(diagrams, Diagram):
        return {diagrams.name: diagrams}
    if not diagrams:
        raise ModelError("diagrams: found none, expected a diagram, or several by case")
    return dict(diagrams)
