"""How results of slow and steady motion look: Coulomb level, largest stiffness."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..base.sentences import unit_at_axis, with_standard_error
from ..base.units import unit_of
from .figures.style import ONE_COLUMN, plt
from .registry import shows

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..identify import CoulombLevel, LargestStiffness


@shows("text")
def coulomb_level_text(level: CoulombLevel) -> str:
    """The line of each direction, and friction at each speed."""
    force, speed, damping = (unit_of(q, level.axis) for q in ("force", "velocity", "damping"))
    lines = [f'Runs at constant speed of "{level.experiment}": {len(level.runs)}']
    for name, line in level.lines.items():
        if line is not None:
            what = "Coulomb level" if name == "both ways" else "level and constant force"
            size = with_standard_error(line.level, line.level_error)
            slope = with_standard_error(line.damping, line.damping_error)
            lines.append(f"  {name}: {what} {size} {force}, damping {slope} {damping}")
    if level.level is None:
        lines.append("  no Coulomb level: runs at two speeds are needed both ways")
    elif level.line is None:
        lines.append(
            f"  mean of both: Coulomb level {with_standard_error(*level.level)} {force}, for no "
            "two speeds were run both ways over one travel"
        )
    for s in level.speeds:
        lines.append(
            f"  at {s.speed:.4g} {speed}: friction "
            f"{with_standard_error(s.friction, s.friction_error)} {force}, constant force "
            f"{with_standard_error(s.middle, s.middle_error)} {force} "
            f"({s.pairs} pair{'s' * (s.pairs > 1)})"
        )
    return "\n".join(lines)


@shows("figure")
def plot_force_velocity_curve(level: CoulombLevel) -> Figure:
    """Mean force of each run, and the fitted line (level and damping) of each direction."""
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


@shows("text")
def largest_stiffness_text(largest: LargestStiffness) -> str:
    """The stiffness with its bracket, and the criterion."""
    unit, speed = unit_of("stiffness", largest.axis), unit_of("velocity", largest.axis)
    return (
        f"Largest stiffness without oscillation: {largest.stiffness:.4g} {unit}, "
        f"{largest.oscillates:.4g} {unit} oscillates ({largest.simulations} simulations of a kick "
        f"of {largest.kick:g} {speed}; it oscillates where more than {largest.decay:g} of the rms "
        "speed is left)"
    )
