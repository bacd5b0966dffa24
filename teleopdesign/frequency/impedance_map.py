"""An impedance over case, frequency and amplitude, and its deviation from a linear one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..base.errors import ModelError
from ..base.files import write_json, write_netcdf
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..base.units import unit_of
from ..diagrams import Diagram
from ..diagrams.units import first_axis
from .confidence import ParameterCovariance, ResponseBand, confidence_band
from .quasi_linear import QuasiLinearForm
from .response import cases_of

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray


@dataclass(frozen=True, eq=False)
class ImpedanceMap(Shown, ByValue):
    """Impedance relative to position over `case`, `frequency` (Hz) and, on a grid, `amplitude`.

    data: `impedance`, complex, force per position; spring 0, damper and friction 90, mass 180 deg

    The coordinate `amplitude` (of the drive) depends on `frequency` if it follows a profile. A
    measured map also has `distortion` of the force, the rms of its higher harmonics over that of
    the first; `unsettled`, the relative difference of the first harmonics of successive cycles; and
    `motion_amplitude` (m or rad) of the motion itself. A map of a fitted device may have
    `magnitude_error` (relative) and `phase_error` (deg): standard errors, drawn as bands of 95 %.
    """

    data: xarray.Dataset

    @property
    def on_profile(self) -> bool:
        """Whether the amplitude depends on the frequency instead of being varied separately."""
        return "amplitude" not in self.data["impedance"].dims

    @property
    def decibel(self) -> xarray.DataArray:
        """20 log10 of the magnitude, dB re 1 N/m (N m/rad on a revolute axis)."""
        z = self.data["impedance"]
        size = 20 * np.log10(np.abs(z.values))
        return z.copy(data=size).assign_attrs(units=f"dB re 1 {z.attrs['units']}")

    @property
    def phase(self) -> xarray.DataArray:
        """Phase in degrees, 0 to 360."""
        angle = np.degrees(np.angle(self.data["impedance"])) % 360
        return self.data["impedance"].copy(data=angle).assign_attrs(units="deg")

    @property
    def measured(self) -> bool:
        """Whether the map was measured, in simulation or on a device; else it was predicted."""
        return "distortion" in self.data

    @property
    def band(self) -> ResponseBand | None:
        """Standard errors over the dimensions of the impedance; None: not known."""
        if "magnitude_error" not in self.data:
            return None
        return ResponseBand(self.data["magnitude_error"].values, self.data["phase_error"].values)

    def up_to(self, largest: Callable[[np.ndarray], np.ndarray]) -> ImpedanceMap:
        """The map where the amplitude is at most largest(frequency in Hz); NaN elsewhere."""
        limit = self.data["frequency"].copy(data=largest(self.data["frequency"].values))
        return ImpedanceMap(self.data.where(self.data["amplitude"] <= limit))

    def spread(self) -> xarray.Dataset:
        """Deviation from a linear system: range of magnitude (dB) and phase (deg) over amplitude.

        0 for a linear system;  over `case` and `frequency`
        raises ModelError: the amplitude follows a profile over frequency
        """
        import xarray

        if self.on_profile:
            raise ModelError(
                "spread: the amplitude is a function of frequency, expected amplitudes on a grid"
            )
        z, size = self.data["impedance"], self.decibel
        turned = np.degrees(np.unwrap(np.angle(z), axis=z.get_axis_num("amplitude")))
        turn = z.copy(data=turned)
        return xarray.Dataset(
            {
                "size": (size.max("amplitude") - size.min("amplitude")).assign_attrs(units="dB"),
                "phase": (turn.max("amplitude") - turn.min("amplitude")).assign_attrs(units="deg"),
            }
        )

    def plot(
        self,
        against: Literal["frequency", "amplitude", ""] = "",
        *,
        model: ImpedanceMap | None = None,
        columns: Literal[1, 2] = 1,
    ) -> matplotlib.figure.Figure:
        """Magnitude and phase, one line for each case, in shades for the other variable.

        against: "frequency" or "amplitude"; default: amplitude if it has more values
        model: drawn as lines; this map is then drawn as points
        columns: of the page, 3.5 in or 7.16 in wide
        """
        more = not self.on_profile and self.data.sizes["amplitude"] > self.data.sizes["frequency"]
        chosen: Literal["frequency", "amplitude"] = "amplitude" if more else "frequency"
        return figure_of(self, against=against or chosen, model=model, columns=columns)

    def to_netcdf(self, path: str | Path) -> None:
        """Write all data with units to a netCDF file, the impedance as real and imaginary part."""
        z = self.data["impedance"]
        both = {"real": z.real, "imaginary": z.imag}
        parts = {f"impedance_{n}": p.assign_attrs(z.attrs) for n, p in both.items()}
        write_netcdf(path, self.data.drop_vars("impedance").assign(parts))

    def to_json(self, path: str | Path) -> None:
        """Write magnitude, phase, distortion and settling of all points to JSON, with units."""
        written = {
            "unit": self.decibel.attrs["units"],
            "frequency_Hz": self.data["frequency"].values.tolist(),
            "amplitude": self.data["amplitude"].values.tolist(),
            "amplitude_unit": self.data["amplitude"].attrs["units"],
        }
        tables = {"size": self.decibel, "phase_deg": self.phase}
        tables |= {n: self.data[n] for n in ("distortion", "unsettled") if n in self.data}
        cases = {
            str(case): {name: _round_values(t.sel(case=case).values) for name, t in tables.items()}
            for case in self.data["case"].values
        }
        write_json(path, {**written, "cases": cases})


def _round_values(values: np.ndarray) -> list[object]:
    """Values with five digits, the same on every machine; None for a value that is no number."""
    numbers = [float(f"{x:.5g}") if np.isfinite(x) else None for x in values.reshape(-1)]
    entries: list[object] = np.array(numbers, dtype=object).reshape(values.shape).tolist()
    return entries


Amplitude = float | Sequence[float] | np.ndarray | Callable[[np.ndarray], np.ndarray]


def falling_profile(
    amplitude: float, *, exponent: float = 0.8
) -> Callable[[np.ndarray], np.ndarray]:
    """The profile amplitude * (f / 1 Hz)^-exponent; 0.8 is that of figure 7 of the paper.

    amplitude: at 1 Hz, m or rad;  returns: frequency (n,), Hz -> amplitude (n,), m or rad
    """
    return lambda frequency: amplitude * np.asarray(frequency, dtype=float) ** -exponent


@dataclass(frozen=True)
class Grid:
    """Points of a map: each amplitude with each frequency, or an amplitude for each frequency."""

    frequency: np.ndarray
    amplitude: np.ndarray
    on_profile: bool

    @staticmethod
    def of(amplitude: Amplitude, frequency: float | Sequence[float] | np.ndarray) -> Grid:
        """The grid for a user's numbers; raises ModelError: numbers that are not positive."""
        f = _positive("frequency", frequency)
        if callable(amplitude):
            return Grid(f, _positive("amplitude", amplitude(f)), True)
        return Grid(f, _positive("amplitude", amplitude), False)

    @property
    def dims(self) -> tuple[str, ...]:
        return ("frequency",) if self.on_profile else ("frequency", "amplitude")

    @property
    def points(self) -> list[tuple[tuple[int, ...], float, float]]:
        """Index, amplitude and frequency of each point."""
        if self.on_profile:
            both = zip(self.amplitude, self.frequency, strict=True)
            return [((i,), float(a), float(f)) for i, (a, f) in enumerate(both)]
        return [
            ((i, j), float(a), float(f))
            for i, f in enumerate(self.frequency)
            for j, a in enumerate(self.amplitude)
        ]

    def label(
        self, values: Mapping[str, tuple[np.ndarray, str]], *, cases: Sequence[str], length: str
    ) -> xarray.Dataset:
        """Values (cases, ...) with their units as a data set; length: unit of amplitude."""
        import xarray

        dims = ("case", *self.dims)
        coordinates = {
            "case": list(cases),
            "frequency": ("frequency", self.frequency, {"units": "Hz"}),
            "amplitude": (self.dims[-1], self.amplitude, {"units": length}),
        }
        data = {name: (dims, array, {"units": unit}) for name, (array, unit) in values.items()}
        return xarray.Dataset(data, coordinates)


def _positive(what: str, values: float | Sequence[float] | np.ndarray) -> np.ndarray:
    array = np.atleast_1d(np.asarray(values, dtype=float))
    if array.ndim != 1 or not array.size or not (np.isfinite(array) & (array > 0)).all():
        raise ModelError(f"{what}: found {values}, expected positive numbers")
    return array


def quasi_linear_impedance(
    diagrams: Diagram | Mapping[str, Diagram],
    *,
    amplitude: Amplitude,
    frequency: float | Sequence[float] | np.ndarray,
    motion: str = "L",
    force: str = "E",
    covariance: ParameterCovariance | None = None,
) -> ImpedanceMap:
    """Impedance Zhat_M that a hand feels over frequency and amplitude, without simulation.

    Arguments are those of `measured_impedance`, with a prescribed motion; controllers are
    continuous.

    covariance: of fitted parameters, such as `diagnosis.covariance()`: the map has a band
    raises ModelError: a block without laws or without describing function
    """
    cases = cases_of(diagrams)
    grid = Grid.of(amplitude, frequency)
    shape = tuple(len(getattr(grid, n)) for n in grid.dims)
    _, sizes, frequencies = (np.array(one) for one in zip(*grid.points, strict=True))

    def impedance(diagram: Diagram) -> np.ndarray:
        form = QuasiLinearForm(diagram, motion, force, motion, motion)
        return form.values(sizes, frequencies).reshape(shape)

    axis = first_axis(next(iter(cases.values())))
    z = np.array([impedance(diagram) for diagram in cases.values()])
    values = {"impedance": (z, unit_of("stiffness", axis))}
    if covariance is not None:
        band = confidence_band(impedance, cases.values(), covariance)
        values |= {"magnitude_error": (band.log_magnitude, "1"), "phase_error": (band.phase, "deg")}
    data = grid.label(values, cases=list(cases), length=unit_of("position", axis))
    data.attrs |= {"motion": motion, "force": force}
    return ImpedanceMap(data)
