"""How each result is drawn, worded, tabled and reported; results know nothing of it."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .figures.block_diagram import Drawing as Drawing
    from .figures.block_diagram import draw_diagram as draw_diagram
    from .figures.design import plot_force_velocity as plot_force_velocity
    from .figures.design import plot_simulation as plot_simulation
    from .figures.design import save_figure as save_figure
    from .figures.frequency import plot_bode as plot_bode
    from .figures.frequency import plot_nyquist as plot_nyquist
    from .figures.frequency_impedance import plot_impedance as plot_impedance
    from .figures.frequency_impedance import plot_spread as plot_spread

__getattr__, __dir__, __all__ = lazy_face(__name__)
