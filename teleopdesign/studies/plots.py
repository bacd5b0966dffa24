"""Figures of a study: which there are, and what each takes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..base.shown import figure_of

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray


@dataclass(frozen=True, eq=False)
class StudyPlots:
    """Figures of a study's data; a call draws the figure that fits the study's axes.

    raises ModelError: no such axis or measure, or no figure of this kind for these axes
    """

    data: xarray.Dataset

    def __call__(self, measure: str = "") -> matplotlib.figure.Figure:
        """Bars or points for sampled studies; else curves, a map, or maps side by side.

        Bars are drawn for points of `sensitivity_samples`. Of more than three parameters, the
        others have the value in the middle of their axis, which the title states.
        """
        return figure_of(self, measure)

    def curves(
        self, measure: str = "", *, over: str = "", at: Mapping[str, Any] | None = None
    ) -> matplotlib.figure.Figure:
        """A measure over one parameter, a line for each value of a second one.

        over: parameter along the abscissa, default the first one
        at: parameter -> value of every further parameter; the nearest value of the study is taken
        """
        return figure_of(self, measure, kind="curves", over=over, at=at)

    def map(
        self,
        measure: str = "",
        *,
        x: str = "",
        y: str = "",
        at: Mapping[str, Any] | None = None,
        proved: Any = None,
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
        marks = (proved, proved_label, onset, onset_label)
        return figure_of(self, measure, (x, y), at, marks, kind="map")

    def panels(
        self,
        measure: str = "",
        *,
        x: str = "",
        y: str = "",
        by: str = "",
        at: Mapping[str, Any] | None = None,
        proved: Any = None,
        proved_label: str = "proved",
        onset: float | None = None,
        onset_label: str = "onset, simulated",
    ) -> matplotlib.figure.Figure:
        """Maps side by side with one scale of colours, a map for each value of a third parameter.

        by: that parameter, default the first axis;  other arguments: as for `map`
        """
        marks = (proved, proved_label, onset, onset_label)
        return figure_of(self, measure, (x, y, by), at, marks, kind="panels")

    def scatter(self, measure: str = "") -> matplotlib.figure.Figure:
        """A measure over each parameter, for points that were drawn together; a panel for each.

        A further axis has a colour for each value.
        """
        return figure_of(self, measure, kind="scatter")

    def sensitivity(self, *measures: str) -> matplotlib.figure.Figure:
        """Sobol indices as bars, a panel for each measure; default: all measures."""
        return figure_of(self, *measures, kind="sensitivity")
