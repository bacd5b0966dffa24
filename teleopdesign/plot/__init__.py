"""Draw result objects; compute nothing."""

from .block_diagram import Drawing, draw_diagram
from .design import plot_bode, plot_force_velocity, plot_simulation, save_figure

__all__ = [
    "Drawing",
    "draw_diagram",
    "plot_bode",
    "plot_force_velocity",
    "plot_simulation",
    "save_figure",
]
