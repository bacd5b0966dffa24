"""Texts of studies; figures of curves, points and bars."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.errors import ModelError
from ...base.shown import html_table
from ...studies.points import SAMPLE
from ...studies.result import REASON
from ..figures.style import ONE_COLUMN, TWO_COLUMNS, plt
from ..registry import shows
from .data import StudyData, data_of, label, number, spread
from .maps import MOST_PANELS

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray

    from ...studies import Samples, Study
    from ...studies.plots import StudyPlots

FIRST, TOTAL = "#0072B2", "#9CC7E4"
_MOST_LINES = 8
#: points of a panel of 1.7 in that overlap if they are drawn larger than 1.5 points
_MANY_POINTS = 300


@shows("text")
def samples_text(samples: Samples) -> str:
    """Number and method of the points, and the range of each parameter."""
    listed = ", ".join(f"{n} {r}" for n, r in zip(samples.names, samples.ranges, strict=True))
    return f"{len(samples)} points ({samples.method}, seed {samples.seed}): {listed}"


@shows("text")
def study_text(study: Study) -> str:
    """Sizes of the axes, and a line with the range of each measure."""
    lines = [f"  {n:<24} {_range(study.data[n])} {_unit(study.data[n])}" for n in study.measures]
    failed = _count_failures(study)
    return "\n".join([_title(study), *lines, *([f"  {failed}"] if failed else [])])


@shows("table")
def study_table(study: Study) -> str:
    """The range and unit of each measure."""
    rows = [(n, _range(study.data[n]), _unit(study.data[n])) for n in study.measures]
    head, note = ("measure", "from to", "unit"), _count_failures(study)
    return html_table(_title(study), head, rows, note=note)


def _title(study: Study) -> str:
    axes = study.data[REASON].dims
    sizes = " x ".join(f"{n} {d}" for d, n in study.data.sizes.items() if d in axes)
    return f"Study of the {study.data.attrs['model']}: {sizes or '1 point'}"


def _count_failures(study: Study) -> str:
    counted = study.failures
    if not counted:
        return ""
    first = next(iter(counted))
    return f"{sum(counted.values())} of {study.data[REASON].size} points failed, most: {first}"


def _range(array: Any) -> str:
    values = array.values
    if values.dtype.kind not in "biuf":
        counted, counts = np.unique(values.astype(str), return_counts=True)
        return ", ".join(f"{n} {t}" for t, n in zip(counted, counts, strict=True) if t)[:60]
    finite = values[np.isfinite(values)]
    if not finite.size:
        return "infinite" if np.isinf(values).any() else "no number"
    return f"{finite.min():.4g} to {finite.max():.4g}"


def _unit(array: Any) -> str:
    return str(array.attrs.get("units", ""))


@shows("figure")
def draw_fitting(plots: StudyPlots, measure: str) -> matplotlib.figure.Figure:
    """The figure that fits the axes of the study."""
    study = data_of(plots)
    if study.data.attrs.get("sampling"):
        if study.data.attrs["sampling"] == "sensitivity":
            return plots.sensitivity(measure)
        return plots.scatter(measure)

    study.measure(measure)
    grids = [n for n in study.axes if study.data.sizes[n] > 1]
    if not grids:
        raise ModelError("study: no parameter has several values: there is nothing to draw")
    if len(grids) == 1 or len(grids) == 2 and not study.is_number(*grids):
        return plots.curves(measure)
    if len(grids) <= 3:
        return plots.map(measure) if len(grids) == 2 else plots.panels(measure)
    values = {n: study.data[n].values for n in grids[3:]}
    at = {n: v[len(v) // 2] for n, v in values.items()}
    figure = plots.panels(measure, at=at)
    figure.suptitle(", ".join(study.name_with_value(n, v) for n, v in at.items()))
    return figure


@shows("curves")
def draw_curves(
    plots: StudyPlots, measure: str, *, over: str, at: Mapping[str, Any] | None
) -> matplotlib.figure.Figure:
    """A measure over one parameter, a line for each value of a second one."""
    study = data_of(plots)
    values = study.at(study.measure(measure), at)
    dims = [str(d) for d in values.dims]
    if not dims:
        raise ModelError("curves: no parameter has several values: there is nothing to draw")
    across = over or dims[0]
    study.require(across, dims)
    each = [d for d in dims if d != across]
    if len(each) > 1:
        raise ModelError(f"curves: give values of all but two of {', '.join(dims)}: at=...")
    figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.5 + 0.5 * bool(each)))
    for one, style in _lines(study, values, *each):
        axis.plot(study.data[across].values, one.values, ".-", **style)
    study.label_axis(axis, "x", across)
    axis.set_ylabel(label(values))
    if each:
        title = label(study.data[each[0]])
        figure.legend(title=title, loc="outside lower center", ncols=4)
    return figure


def _lines(
    study: StudyData, values: xarray.DataArray, each: str = ""
) -> list[tuple[xarray.DataArray, dict[str, Any]]]:
    """The values at some values of an axis, with colour and label;  "": all of them, without."""
    import matplotlib as mpl

    if not each:
        return [(values, {"color": FIRST})]
    known = study.data[each].values
    shown = spread(len(known), _MOST_LINES)
    colours = mpl.colormaps["viridis"](np.linspace(0, 0.85, len(shown)))
    return [
        (values.isel({each: k}), {"color": colour, "label": number(known[k])})
        for colour, k in zip(colours, shown, strict=True)
    ]


@shows("scatter")
def draw_points(plots: StudyPlots, measure: str) -> matplotlib.figure.Figure:
    """A measure over each parameter, for points that were drawn together."""
    study = data_of(plots)
    values = study.measure(measure)
    if SAMPLE not in values.dims or values.ndim > 2:
        raise ModelError(
            f"scatter: found a measure over {', '.join(map(str, values.dims))}, "
            "expected points drawn together, with one more axis at most"
        )
    each = next((str(d) for d in values.dims if d != SAMPLE), "")
    names = [n for n in study.axes if study.data[n].dims == (SAMPLE,)][:MOST_PANELS]
    size = 1.5 if values.sizes[SAMPLE] > _MANY_POINTS else 4.0
    columns = min(len(names), 4)
    rows = -(-len(names) // columns)
    figure, axes = plt.subplots(
        rows, columns, sharey=True, squeeze=False, figsize=(TWO_COLUMNS, 0.5 + 1.7 * rows)
    )
    for name, axis in zip(names, axes.flat, strict=False):
        for one, style in _lines(study, values, each):
            axis.plot(study.data[name], one, ".", markersize=size, **style)
        study.label_axis(axis, "x", name)
    for axis in axes.flat[len(names) :]:
        axis.remove()
    for row in axes[:, 0]:
        row.set_ylabel(label(values))
    if each:
        entries = axes[0, 0].get_legend_handles_labels()
        title = label(study.data[each])
        figure.legend(*entries, title=title, loc="outside lower center", ncols=4)
    return figure


@shows("sensitivity")
def draw_indices(plots: StudyPlots, *measures: str) -> matplotlib.figure.Figure:
    """Sobol indices as bars, largest total first, a panel for each measure."""
    from ...studies import Study, sensitivity

    study, whole = data_of(plots), Study(plots.data)
    chosen = [m for m in measures if m] or [
        m for m in whole.measures if plots.data[m].dtype.kind == "f"
    ]
    indices = [sensitivity(whole, m) for m in chosen]
    columns = len(chosen)
    figure, axes = plt.subplots(
        1,
        columns,
        squeeze=False,
        figsize=(ONE_COLUMN if columns == 1 else TWO_COLUMNS, 0.9 + 0.34 * len(study.axes)),
    )
    for axis, name, ranked in zip(axes[0], chosen, indices, strict=True):
        ranked = ranked.isel(parameter=np.argsort(ranked["total"].values, kind="stable"))
        place = np.arange(ranked.sizes["parameter"])
        for kind, shift, colour, entry in (
            ("total", -0.19, TOTAL, "with others"),
            ("first", 0.19, FIRST, "alone"),
        ):
            axis.barh(
                place + shift,
                ranked[kind].values,
                0.36,
                xerr=ranked[f"{kind}_interval"].values,
                color=colour,
                label=entry,
                error_kw={"linewidth": 0.7},
            )
        shown = [study.name(str(p)) for p in ranked["parameter"].values]
        axis.set_yticks(place, shown)
        axis.tick_params(axis="y", length=0)
        axis.set_xlim(min(0.0, axis.get_xlim()[0]), None)
        axis.axvline(0.0, color="black", linewidth=0.6)
        axis.set_xlabel(f"share of the variance of {study.name(name)} (1)")
    axes[0, 0].legend(loc="lower right")
    return figure
