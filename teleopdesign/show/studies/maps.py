"""Maps of parameter studies: a measure as colour over two parameters, one map or several."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.errors import ModelError
from ..figures.style import ONE_COLUMN, TWO_COLUMNS, hatch_region, plt
from ..registry import shows
from .data import StudyData, data_of, label, sort_axes, spread

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray
    from matplotlib.axes import Axes

    from ...studies.plots import StudyPlots

Marks = tuple[Any, str, float | None, str]
#: panels side by side that can still be read on a page
MOST_PANELS = 9
#: most ticks of a linear axis: labels such as 0.00125 are wide beside a panel of 1.5 in
_FEW_TICKS = 4


@dataclass(frozen=True)
class Overlay:
    """Marks that are drawn over a map: see `StudyPlots.map`."""

    proved: Any
    proved_label: str
    onset: float | None
    onset_label: str


@shows("map")
def draw_map(
    plots: StudyPlots,
    measure: str,
    along: tuple[str, str],
    at: Mapping[str, float] | None,
    marks: Marks,
) -> matplotlib.figure.Figure:
    """One map;  along: axes across and up, "" for the default: see `StudyPlots.map`."""
    study, over = data_of(plots), Overlay(*marks)
    values = study.at(study.measure(measure), at)
    across, up = study.pair(values, *along)
    figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.9))
    limits = _limits(values, over.onset)
    mesh = _draw_mesh(study, axis, values, across, up, limits)
    _draw_marks(study, axis, values, (across, up), over, at)
    figure.colorbar(mesh, ax=axis, label=label(values), extend=_extend(values, limits))
    _draw_legend(figure, axis)
    return figure


@shows("panels")
def draw_panels(
    plots: StudyPlots,
    measure: str,
    along: tuple[str, str, str],
    at: Mapping[str, float] | None,
    marks: Marks,
) -> matplotlib.figure.Figure:
    """Maps side by side;  along: axes across, up and by: see `StudyPlots.panels`."""
    study, over = data_of(plots), Overlay(*marks)
    *plane, by = along
    whole = study.measure(measure)
    values = study.at(whole, at)
    third = by or next(str(d) for d in (*values.dims, *whole.dims))
    study.require(third, [str(d) for d in whole.dims if d not in (at or {})])
    if third not in values.dims:  # it has one value
        values = values.expand_dims(third)
    shown = spread(values.sizes[third], MOST_PANELS)
    across, up = study.pair(values.isel({third: 0}), *plane)
    columns = min(len(shown), 3)
    rows = -(-len(shown) // columns)
    figure, axes = plt.subplots(
        rows,
        columns,
        sharex=True,
        sharey=True,
        squeeze=False,
        figsize=(TWO_COLUMNS, 0.7 + 1.9 * rows),
    )
    limits = _limits(values, over.onset)
    for letter, k, axis in zip("abcdefghi", shown, axes.flat, strict=False):
        one = values.isel({third: k})
        mesh = _draw_mesh(study, axis, one, across, up, limits)
        where = {**(at or {}), third: study.data[third].values[k]}
        _draw_marks(study, axis, one, (across, up), over, where)
        title = study.name_with_value(third, study.data[third].values[k])
        axis.set_title(f"({letter}) {title}", loc="left", pad=3)
        axis.label_outer()
    for empty in range(len(shown), axes.size):
        axes.flat[empty].remove()
        above = axes.flat[empty - columns]  # has the ticks of its column
        above.tick_params(labelbottom=True)
        study.label_axis(above, "x", across)
    parents = axes.flat[: len(shown)].tolist()
    figure.colorbar(mesh, ax=parents, label=label(whole), extend=_extend(values, limits))
    _draw_legend(figure, axes[0, 0])
    return figure


def _draw_mesh(
    study: StudyData,
    axis: Axes,
    values: xarray.DataArray,
    across: str,
    up: str,
    limits: tuple[float, float],
) -> Any:
    from matplotlib.ticker import FixedLocator, MaxNLocator

    study.label_axis(axis, "x", across)
    study.label_axis(axis, "y", up)
    field = values.transpose(up, across).values  # infinite values have the colours of the ends
    shown = np.nan_to_num(field, nan=np.nan, neginf=limits[0], posinf=limits[1])
    mesh = axis.pcolormesh(
        _borders(study.data[across].values, axis.get_xscale()),
        _borders(study.data[up].values, axis.get_yscale()),
        np.ma.masked_invalid(shown),
        cmap="RdBu_r" if limits[0] < 0 and limits[1] == -limits[0] else "viridis",
        vmin=limits[0],
        vmax=limits[1],
        rasterized=True,
    )
    for one, scale, name in (
        (axis.xaxis, axis.get_xscale(), across),
        (axis.yaxis, axis.get_yscale(), up),
    ):
        values_of = study.data[name].values
        places = _places(values_of)
        if places is not values_of:
            one.set_ticks(places, labels=[str(value) for value in values_of])
        elif scale == "linear":
            few = len(places) <= _FEW_TICKS  # else some, so that labels are apart
            one.set_major_locator(FixedLocator(places.tolist()) if few else MaxNLocator(_FEW_TICKS))
    return mesh


def _places(values: np.ndarray) -> np.ndarray:
    """Coordinates of the values (n,) on an axis: the numbers themselves; words stand 1 apart."""
    return values if values.dtype.kind in "biuf" else np.arange(len(values), dtype=float)


def _borders(values: np.ndarray, scale: str) -> np.ndarray:
    """Borders (n + 1,) of cells around values (n,), halfway to the next one on the axis' scale."""
    at = np.log(values) if scale == "log" else _places(values).astype(float)
    apart = np.diff(at) if len(at) > 1 else np.ones(1)
    middle = at[:-1] + 0.5 * apart[: len(at) - 1]
    borders = np.concatenate([[at[0] - 0.5 * apart[0]], middle, [at[-1] + 0.5 * apart[-1]]])
    return np.exp(borders) if scale == "log" else borders


def _draw_marks(
    study: StudyData,
    axis: Axes,
    values: xarray.DataArray,
    along: tuple[str, str],
    over: Overlay,
    at: Mapping[str, float] | None,
) -> None:
    """Draw the hatched region and the line of onset over a map."""
    (across, up), proved, onset = along, over.proved, over.onset
    x, y = (_places(study.data[name].values) for name in (across, up))
    box = axis.get_xlim(), axis.get_ylim()
    if callable(proved):
        limit = np.minimum(np.broadcast_to(proved(x), x.shape), box[1][1])
        hatch_region(axis, _edges(x, box[0]), box[1][0], _edges(limit), over.proved_label)
        axis.collections[-1].set_facecolor("none")
        axis.collections[-1].set_edgecolor("black")
    elif proved is not None:
        held = study.data[proved] == "proved" if isinstance(proved, str) else proved
        held = sort_axes(held)
        inside = study.at(held, {k: v for k, v in (at or {}).items() if k in held.dims})
        if set(inside.dims) != {across, up} or inside.size != values.size:
            raise ModelError(
                f"study: proved: found an array over {', '.join(map(str, inside.dims))} of "
                f"shape {inside.shape}, expected one over {across} and {up} as the measure"
            )
        shown = np.ma.masked_where(~inside.transpose(up, across).values.astype(bool), inside.T)
        borders = _borders(x, axis.get_xscale()), _borders(y, axis.get_yscale())
        axis.pcolor(*borders, shown, hatch="///", alpha=0.0)
        axis.fill_between(
            [], [], facecolor="none", edgecolor="black", hatch="///", label=over.proved_label
        )
    if onset is not None:
        field = values.transpose(up, across).values
        if np.nanmin(field) < onset < np.nanmax(field):
            finite = field[np.isfinite(field)]
            field = np.clip(field, finite.min(), finite.max())
            axis.contour(x, y, field, [onset], colors="black", linewidths=1.2)
            axis.plot([], [], color="black", linewidth=1.2, label=over.onset_label)
    axis.set(xlim=box[0], ylim=box[1])


def _draw_legend(figure: Any, axis: Axes) -> None:
    handles, labels = axis.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=2)


def _limits(values: xarray.DataArray, onset: float | None) -> tuple[float, float]:
    """Ends of the colour scale: all numbers; symmetric about 0 if the onset is at 0.

    The symmetric scale ends at the 95th percentile of the absolute values; growing swings with very
    large values would leave no colour for the rest.
    """
    finite = values.values[np.isfinite(values.values)]
    if not finite.size:
        return 0.0, 1.0
    if onset == 0.0 and finite.min() < 0 < finite.max():
        most = float(np.percentile(np.abs(finite), 95))
        return -most, most
    return float(finite.min()), float(finite.max())


def _extend(values: xarray.DataArray, limits: tuple[float, float]) -> str:
    """Ends of the colour scale beyond which there are values, infinite ones included."""
    below = bool((values < limits[0]).any())
    above = bool((values > limits[1]).any())
    return {(True, True): "both", (True, False): "min", (False, True): "max"}.get(
        (below, above), "neither"
    )


def _edges(values: np.ndarray, ends: tuple[float, float] | None = None) -> np.ndarray:
    """The points, with the ends of the axis (or the first and last point again) on both sides."""
    first, last = ends or (values[0], values[-1])
    return np.concatenate([[first], values, [last]])
