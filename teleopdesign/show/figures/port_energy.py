"""Figure of the energy into a port over time. Nothing is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...blocks import NINETY_FIVE
from .style import GREY, ONE_COLUMN, THEORY, house_style

if TYPE_CHECKING:
    import matplotlib.figure

    from ...passivity.observer import PortEnergy


def plot_port_energy(observed: PortEnergy) -> matplotlib.figure.Figure:
    """Energy (J) into a port over time, its 95 % band, and the spans in which energy comes out."""
    import matplotlib.pyplot as plt

    data = observed.data
    t, e, error = (data[n].values for n in ("time", "energy", "stderr"))
    with plt.style.context(house_style()):
        figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.2))
        axis.axhline(0.0, color=GREY, linewidth=0.6)
        for k, (begin, end, _) in enumerate(observed.given_out()):
            label = "energy comes out" if k == 0 else None
            axis.axvspan(begin, end, color="#F6D5C0", linewidth=0, label=label)
        if error.max() > 0:
            axis.fill_between(
                t,
                e - NINETY_FIVE * error,
                e + NINETY_FIVE * error,
                color=THEORY,
                alpha=0.25,
                linewidth=0,
            )
        axis.plot(t, e, color=THEORY, label="energy into the port")
        axis.set_xlim(float(t[0]), float(t[-1]))
        axis.set_xlabel("time (s)")
        axis.set_ylabel("energy (J)")
        axis.legend(loc="best")
    return figure
