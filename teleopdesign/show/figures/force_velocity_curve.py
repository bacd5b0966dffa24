"""Force against velocity from runs at constant speed: measured points and a fitted line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...base.sentences import unit_at_axis
from ...base.units import unit_of
from .design import ONE_COLUMN
from .letters import house_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...identify import CoulombLevel


def plot_force_velocity_curve(level: CoulombLevel) -> Figure:
    """Mean force of each run, and the fitted line (level and damping) of each direction."""
    import matplotlib.pyplot as plt

    with plt.style.context(house_style()):
        figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.6))
        axis.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
        axis.axvline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
        axis.plot(
            [r.velocity for r in level.runs],
            [float(np.mean(r.force)) for r in level.runs],
            ".",
            color="0.55",
            markersize=4,
            label="runs",
        )
        for way, line in ((1, level.forward), (-1, level.backward)):
            if line is not None:
                speed = np.array([0.0, max(abs(r.velocity) for r in level.runs)])
                force = way * (line.level + line.damping * speed)
                axis.plot(way * speed, force, color="#0072B2", label="line" if way > 0 else None)
        axis.set_xlabel(f"velocity ({unit_at_axis(unit_of('velocity', level.axis))})")
        axis.set_ylabel(f"force that moves it ({unit_at_axis(unit_of('force', level.axis))})")
        axis.legend(loc="lower right")
    return figure
