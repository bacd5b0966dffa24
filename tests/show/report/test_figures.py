"""What the figures of a page draw is what its data hold: bars, rings, maps, traces, scales."""

import numpy as np
import pytest
from markupsafe import Markup
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from teleopdesign.base.finding import Graph
from teleopdesign.show.figures.diagnosis import AFTER, BEFORE
from teleopdesign.show.report import figures
from teleopdesign.show.report.candidate_table import LadderLine
from teleopdesign.show.report.motion import Scaled
from teleopdesign.show.report.residuals import BodyView, RungResidual

EMPTY = Graph("", "", ())
STEPS = tuple(
    RungResidual(name, 0.1, rms, mean, low, low + 0.05)
    for name, rms, mean, low in (
        ("your model", 0.0123, np.arange(6.0).reshape(2, 3), np.array([-0.2, 0.1, -0.3, 0.0])),
        ("with drag", 0.0045, np.arange(6.0).reshape(2, 3) - 3, np.array([-0.1, 0.0, 0.02, 0.7])),
    )
)
VIEW = BodyView(
    body="device",
    position_scale=Scaled("mm", 1e3),
    velocity_scale=Scaled("m/s", 1.0),
    force_scale=Scaled("mN", 1e3),
    position=np.array([-0.03, 0.0, 0.03, 0.06]),
    velocity=np.array([-0.5, 0.1, 0.7]),
    time=np.array([0.5, 1.5, 2.5, 3.5]),
    joints=(1.0, 3.0),
    noise=0.02,
    limit=0.4,
    steps=STEPS,
    excerpt=EMPTY,
    over_carrier=EMPTY,
)
LADDER = (
    LadderLine("your model, re-estimated", "your model", 0.05, 0.08, 8.0),
    LadderLine("drag at device", "drag", 0.11, 0.03, 3.0),
    LadderLine("stop at device", "stop", 0.01, 0.02, 2.0),
)


@pytest.fixture
def drawn(monkeypatch):
    """Each figure that is made, as matplotlib holds it: (figure, alternative text)."""
    made = []

    def keep(draw, *, size, alt):
        figure = Figure(figsize=size)
        draw(figure)
        made.append((figure, alt))
        return Markup("")

    monkeypatch.setattr(figures, "picture", keep)
    return made


def texts(axes):
    return [t.get_text() for t in axes.texts]


@pytest.mark.parametrize(("number", "floor"), [(1, 0.01), (3, 0.01), (3, 0.5)])
def test_bars_are_check_errors_rings_fit_errors_and_the_line_the_floor(drawn, number, floor):
    rows = LADDER[:number]
    figures.ladder_figure(rows, floor)
    ((figure, alt),) = drawn
    (axes,) = figure.axes
    assert [b.get_width() for b in axes.patches] == [100 * r.check_error for r in rows]
    colours = [to_rgba(BEFORE), *[to_rgba(AFTER)] * (number - 1)]
    assert [b.get_facecolor() for b in axes.patches] == colours
    *rings, line = axes.lines
    assert [float(r.get_xdata()[0]) for r in rings] == [100 * r.fit_error for r in rows]
    assert list(line.get_xdata()) == [100 * floor] * 2
    # everything lies within the axes; the first rung stands on top
    left, right = axes.get_xlim()
    assert left == 0
    assert right > 100 * max(floor, *(e for r in rows for e in (r.check_error, r.fit_error)))
    bottom, top = axes.get_ylim()
    bars = [(b.get_y(), b.get_y() + b.get_height()) for b in axes.patches]
    assert all(top < low < high < bottom for low, high in bars)
    assert all(above[1] < below[0] for above, below in zip(bars, bars[1:], strict=False))
    for y, (bar, ring) in enumerate(zip(axes.patches, rings, strict=True)):
        assert bar.get_y() + 0.5 * bar.get_height() == pytest.approx(float(ring.get_ydata()[0]))
        assert float(ring.get_ydata()[0]) == y
    names = texts(axes)[::2]
    assert names == [rows[0].name, *(f"+ {r.name}" for r in rows[1:])]
    # each name stands between the bar above and its own, where no bar hides it
    for (low, _), name in zip(bars, axes.texts[::2], strict=True):
        assert name.get_position()[1] < low and name.get_verticalalignment() == "bottom"
    assert texts(axes)[1::2] == [f"{100 * r.check_error:.2f}\u202f%" for r in rows]
    for row in rows:
        assert f"{row.name}: {100 * row.check_error:.2f}\u202f%" in alt
    assert f"Noise floor: {100 * floor:.2f}\u202f%" in alt


@pytest.mark.parametrize("index", [0, 1])
def test_a_map_shows_the_means_over_the_cells_edges_on_the_scale_of_the_body(drawn, index):
    figures.step_figure(VIEW, index)
    ((figure, alt),) = drawn
    above, _ = figure.axes
    (image,) = above.images
    assert np.array_equal(np.asarray(image.get_array()), STEPS[index].mean)
    assert image.get_extent() == pytest.approx([-30.0, 60.0, -0.5, 0.7])
    assert image.origin == "lower", "slow below, fast above"
    assert image.get_clim() == (-VIEW.limit, VIEW.limit)
    assert (above.get_xlabel(), above.get_ylabel()) == ("position (mm)", "velocity (m/s)")
    assert list(above.lines[0].get_ydata()) == [0, 0]
    rms = {0: "12.3", 1: "4.50"}[index]
    assert alt.startswith(f"device, {STEPS[index].name}: ") and alt.endswith(f"rms is {rms} mN.")


@pytest.mark.parametrize("index", [0, 1])
def test_a_trace_is_the_band_of_its_step_on_the_scale_of_all_steps(drawn, index):
    figures.step_figure(VIEW, index)
    ((figure, _),) = drawn
    below, step = figure.axes[1], STEPS[index]
    (band,) = below.collections
    corners = band.get_paths()[0].vertices
    for time, low, high in zip(VIEW.time, step.low, step.high, strict=True):
        at = corners[corners[:, 0] == time, 1]
        assert (at.min(), at.max()) == pytest.approx((1e3 * low, 1e3 * high))
    assert to_rgba(band.get_facecolor()[0]) == to_rgba((BEFORE, AFTER)[index])
    # the largest of both steps is 750 mN, and both share one scale with some room
    low, high = below.get_ylim()
    assert low == -high and 750 < high < 1000
    assert below.get_xlim() == (VIEW.time[0], VIEW.time[-1])
    *joints, zero = below.lines
    assert [line.get_xdata()[0] for line in joints] == list(VIEW.joints)
    assert list(zero.get_ydata()) == [0, 0]
    assert below.get_ylabel() == "residual (mN)"
