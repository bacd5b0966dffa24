"""The result of a study: one labelled data set, and its figures."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ExperimentError, ModelError, unknown
from ..base.files import write_beside
from ..base.frozen import ByName, ByValue
from ..base.shown import Shown
from .outcomes import PointOutcome
from .plots import StudyPlots
from .points import SAMPLE, Points

if TYPE_CHECKING:
    import xarray

#: name of the variable with the reason of a failed point; "" for a point that did not fail
REASON = "failure"
#: s: for reading a file in a process apart, beside `_RATE` bytes in a second, until it is ended. A
#: study of 10 000 points takes 0.1 s; a machine may be busy
_LONGEST, _RATE = 20.0, 5e7
#: most bytes of all variables of a file, because they are read into memory: twenty measures over
#: ten million points
LARGEST = 1.6e9


def without_reason(names: Iterable[str]) -> list[str]:
    """The names that a misspelt measure or parameter may stand for: "value" is near "failure"."""
    return [n for n in names if n != REASON]


@dataclass(frozen=True, eq=False, repr=False)
class Study(Shown, ByName, ByValue):
    """Measures over the points of a study.

    data: one variable for each measure over the axes, NaN (or "") where the point failed, and
        `failure` with the reason. Parameters of jointly drawn points are coordinates over `sample`.
        Units are attributes of variables; attributes of the data set: fixed values, settings, seed,
        versions, hashes
    """

    data: xarray.Dataset

    def _names(self) -> list[str]:
        return [str(n) for n in self.data.variables]

    def __getitem__(self, name: str) -> xarray.DataArray:
        if name not in self.data:
            if not self.measures:
                most = next(iter(self.failures), "the measures give no value")
                raise ModelError(f"study: every point failed, most: {most}")
            known = without_reason(self._names())
            raise ModelError(f"study: {unknown('measure or parameter', name, known)}")
        return self.data[name]

    @property
    def measures(self) -> tuple[str, ...]:
        """Names of the measures."""
        return tuple(str(n) for n in self.data.data_vars if n != REASON)

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the parameters that vary."""
        return tuple(json.loads(self.data.attrs["axes"]))

    @property
    def failures(self) -> dict[str, int]:
        """Reason -> number of points that failed, most frequent first."""
        reasons, counts = np.unique(self.data[REASON].values.astype(str), return_counts=True)
        counted = {str(r): int(n) for r, n in zip(reasons, counts, strict=True) if r}
        return dict(sorted(counted.items(), key=lambda one: -one[1]))

    def sensitivity(self, measure: str = "") -> xarray.Dataset:
        """Sobol indices of the parameters for a measure: see `sensitivity`."""
        from .sensitivity import sensitivity

        return sensitivity(self, measure)

    @property
    def plot(self) -> StudyPlots:
        """Figures: .curves(), .map(), .panels(), .sensitivity(); .plot() selects a suitable one."""
        return StudyPlots(self.data)

    def to_netcdf(self, path: str | Path) -> None:
        """Write the study to a netCDF file, which `read_study` reads.

        raises ExperimentError: the file cannot be written, or h5netcdf is not installed
        """
        check_netcdf()
        with write_beside(path) as part:
            self.data.to_netcdf(part, engine="h5netcdf")


@check_types
def read_study(path: str | Path) -> Study:
    """Read a study from a file.

    raises ExperimentError: the file cannot be read, or holds no study
    """
    import xarray

    check_netcdf()
    if not Path(path).is_file():
        raise ExperimentError(f"{path}: no such file")
    try:
        _read_on_trial(path)
        data = xarray.load_dataset(path, engine="h5netcdf")
    except ExperimentError:
        raise
    except Exception as error:  # a damaged file can fail in any of the three packages that read it
        why = " ".join(str(error).split()) or type(error).__name__
        raise ExperimentError(f"{path}: no study can be read: {why}") from error
    attributes = [data.attrs.get(n) for n in ("study", "model", "axes")]
    if REASON not in data or not all(isinstance(text, str) for text in attributes):
        raise ExperimentError(f"{path}: holds no study")
    axes = None
    with suppress(ValueError, RecursionError):
        axes = json.loads(data.attrs["axes"])
    if not isinstance(axes, list) or not all(isinstance(a, str) and a in data for a in axes):
        raise ExperimentError(f"{path}: axes: expected a list of names of variables, as JSON")
    return Study(data)


#: source of a program that reads all of a file, and prints how many bytes the file states: blocks
#: that were not written take no space. What h5py refuses, the reader of the study reports
_READ = """
import sys, h5py
total = 0
def look(name, item):
    global total
    for key in item.attrs:
        item.attrs[key]
    if isinstance(item, h5py.Dataset):
        total += (size := item.size * item.dtype.itemsize)
        if size <= {largest!r}:
            item[()]
try:
    with h5py.File(sys.argv[1]) as file:
        look("", file)
        file.visititems(look)
except Exception:
    pass
print(total)
"""


def _read_on_trial(path: str | Path) -> None:
    """Read a file once in a process apart: a damaged one may end or block the HDF5 library.

    raises ExperimentError: the library ends the process, or does not come to an end; too much data
    """
    program = [sys.executable, "-c", _READ.format(largest=LARGEST), os.fspath(path)]
    try:
        most = _LONGEST + os.stat(path).st_size / _RATE
        done = subprocess.run(program, capture_output=True, timeout=most)
        total = -1 if done.returncode else int(done.stdout or 0)
    except subprocess.TimeoutExpired:
        total = -1
    if total < 0:
        raise ExperimentError(
            f"{path}: no study can be read: the file is damaged, the HDF5 library comes to no end "
            "with it"
        )
    if total > LARGEST:
        raise ExperimentError(
            f"{path}: found {total:.3g} bytes of data, expected at most {LARGEST:g}"
        )


def check_netcdf() -> None:
    """Raise ExperimentError if netCDF files cannot be written."""
    from importlib.util import find_spec

    if find_spec("h5netcdf") is None:
        raise ExperimentError("a netCDF file needs h5netcdf: pip install 'teleopdesign[studies]'")


def label_outcomes(
    points: Points,
    outcomes: Mapping[int, PointOutcome],
    *,
    units: Mapping[str, str],
    attributes: Mapping[str, Any],
) -> Study:
    """Outcomes of all points as one data set, which depends only on the arguments.

    The first point that did not fail decides the form of the measures; a point with other names,
    units or dimensions has failed.
    """
    import xarray

    n = len(points)
    form, reasons = _form_of(outcomes, n)
    coordinates: dict[str, Any] = {}
    for name, column in points.columns.items():
        values = column.values
        coordinates[name] = ((column.dimension,), values, {"units": units.get(name, "1")})
    if SAMPLE in points.sizes:
        coordinates[SAMPLE] = ((SAMPLE,), np.arange(points.sizes[SAMPLE]), {"units": "1"})
    arrays = []
    for _, kind, _, _, *over in form:
        width = (len(over[1]),) if over else ()
        empty = "" if kind == "text" else np.nan
        arrays.append(np.full((n, *width), empty, dtype=_DTYPES[kind]))
    for i in range(n):
        if not reasons[i]:
            for array, value in zip(arrays, outcomes[i].values, strict=True):
                array[i] = value
    data: dict[str, Any] = {}
    for values, (name, _, unit, text, *over) in zip(arrays, form, strict=True):
        dims = tuple(points.sizes)
        if over:
            dimension, along, along_unit = over
            dims = (*dims, dimension)
            coordinates[dimension] = ((dimension,), np.array(along), {"units": along_unit})
        shaped = values.reshape((*points.shape, *values.shape[1:]))
        data[name] = (dims, shaped, {"units": unit, "text": text})
    data[REASON] = (
        tuple(points.sizes),
        reasons.reshape(points.shape),
        {"text": "why the point failed, empty where it did not"},
    )
    return Study(xarray.Dataset(data, coordinates, dict(attributes)))


def _form_of(
    outcomes: Mapping[int, PointOutcome], many: int
) -> tuple[list[tuple[Any, ...]], np.ndarray]:
    """Form of the measures, and for each point the reason of its failure, or ""."""
    first = next((o.form for i in range(many) if not (o := outcomes[i]).reason), ())
    units = ["" for _ in first]
    verdicts: dict[tuple[Any, ...], str] = {}  # few forms, many points
    reasons = []
    for i in range(many):
        outcome = outcomes[i]
        if not outcome.reason and outcome.form not in verdicts:
            verdicts[outcome.form] = _explain_misfit(first, outcome.form, units)
        reasons.append(outcome.reason or verdicts[outcome.form])
    form = [
        (name, kind, unit or "1", text, *over)
        for (name, kind, _, text, *over), unit in zip(first, units, strict=True)
    ]
    return form, np.array(reasons, dtype=object)


def _explain_misfit(first: tuple[Any, ...], form: tuple[Any, ...], units: list[str]) -> str:
    """Why a form does not fit the first one; "" if it fits. Units that were unknown are noted."""
    if [(f[0], f[1], *f[4:]) for f in form] != [(f[0], f[1], *f[4:]) for f in first]:
        return "the measures give other names or dimensions than at the first point"
    for k, (name, _, unit, *_rest) in enumerate(form):
        if unit and units[k] and unit != units[k]:
            return f"{name} is in {unit}, at the first point in {units[k]}"
        units[k] = units[k] or unit
    return ""


_DTYPES: Mapping[str, Any] = {"text": object, "number": float}
