"""The axes of residuals are legible, whatever the size of the motion."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr

from teleopdesign.show.figures.diagnosis import draw_by_direction
from teleopdesign.show.figures.style import house_style


@pytest.mark.parametrize("size", [1.02e-3, 2.3e-2, 0.83, 47.0, 4.1e3])
def test_labels_of_two_axes_side_by_side_stand_apart(size):
    x = np.linspace(-0.9 * size, size, 50)
    signals = {
        "velocity": ("row", x, {"units": "rad/s"}),
        "residual": ("row", x**2, {"units": "N*m"}),
        "direction": ("row", np.sign(x)),
    }
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(2, 2, figsize=(7.16, 4.6))
        draw_by_direction(axes[1, 0], xr.Dataset(signals), "velocity")
        figure.canvas.draw()
        labels = axes[1, 0].get_xticklabels()
        low, high = axes[1, 0].get_xlim()
        boxes = [t.get_window_extent() for t in labels if low <= t.get_position()[0] <= high]
        plt.close(figure)
    assert len(boxes) >= 3
    assert all(a.x1 + a.height < b.x0 for a, b in zip(boxes[:-1], boxes[1:], strict=True))
