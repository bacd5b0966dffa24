"""What a page computes of the samples of a body, held against made samples and closed forms."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.finding import Finding, Graph, Series
from teleopdesign.base.units import si_factor
from teleopdesign.show.report import before_and_after as graphs
from teleopdesign.show.report import residuals
from teleopdesign.show.report.before_and_after import BodySamples, excerpt, plot_over_velocity
from teleopdesign.show.report.page import POINTS, limit_size
from teleopdesign.show.report.scaled import Scaled, choose_prefix, size_of

H = 0.01  # s between made samples


def samples(n, *, residual, measured=None, velocity=None, position=None, stretch=None, clock=None):
    """Samples of one body; where nothing is said: one stretch, at rest, force one."""
    time = H * np.arange(n)
    velocity = np.zeros(n) if velocity is None else velocity
    return BodySamples(
        time=time,
        clock=time if clock is None else clock,
        stretch=np.zeros(n, dtype=int) if stretch is None else stretch,
        position=np.zeros(n) if position is None else position,
        velocity=velocity,
        direction=np.sign(velocity).astype(np.int8),
        measured=np.ones(n) if measured is None else measured,
        residual=tuple(residual),
    )


# the residual over velocity


@pytest.mark.parametrize(("slow", "fast"), [(40, 300), (29, 75), (30, 29), (720, 100)])
def test_each_sample_of_a_direction_is_in_one_group_of_neighbouring_speeds(slow, fast):
    random = np.random.default_rng(slow + fast)
    velocity = np.concatenate([-random.uniform(0.1, 1.0, slow), random.uniform(0.1, 1.0, fast)])
    r = velocity**3 + random.normal(0, 0.1, slow + fast)
    rows = samples(slow + fast, residual=[r], velocity=velocity)
    (drawn,) = plot_over_velocity(rows, "prismatic", Scaled("mN", 1e3)).series
    expected, speeds, low, high = [], [], [], []
    for way, count in ((-1, slow), (1, fast)):
        if count < 30:  # so few tell no profile
            continue
        mine = np.flatnonzero(np.sign(velocity) == way)
        mine = mine[np.argsort(velocity[mine])]
        groups = min(24, count // 3)
        sizes = [count // groups + (k < count % groups) for k in range(groups)]
        at = 0
        for size in sizes:
            one = mine[at : at + size]
            speeds.append(velocity[one].mean())
            expected.append(r[one].mean())
            ordered = np.sort(r[one])
            place = 0.1 * (size - 1)
            low.append(np.interp(place, np.arange(size), ordered))
            high.append(np.interp(size - 1 - place, np.arange(size), ordered))
            at += size
        for values in (expected, speeds, low, high):
            values.append(np.nan)  # the line breaks where the motion turns
    assert drawn.x == pytest.approx(np.array(speeds), nan_ok=True)
    for shown, wanted in ((drawn.y, expected), (drawn.low, low), (drawn.high, high)):
        assert shown == pytest.approx(1e3 * np.array(wanted), nan_ok=True)


def test_the_first_and_the_last_rung_are_drawn_and_one_alone_is_the_users():
    velocity = np.linspace(0.001, 0.02, 60)
    levels = [np.full(60, level) for level in (3.0, 2.0, 1.0)]
    three = plot_over_velocity(
        samples(60, residual=levels, velocity=velocity), "prismatic", Scaled("N", 1.0)
    )
    assert [(s.name, s.y[0]) for s in three.series] == [("before", 3.0), ("after", 1.0)]
    assert three.x_label == "velocity (mm/s)" and three.y_label == "residual force (N)"
    # from 1 to 20 mm/s
    assert np.nanmin(three.series[0].x) > 1.0 and np.nanmax(three.series[0].x) < 20.0
    one = plot_over_velocity(
        samples(60, residual=levels[:1], velocity=velocity), "prismatic", Scaled("N", 1.0)
    )
    assert [s.name for s in one.series] == ["your model"]
    assert all(s.kind == "model" for s in (*three.series, *one.series))


def test_a_body_that_hardly_moved_has_no_line_over_velocity():
    rows = samples(100, residual=[np.ones(100)], velocity=np.r_[np.ones(29), np.zeros(71)])
    assert plot_over_velocity(rows, "prismatic", Scaled("N", 1.0)).series == ()


# the excerpt


def bump(n, start, length, height):
    values = np.zeros(n)
    values[start : start + length] = height
    return values


def test_an_excerpt_shows_where_the_residual_fell_most_with_the_clock_of_its_record():
    n, bandwidth = 2000, 20.0
    # 60 periods at 20 Hz are 3 s: 300 samples
    first = bump(n, 900, 300, 0.5) + bump(n, 200, 300, 0.8)
    last = bump(n, 200, 300, 0.8)  # what no effect lowered is no gain
    clock = 100.0 + H * np.arange(n)
    measured = np.linspace(1.0, 1.1, n)
    between = bump(n, 1500, 300, 0.9)  # of rungs between the first and the last none is shown
    rows = samples(n, residual=[first, between, last], measured=measured, clock=clock)
    graph = excerpt(rows, "prismatic", bandwidth)
    shown, before, after = graph.series
    assert shown.x[0] == clock[900] and len(shown.x) == 300
    assert shown.y == pytest.approx(measured[900:1200])
    assert before.y == pytest.approx(measured[900:1200] - 0.5)
    assert after.y == pytest.approx(measured[900:1200])
    assert [s.kind for s in graph.series] == ["measured", "model", "model"]
    assert (graph.x_label, graph.y_label) == ("time (s)", "force (N)")


def test_an_excerpt_with_one_model_shows_its_largest_residual():
    n = 1200
    rows = samples(n, residual=[-bump(n, 700, 300, 0.5)])
    shown, model = excerpt(rows, "prismatic", 20.0).series
    assert shown.x[0] == H * 700 and model.name == "your model"
    assert model.y == pytest.approx(np.full(300, 1.5))


def test_an_excerpt_takes_at_most_a_quarter_of_a_stretch_and_few_points():
    n = 4000
    rows = samples(n, residual=[bump(n, 2000, 1000, 1.0)])
    shown, _ = excerpt(rows, "prismatic", 1.0).series  # 60 s of 40 s
    assert shown.x[0] == H * 2000
    assert shown.x[-1] <= H * 2999 and len(shown.x) == 250  # each fourth of 1000
    assert np.allclose(np.diff(shown.x), 4 * H)
    assert graphs.EXCERPT_POINTS <= len(shown.x) < 2 * graphs.EXCERPT_POINTS


def test_an_excerpt_stays_within_one_stretch():
    n = 1000
    stretch = np.repeat([3, 5], [400, 600])
    gain = bump(n, 350, 100, 1.0)  # across the border
    rows = samples(n, residual=[gain], stretch=stretch)
    shown, _ = excerpt(rows, "prismatic", 100.0).series  # 0.6 s
    at = np.round(shown.x / H).astype(int)
    assert len(set(stretch[at])) == 1
    assert gain[at].sum() == 50  # all that one of the two has


def test_an_excerpt_shows_a_share_of_the_force_but_no_quiet_moment():
    n = 3000
    measured = np.concatenate([np.full(1000, 1.0), np.full(1000, 10.0), np.full(1000, 0.001)])
    residual = np.concatenate([np.full(1000, 0.3), np.full(1000, 1.0), np.full(1000, 0.001)])
    shown, _ = excerpt(samples(n, residual=[residual], measured=measured), "prismatic", 20.0).series
    # the share is 9 %, 1 % and all of next to nothing: mean square 33.7, of which 3 % are 1.01
    assert shown.y == pytest.approx(np.full(300, 1.0))


@given(values=st.lists(st.floats(-5, 5), min_size=1, max_size=30), part=st.floats(0, 1))
def test_a_moving_mean_is_the_mean_of_each_window(values, part):
    length = 1 + int(part * (len(values) - 1))
    means = graphs._moving_mean(np.array(values), length)
    windows = [values[k : k + length] for k in range(len(values) - length + 1)]
    assert means == pytest.approx([np.mean(w) for w in windows], abs=1e-12)


# maps and traces


@given(st.floats(1e-9, 1e9))
def test_a_scale_ends_at_a_round_value_above_what_it_shows(value):
    end = residuals._round_up(value)
    digits = float(f"{end:.6e}".partition("e")[0])
    assert digits in (1, 1.5, 2, 3, 4, 5, 6, 8)
    assert value <= end * (1 + 1e-12) and end <= 1.5 * value * (1 + 1e-12)
    # what is round already stays
    assert residuals._round_up(end) == pytest.approx(end, rel=1e-12)


@pytest.mark.parametrize("value", [0.0, -1.0])
def test_a_scale_of_nothing_ends_at_one(value):
    assert residuals._round_up(value) == 1.0


def test_edges_of_cells_reach_from_the_least_to_the_largest_value():
    edges = residuals._edges(np.array([3.0, -1.0, 2.0]), 8)
    assert edges == pytest.approx(np.linspace(-1.0, 3.0, 9))
    still = residuals._edges(np.full(5, 2.0), 4)
    assert still[0] < 2.0 < still[-1] and still[-1] - still[0] < 1e-6


def test_a_cell_shows_the_mean_of_its_samples_where_there_are_enough():
    position = np.array([0.5, 0.5, 0.5, 1.5, 1.5, 0.5, 0.6, 0.4, 0.5])
    velocity = np.array([0.5, 0.5, 0.5, 0.5, 0.5, 1.5, 1.5, 1.5, 1.5])
    r = np.array([1.0, 2.0, 6.0, 7.0, 8.0, -1.0, -2.0, -3.0, -4.0])
    rows = samples(9, residual=[r], position=position, velocity=velocity)
    means = residuals._mean(rows, r, np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 2.0]))
    assert means[0, 0] == pytest.approx(3.0) and means[1, 0] == pytest.approx(-2.5)
    assert np.isnan(means[0, 1]), "two samples are too few"
    assert np.isnan(means[1, 1])


def test_a_rung_is_shown_where_it_changed_the_body_by_more_than_rounding():
    one = np.array([1.0, -2.0, 3.0])
    rungs = (one, one.copy(), one + 1e-14, 0.5 * one, 0.5 * one)
    assert residuals._list_changed_rungs(rungs) == [0, 3]


def data_set(**columns):
    return {name: SimpleNamespace(values=np.array(v)) for name, v in columns.items()}


def test_time_along_the_records_has_neither_gaps_nor_steps_back():
    time = [0.0, 0.1, 0.2, 7.0, 7.1, 7.2, 0.0, 0.1, 0.15]
    data = data_set(
        body=["a"] * 9,
        counts=[True] * 8 + [False],
        time=time,
        segment=[0, 0, 0, 4, 4, 4, 9, 9, 9],
        position=np.arange(9.0),
        velocity=np.zeros(9),
        measured=np.ones(9),
        direction=np.zeros(9, dtype=np.int8),
        residual=np.arange(9.0) ** 2,
    )
    rows = residuals._rows([data], "a")
    assert rows.time == pytest.approx([0.0, 0.1, 0.2, 0.2, 0.3, 0.4, 0.4, 0.5])
    assert rows.clock.tolist() == time[:8]
    assert rows.stretch.tolist() == [0, 0, 0, 1, 1, 1, 2, 2]
    assert rows.residual[0].tolist() == [k**2 for k in range(8)]
    assert len(residuals._rows([data], "b").time) == 0


# prefixes


@given(
    unit=st.sampled_from(["m", "m/s", "N", "N*m", "rad", "rad/s"]),
    size=st.floats(1e-8, 1e4),
)
def test_a_prefix_makes_values_at_least_one_half_and_no_larger_than_it_must(unit, size):
    shown = choose_prefix(unit, size)
    written = shown.unit.replace("µ", "u").replace("·", "*")
    quantity, axis = {
        "m": ("position", "prismatic"),
        "m/s": ("velocity", "prismatic"),
        "N": ("force", "prismatic"),
        "N*m": ("force", "revolute"),
        "rad": ("position", "revolute"),
        "rad/s": ("velocity", "revolute"),
    }[unit]
    assert shown.factor * si_factor(written, quantity=quantity, axis=axis) == pytest.approx(1.0)
    assert size * shown.factor >= 0.5 or shown.factor == choose_prefix(unit, 1e-30).factor
    # the next larger unit would show less than one half
    assert shown.factor == 1.0 or 1e-3 * shown.factor * size < 0.5


@pytest.mark.parametrize(("unit", "size", "shown"), [("m", 0.5, "m"), ("m", 5e-4, "mm")])
def test_one_half_of_a_unit_is_shown_in_it(unit, size, shown):
    assert choose_prefix(unit, size).unit == shown


def test_a_unit_without_prefixes_stays_as_it_is():
    assert choose_prefix("kg*m^2", 1e-9) == Scaled("kg·m²", 1.0)


def test_the_size_of_values_leaves_two_in_a_hundred_out():
    assert size_of(np.arange(-100.0, 1.0)) == pytest.approx(98.0)
    assert size_of(np.r_[np.arange(98.0), 98.0, 1e6, -1e6]) == pytest.approx(98.0)


# findings


def test_a_graph_of_a_page_has_few_points_and_a_finding_without_one_stays():
    x = np.arange(5.0 * POINTS)
    plain = Finding("topic", "note", "said")
    drawn = Finding("topic", "note", "said", graph=Graph("x", "y", (Series("a", x, x),)))
    short = Finding("topic", "note", "said", graph=Graph("x", "y", (Series("a", x[:9], x[:9]),)))
    graphs_of_limit = limit_size([plain, drawn, short])
    assert graphs_of_limit[0] == plain
    assert 0.5 * POINTS < len(graphs_of_limit[1].graph.series[0].x) <= POINTS
    assert graphs_of_limit[2] == short
