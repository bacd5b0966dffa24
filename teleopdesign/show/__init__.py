"""How each result is drawn, worded, tabled and reported; results know nothing of it."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .figures.block_diagram import Drawing as Drawing
    from .figures.block_diagram import draw_diagram as draw_diagram
    from .figures.style import save_figure as save_figure
    from .frequency.impedance import plot_spread as plot_spread

__getattr__, __dir__, __all__ = lazy_face(__name__)
