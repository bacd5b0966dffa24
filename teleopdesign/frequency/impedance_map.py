"""An impedance over case, frequency and amplitude, and its deviation from a linear one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..base.errors import ModelError
from ..base.files import write_json, write_netcdf
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of

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
    `motion_amplitude` (m or rad) of the motion itself.
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
        parts = {f"impedance_{n}": p.assign_attrs(z.attrs) for n, p in _parts(z).items()}
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


def _parts(z: xarray.DataArray) -> dict[str, xarray.DataArray]:
    return {"real": z.real, "imaginary": z.imag}


def _round_values(values: np.ndarray) -> list[object]:
    """Values with five digits, the same on every machine; None for a value that is no number."""
    numbers = [float(f"{x:.5g}") if np.isfinite(x) else None for x in values.reshape(-1)]
    entries: list[object] = np.array(numbers, dtype=object).reshape(values.shape).tolist()
    return entries
