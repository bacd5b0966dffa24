"""Draw result objects; compute nothing."""

from .design import plot_bode, plot_force_velocity, plot_simulation, save_figure

__all__ = ["plot_bode", "plot_force_velocity", "plot_simulation", "save_figure"]
