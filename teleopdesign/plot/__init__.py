"""Draw result objects; compute nothing."""

from ..base.arguments import check_arguments
from .block_diagram import Drawing, draw_diagram
from .design import plot_force_velocity, plot_simulation, save_figure
from .frequency import plot_bode, plot_nyquist
from .frequency_impedance import plot_impedance, plot_spread

__all__ = [
    "Drawing",
    "draw_diagram",
    "plot_bode",
    "plot_force_velocity",
    "plot_impedance",
    "plot_nyquist",
    "plot_simulation",
    "plot_spread",
    "save_figure",
]

check_arguments(globals(), __all__)
