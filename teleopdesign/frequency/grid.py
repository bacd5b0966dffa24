"""Points at which an impedance is measured or predicted: frequencies and amplitudes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..base.errors import ModelError
from ..diagrams import Diagram

if TYPE_CHECKING:
    import xarray

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


def cases_of(diagrams: Diagram | Mapping[str, Diagram]) -> dict[str, Diagram]:
    """Case -> diagram; a single diagram has its name as case. Raises ModelError: no diagram."""
    if isinstance(diagrams, Diagram):
        return {diagrams.name: diagrams}
    if not diagrams:
        raise ModelError("diagrams: found none, expected a diagram, or several by case")
    return dict(diagrams)
