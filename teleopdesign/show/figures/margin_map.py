"""Figure of stability margins over two parameters. Nothing is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.sentences import unit_at_axis
from .style import ONE_COLUMN, house_style

if TYPE_CHECKING:
    import matplotlib.figure

    from ...passivity import MarginMap

#: margins above this are drawn in the same colour: the sign counts, and large ones differ by
#: decades
_LARGEST = 2.0


def plot_margin_map(margins: MarginMap) -> matplotlib.figure.Figure:
    """Llewellyn's margin as colour over two parameters, with a black line at margin zero."""
    import matplotlib.pyplot as plt
    import numpy as np

    margin = margins.data["llewellyn"]
    first, second = map(str, margin.dims)
    x, y = (margins.data[n].values for n in (second, first))
    shown = np.clip(margin.values, -_LARGEST, _LARGEST)
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(figsize=(ONE_COLUMN, 0.8 * ONE_COLUMN), layout="constrained")
        colours = axes.pcolormesh(x, y, shown, cmap="RdBu", vmin=-_LARGEST, vmax=_LARGEST)
        if shown.min() < 0 < shown.max():
            axes.contour(x, y, shown, levels=[0.0], colors="black")
        axes.set_xlabel(f"{second} ({unit_at_axis(margin[second].units)})")
        axes.set_ylabel(f"{first} ({unit_at_axis(margin[first].units)})")
        bar = figure.colorbar(colours, ax=axes)
        bar.set_label("least Llewellyn margin on the axis (1)")
    return figure
