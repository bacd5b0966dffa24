"""Figures of parameter studies: curves, maps, small multiples, sensitivity bars. Draws, no more."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModelError, did_you_mean
from .design import ONE_COLUMN, STYLE, TWO_COLUMNS, unit_text
from .onset import hatch_region

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray
    from matplotlib.axes import Axes

    #: where a theorem holds: a measure that is "proved" there, an array that is true there, or the
    #: upper limit of y as a function of x
    Proved = str | xarray.DataArray | Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class _Overlay:
    """What is drawn over a map: see `StudyPlots.map`."""

    proved: Any
    proved_label: str
    onset: float | None
    onset_label: str


FIRST, TOTAL = "#0072B2", "#9CC7E4"
_MOST_LINES, _MOST_PANELS = 8, 9
#: ratios of neighbours that differ by less than this are those of a logarithmic axis
_EVEN = 1e-3


@dataclass(frozen=True, eq=False)
class StudyPlots:
    """Figures of a study's data: call it for what fits its axes."""

    data: xarray.Dataset

    def __call__(self, measure: str = "") -> matplotlib.figure.Figure:
        """Bars for points of `sensitivity_samples`, else curves, a map, or maps side by side."""
        if self.data.attrs.get("sampling"):
            if self.data.attrs["sampling"] == "sensitivity":
                return self.sensitivity(measure)
            return self.scatter(measure)
        grids = [n for n in self._axes if self.data.sizes[n] > 1]
        if len(grids) == 1 or not self._is_number(*grids):
            return self.curves(measure)
        return self.map(measure) if len(grids) == 2 else self.panels(measure)

    def curves(
        self, measure: str = "", *, over: str = "", at: Mapping[str, float] | None = None
    ) -> matplotlib.figure.Figure:
        """A measure over one parameter, a line for each value of a second one.

        over: parameter along the axis, default the first;  at: values of all others, the nearest is
        taken
        """
        import matplotlib.pyplot as plt

        values = self._at(self._measure(measure), at)
        dims = [str(d) for d in values.dims]
        across = over or dims[0]
        self._known(across, dims)
        each = [d for d in dims if d != across]
        if len(each) > 1:
            raise ModelError(f"study: curves: give values of all but two of {_said(dims)}: at=...")
        with plt.style.context(STYLE):
            figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.5))
            lines = self.data[each[0]].values if each else [None]
            shown = _spread(len(lines), _MOST_LINES)
            colours = plt.get_cmap("viridis")(np.linspace(0, 0.85, len(shown)))
            for colour, k in zip(colours, shown, strict=True):
                one = values.isel({each[0]: k}) if each else values
                label = f"{_number(lines[k])}" if each else None
                axis.plot(self.data[across].values, one.values, ".-", color=colour, label=label)
            self._axis(axis, "x", across)
            axis.set_ylabel(_label(values))
            if each:
                axis.legend(title=_label(self.data[each[0]]))
        return figure

    def map(
        self,
        measure: str = "",
        *,
        x: str = "",
        y: str = "",
        at: Mapping[str, float] | None = None,
        proved: Proved | None = None,
        proved_label: str = "proved",
        onset: float | None = None,
        onset_label: str = "onset, simulated",
    ) -> matplotlib.figure.Figure:
        """A measure as colour over two parameters.

        x, y: default the last two axes;  at: values of all others
        proved: hatched: where that measure is "proved", where an array over x and y is true, or
            below a limit y(x)
        onset: the line on which the measure has that value, between the points
        Points that failed stay white.
        """
        import matplotlib.pyplot as plt

        values = self._at(self._measure(measure), at)
        across, up = self._pair(values, x, y)
        over = _Overlay(proved, proved_label, onset, onset_label)
        with plt.style.context(STYLE):
            figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.9))
            mesh = self._mesh(axis, values, across, up, _limits(values, onset))
            self._marks(axis, values, (across, up), over, at)
            figure.colorbar(mesh, ax=axis, label=_label(values))
            self._legend(figure, axis)
        return figure

    def panels(
        self,
        measure: str = "",
        *,
        x: str = "",
        y: str = "",
        by: str = "",
        at: Mapping[str, float] | None = None,
        proved: Proved | None = None,
        proved_label: str = "proved",
        onset: float | None = None,
        onset_label: str = "onset, simulated",
    ) -> matplotlib.figure.Figure:
        """Maps side by side with one scale of colours, one for each value of a third parameter.

        by: that parameter, default the first axis;  others as in `map`
        """
        import matplotlib.pyplot as plt

        whole = self._measure(measure)
        third = by or str(whole.dims[0])
        self._known(third, [str(d) for d in whole.dims])
        values = self._at(whole, at)
        shown = _spread(values.sizes[third], _MOST_PANELS)
        over = _Overlay(proved, proved_label, onset, onset_label)
        across, up = self._pair(values.isel({third: 0}), x, y)
        columns = min(len(shown), 3)
        rows = -(-len(shown) // columns)
        with plt.style.context(STYLE):
            figure, axes = plt.subplots(
                rows,
                columns,
                sharex=True,
                sharey=True,
                squeeze=False,
                figsize=(TWO_COLUMNS, 0.7 + 1.9 * rows),
            )
            limits = _limits(values, onset)
            for letter, k, axis in zip("abcdefghi", shown, axes.flat, strict=False):
                one = values.isel({third: k})
                mesh = self._mesh(axis, one, across, up, limits)
                where = {**(at or {}), third: self.data[third].values[k]}
                self._marks(axis, one, (across, up), over, where)
                unit = unit_text(self.data[third].attrs.get("units", ""))
                title = (
                    f"({letter}) {self._name(third)} = {_number(self.data[third].values[k])} {unit}"
                )
                axis.set_title(title, loc="left", pad=3)
                axis.label_outer()
            for axis in axes.flat[len(shown) :]:
                axis.remove()
            figure.colorbar(mesh, ax=axes, label=_label(whole))
            self._legend(figure, axes[0, 0])
        return figure

    def scatter(self, measure: str = "") -> matplotlib.figure.Figure:
        """A measure over each parameter of points drawn together, a panel each."""
        import matplotlib.pyplot as plt

        values = self._measure(measure)
        if values.ndim != 1:
            raise ModelError("study: scatter: points drawn together alone, without further axes")
        names = self._axes[:_MOST_PANELS]
        columns = min(len(names), 4)
        rows = -(-len(names) // columns)
        with plt.style.context(STYLE):
            figure, axes = plt.subplots(
                rows,
                columns,
                sharey=True,
                squeeze=False,
                figsize=(TWO_COLUMNS, 0.5 + 1.7 * rows),
            )
            for name, axis in zip(names, axes.flat, strict=False):
                axis.plot(self.data[name].values, values.values, ".", markersize=1.5, color=FIRST)
                self._axis(axis, "x", name)
            for axis in axes.flat[len(names) :]:
                axis.remove()
            for row in axes[:, 0]:
                row.set_ylabel(_label(values))
        return figure

    def sensitivity(self, *measures: str) -> matplotlib.figure.Figure:
        """Sobol indices as bars, largest total first, a panel for each measure (default: all)."""
        import matplotlib.pyplot as plt

        from ..studies import Study, sensitivity

        study = Study(self.data)
        chosen = [m for m in measures if m] or [
            m for m in study.measures if self.data[m].dtype.kind == "f"
        ]
        indices = [sensitivity(study, m) for m in chosen]
        columns = len(chosen)
        with plt.style.context(STYLE):
            figure, axes = plt.subplots(
                1,
                columns,
                squeeze=False,
                figsize=(
                    ONE_COLUMN if columns == 1 else TWO_COLUMNS,
                    0.9 + 0.34 * len(self._axes),
                ),
            )
            for axis, name, ranked in zip(axes[0], chosen, indices, strict=True):
                ranked = ranked.isel(parameter=np.argsort(ranked["total"].values, kind="stable"))
                place = np.arange(ranked.sizes["parameter"])
                for kind, shift, colour, label in (
                    ("total", -0.19, TOTAL, "with others"),
                    ("first", 0.19, FIRST, "alone"),
                ):
                    axis.barh(
                        place + shift,
                        ranked[kind].values,
                        0.36,
                        xerr=ranked[f"{kind}_interval"].values,
                        color=colour,
                        label=label,
                        error_kw={"linewidth": 0.7},
                    )
                shown = [self._name(str(p)) for p in ranked["parameter"].values]
                axis.set_yticks(place, shown)
                axis.tick_params(axis="y", length=0)
                axis.set_xlim(min(0.0, axis.get_xlim()[0]), None)
                axis.axvline(0.0, color="black", linewidth=0.6)
                axis.set_xlabel(f"share of the variance of {self._name(name)} (1)")
            axes[0, 0].legend(loc="lower right")
        return figure

    # ---- parts --------------------------------------------------------------------------

    @property
    def _axes(self) -> list[str]:
        return list(json.loads(self.data.attrs["axes"]))

    def _name(self, name: str) -> str:
        return _words(self.data[name].attrs.get("long_name") or name)

    def _is_number(self, *names: str) -> bool:
        return all(self.data[n].dtype.kind in "biuf" for n in names)

    def _measure(self, name: str) -> xarray.DataArray:
        known = [str(n) for n in self.data.data_vars if n != "failure" and self._is_number(str(n))]
        if not name and known:
            name = known[0]
        if name not in known:
            raise ModelError(
                f'study: no measure "{name}" in numbers, has {_said(known)}'
                f"{did_you_mean(name, known)}"
            )
        return self.data[name]

    def _at(self, values: xarray.DataArray, at: Mapping[str, float] | None) -> xarray.DataArray:
        for name, value in (at or {}).items():
            self._known(name, [str(d) for d in values.dims])
            if self.data[name].dtype.kind in "biuf":
                values = values.sel({name: value}, method="nearest")
            else:
                values = values.sel({name: value})
        return values.squeeze(drop=True)

    def _known(self, name: str, known: Sequence[str]) -> None:
        if name not in known:
            raise ModelError(
                f'study: no axis "{name}", has {_said(known)}{did_you_mean(name, known)}'
            )

    def _pair(self, values: xarray.DataArray, x: str, y: str) -> tuple[str, str]:
        dims = [str(d) for d in values.dims]
        if len(dims) != 2:
            raise ModelError(
                f"study: a map has two axes, found {_said(dims) or 'none'}: give values of the "
                "others: at=..."
            )
        for name in (x, y):
            if name:
                self._known(name, dims)
        across = x or next(d for d in reversed(dims) if d != y)
        up = y or next(d for d in dims if d != across)
        return across, up

    def _mesh(
        self,
        axis: Axes,
        values: xarray.DataArray,
        across: str,
        up: str,
        limits: tuple[float, float],
    ) -> Any:
        mesh = axis.pcolormesh(
            self.data[across].values,
            self.data[up].values,
            np.ma.masked_invalid(values.transpose(up, across).values),
            shading="nearest",
            cmap="RdBu_r" if limits[0] < 0 and limits[1] == -limits[0] else "viridis",
            vmin=limits[0],
            vmax=limits[1],
            rasterized=True,
        )
        self._axis(axis, "x", across)
        self._axis(axis, "y", up)
        return mesh

    def _marks(
        self,
        axis: Axes,
        values: xarray.DataArray,
        along: tuple[str, str],
        over: _Overlay,
        at: Mapping[str, float] | None,
    ) -> None:
        """Hatched region and line of onset over a map."""
        (across, up), proved, onset = along, over.proved, over.onset
        x, y = self.data[across].values, self.data[up].values
        box = axis.get_xlim(), axis.get_ylim()
        if callable(proved):
            limit = np.minimum(np.broadcast_to(proved(x), x.shape), box[1][1])
            hatch_region(axis, _edges(x, box[0]), box[1][0], _edges(limit), over.proved_label)
            axis.collections[-1].set_facecolor("none")
            axis.collections[-1].set_edgecolor("black")
        elif proved is not None:
            held = self.data[proved] == "proved" if isinstance(proved, str) else proved
            inside = self._at(held, {k: v for k, v in (at or {}).items() if k in held.dims})
            shown = np.ma.masked_where(~inside.transpose(up, across).values.astype(bool), inside.T)
            axis.pcolor(x, y, shown, shading="nearest", hatch="///", alpha=0.0)
            axis.fill_between(
                [], [], facecolor="none", edgecolor="black", hatch="///", label=over.proved_label
            )
        if onset is not None:
            field = values.transpose(up, across).values
            if np.nanmin(field) < onset < np.nanmax(field):
                field = np.where(np.isinf(field), np.nanmax(field[np.isfinite(field)]), field)
                axis.contour(x, y, field, [onset], colors="black", linewidths=1.2)
                axis.plot([], [], color="black", linewidth=1.2, label=over.onset_label)
        axis.set(xlim=box[0], ylim=box[1])

    def _axis(self, axis: Axes, which: str, name: str) -> None:
        values = self.data[name].values
        if values.dtype.kind in "biuf" and len(values) > 2 and (values > 0).all():
            ratios = values[1:] / values[:-1]
            if np.ptp(ratios) < _EVEN * ratios[0] and ratios[0] > 1.01:
                axis.set(**{f"{which}scale": "log"})
        axis.set(**{f"{which}label": _label(self.data[name])})

    def _legend(self, figure: Any, axis: Axes) -> None:
        handles, labels = axis.get_legend_handles_labels()
        if handles:
            figure.legend(handles, labels, loc="outside lower center", ncols=2)


def _limits(values: xarray.DataArray, onset: float | None) -> tuple[float, float]:
    """Scale of colours: of all numbers; even about 0 where the onset is at 0.

    There the 95th percentile of sizes: swings that explode would leave no colour for the rest.
    """
    finite = values.values[np.isfinite(values.values)]
    if not finite.size:
        return 0.0, 1.0
    if onset == 0.0 and finite.min() < 0 < finite.max():
        most = float(np.percentile(np.abs(finite), 95))
        return -most, most
    return float(finite.min()), float(finite.max())


def _edges(values: np.ndarray, ends: tuple[float, float] | None = None) -> np.ndarray:
    """Points, with the ends of the axis (or the last values again) on both sides."""
    first, last = ends or (values[0], values[-1])
    return np.concatenate([[first], values, [last]])


def _label(array: xarray.DataArray) -> str:
    unit = array.attrs.get("units", "")
    name = _words(array.attrs.get("long_name") or str(array.name))
    return f"{name} ({unit_text(unit)})" if unit else name


def _words(name: str) -> str:
    return name.replace("_", " ") if "." not in name else name


def _said(names: Sequence[str]) -> str:
    return ", ".join(names)


def _number(value: Any) -> str:
    return value if isinstance(value, str) else f"{float(value):.4g}"


def _spread(count: int, most: int) -> list[int]:
    """At most that many of `count` places, evenly."""
    return sorted({round(k) for k in np.linspace(0, count - 1, min(count, most))})
