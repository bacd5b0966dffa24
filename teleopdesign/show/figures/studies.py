"""Figures of parameter studies: curves, maps, panels, points, bars. Draws only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...base.errors import ModelError
from ...studies.points import SAMPLE
from .design import ONE_COLUMN, TWO_COLUMNS
from .letters import house_style
from .study_data import StudyData, join_names, label, number, sort_axes, spread
from .study_maps import MOST_PANELS, Overlay, draw_map, draw_panels

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray

    from .study_maps import Proved


FIRST, TOTAL = "#0072B2", "#9CC7E4"
_MOST_LINES = 8
#: points of a panel of 1.7 in that overlap if they are drawn larger than 1.5 points
_MANY_POINTS = 300


@dataclass(frozen=True, eq=False)
class StudyPlots:
    """Figures of a study's data; a call draws the figure that fits the study's axes."""

    data: xarray.Dataset

    def __call__(self, measure: str = "") -> matplotlib.figure.Figure:
        """Bars or points for sampled studies; else curves, a map, or maps side by side.

        Bars are drawn for points of `sensitivity_samples`. Of more than three parameters, the
        others have the value in the middle of their axis, which the title states.
        """
        if self.data.attrs.get("sampling"):
            if self.data.attrs["sampling"] == "sensitivity":
                return self.sensitivity(measure)
            return self.scatter(measure)
        import matplotlib.pyplot as plt

        self._study.measure(measure)
        grids = [n for n in self._study.axes if self.data.sizes[n] > 1]
        if not grids:
            raise ModelError("study: no parameter has several values: there is nothing to draw")
        if len(grids) == 1 or len(grids) == 2 and not self._study.is_number(*grids):
            return self.curves(measure)
        if len(grids) <= 3:
            return self.map(measure) if len(grids) == 2 else self.panels(measure)
        values = {n: self._study.data[n].values for n in grids[3:]}
        at = {n: v[len(v) // 2] for n, v in values.items()}
        figure = self.panels(measure, at=at)
        with plt.style.context(house_style()):
            figure.suptitle(", ".join(self._study.name_with_value(n, v) for n, v in at.items()))
        return figure

    def curves(
        self, measure: str = "", *, over: str = "", at: Mapping[str, float] | None = None
    ) -> matplotlib.figure.Figure:
        """A measure over one parameter, a line for each value of a second one.

        over: parameter along the abscissa, default the first one
        at: parameter -> value of every further parameter; the nearest value of the study is taken
        raises ModelError: no such name, or more than two parameters without a value
        """
        import matplotlib.pyplot as plt

        values = self._study.at(self._study.measure(measure), at)
        dims = [str(d) for d in values.dims]
        if not dims:
            raise ModelError("curves: no parameter has several values: there is nothing to draw")
        across = over or dims[0]
        self._study.require(across, dims)
        each = [d for d in dims if d != across]
        if len(each) > 1:
            raise ModelError(f"curves: give values of all but two of {join_names(dims)}: at=...")
        with plt.style.context(house_style()):
            figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.5 + 0.5 * bool(each)))
            lines = self._study.data[each[0]].values if each else [None]
            shown = spread(len(lines), _MOST_LINES)
            colours = plt.get_cmap("viridis")(np.linspace(0, 0.85, len(shown)))
            for colour, k in zip(colours, shown, strict=True):
                one = values.isel({each[0]: k}) if each else values
                entry = number(lines[k]) if each else None
                axis.plot(
                    self._study.data[across].values, one.values, ".-", color=colour, label=entry
                )
            self._study.label_axis(axis, "x", across)
            axis.set_ylabel(label(values))
            if each:
                title = label(self.data[each[0]])
                figure.legend(title=title, loc="outside lower center", ncols=4)
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

        x, y: parameters across and up, default the last two axes;  at: values of all others
        proved: region that is hatched: where the measure of that name is "proved", where an array
            over x and y is true, or below a limit y(x)
        onset: value of the measure at which a line is drawn, interpolated between the points

        Points of failed simulations stay white.
        """
        over = Overlay(proved, proved_label, onset, onset_label)
        return draw_map(self._study, measure, (x, y), at, over)

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
        """Maps side by side with one scale of colours, a map for each value of a third parameter.

        by: that parameter, default the first axis;  other arguments: as for `map`
        """
        over = Overlay(proved, proved_label, onset, onset_label)
        return draw_panels(self._study, measure, (x, y, by), at, over)

    def scatter(self, measure: str = "") -> matplotlib.figure.Figure:
        """A measure over each parameter, for points that were drawn together; a panel for each.

        A further axis has a colour for each value.
        """
        import matplotlib.pyplot as plt

        values = self._study.measure(measure)
        if SAMPLE not in values.dims or values.ndim > 2:
            raise ModelError(
                f"scatter: found a measure over {join_names([str(d) for d in values.dims])}, "
                "expected points drawn together, with one more axis at most"
            )
        each = next((str(d) for d in values.dims if d != SAMPLE), "")
        lines = self._study.data[each].values if each else [None]
        shown = spread(len(lines), _MOST_LINES)
        colours = plt.get_cmap("viridis")(np.linspace(0, 0.85, len(shown))) if each else [FIRST]
        names = [n for n in self._study.axes if self.data[n].dims == (SAMPLE,)][:MOST_PANELS]
        size = 1.5 if values.sizes[SAMPLE] > _MANY_POINTS else 4.0
        columns = min(len(names), 4)
        rows = -(-len(names) // columns)
        with plt.style.context(house_style()):
            figure, axes = plt.subplots(
                rows,
                columns,
                sharey=True,
                squeeze=False,
                figsize=(TWO_COLUMNS, 0.5 + 1.7 * rows),
            )
            for name, axis in zip(names, axes.flat, strict=False):
                for colour, k in zip(colours, shown, strict=True):
                    one = values.isel({each: k}) if each else values
                    entry = number(lines[k]) if each else None
                    axis.plot(self.data[name], one, ".", markersize=size, color=colour, label=entry)
                self._study.label_axis(axis, "x", name)
            for axis in axes.flat[len(names) :]:
                axis.remove()
            for row in axes[:, 0]:
                row.set_ylabel(label(values))
            if each:
                entries = axes[0, 0].get_legend_handles_labels()
                title = label(self.data[each])
                figure.legend(*entries, title=title, loc="outside lower center", ncols=4)
        return figure

    def sensitivity(self, *measures: str) -> matplotlib.figure.Figure:
        """Sobol indices as bars, largest total first, a panel for each measure (default: all)."""
        import matplotlib.pyplot as plt

        from ...studies import Study, sensitivity

        study = Study(self.data)
        chosen = [m for m in measures if m] or [
            m for m in study.measures if self.data[m].dtype.kind == "f"
        ]
        indices = [sensitivity(study, m) for m in chosen]
        columns = len(chosen)
        with plt.style.context(house_style()):
            figure, axes = plt.subplots(
                1,
                columns,
                squeeze=False,
                figsize=(
                    ONE_COLUMN if columns == 1 else TWO_COLUMNS,
                    0.9 + 0.34 * len(self._study.axes),
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
                shown = [self._study.name(str(p)) for p in ranked["parameter"].values]
                axis.set_yticks(place, shown)
                axis.tick_params(axis="y", length=0)
                axis.set_xlim(min(0.0, axis.get_xlim()[0]), None)
                axis.axvline(0.0, color="black", linewidth=0.6)
                axis.set_xlabel(f"share of the variance of {self._study.name(name)} (1)")
            axes[0, 0].legend(loc="lower right")
        return figure

    @property
    def _study(self) -> StudyData:
        return StudyData(sort_axes(self.data))
