"""The loops of the low-pass as Python runs them, against scipy and against matrices."""

import itertools

import numpy as np
import pytest
from scipy.signal import butter, sosfilt, sosfiltfilt

from teleopdesign.measurement import zero_phase, zero_phase_spans
from teleopdesign.measurement.zero_phase import lanes, margin, sections
from teleopdesign.measurement.zero_phase_spans import (
    LEAST_CUTOFF,
    NEAR,
    crossings,
    reach,
    response,
    spans_of,
    windows,
)

H = 1e-3


@pytest.fixture
def plain(monkeypatch):
    """No compiled function: each one in Python."""
    for module in (zero_phase, zero_phase_spans):
        for name, value in list(vars(module).items()):
            if hasattr(value, "py_func"):
                monkeypatch.setattr(module, name, value.py_func)


def by_scipy(y, cutoff, m):
    sos = butter(4, cutoff, fs=1 / H, output="sos")
    return sosfiltfilt(sos, y, axis=0, padtype="odd", padlen=m)


@pytest.mark.parametrize(("n", "m", "signals"), [(25, 7, 2), (8, 7, 1)])
def test_forward_and_backward_is_the_filter_of_scipy(plain, n, m, signals):
    y = np.random.default_rng(3).normal(size=(n, signals))
    whole = np.full((n + 2 * m, signals), np.nan)
    zero_phase.filter_both_ways(y, whole, *sections(40.0, H))
    assert whole[m : m + n] == pytest.approx(by_scipy(y, 40.0, m), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    "rows",
    [[0], [69], [34], [0, 1, 2, 69], [3, 40], [21, 48], [18, 19, 51, 66], [25, 45, 47], [68, 69]],
)
def test_spans_of_a_record_are_filtered_as_scipy_filters_all_of_it(plain, rows):
    n, m, cutoff = 70, 20, 60.0
    y = np.zeros((n, 2))
    y[rows] = np.random.default_rng(4).normal(size=(len(rows), 2))
    known = sections(cutoff, H)
    spans = spans_of(np.array(rows), n, m, cutoff * H)
    filters = (*known, *zero_phase_spans.connect_spans(spans, *crossings(cutoff, H)))
    spanned = np.full((n + 2 * m, 2), np.nan)
    zero_phase_spans.filter_spans(y, spanned, spans, filters)
    expected = by_scipy(y, cutoff, m)[rows]
    assert spanned[m + np.array(rows)] == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_powers_cross_as_many_rows_as_they_say(plain):
    """Free states after 1, 2, 4, 8 rows without input, and what their output adds on its way."""
    crossings.cache_clear()
    free, back = crossings(50.0, H)
    crossings.cache_clear()
    sos = sections(50.0, H)[0]
    for k in range(4):
        for i, unit in enumerate(np.eye(4)):
            output, states = sosfilt(sos, np.zeros(2**k), zi=unit.reshape(2, 2))
            assert free[k][:, i] == pytest.approx(states.reshape(-1), rel=1e-9, abs=1e-14)
            _, added = sosfilt(sos, output[::-1], zi=np.zeros((2, 2)))
            assert back[k][:, i] == pytest.approx(added.reshape(-1), rel=1e-9, abs=1e-14)
    assert len(free) == len(back) == 40 and not free[-1].any()


@pytest.mark.parametrize("rows", [0, 1, 2, 3, 6, 13])
def test_any_number_of_rows_is_crossed_by_powers_of_two(plain, rows):
    free, back = crossings(50.0, H)
    step, swing = np.zeros((4, 4)), np.zeros((4, 4))
    zero_phase_spans._cross(rows, step, swing, free, back)
    assert step == pytest.approx(np.linalg.matrix_power(free[0], rows), rel=1e-9, abs=1e-14)
    expected = sum(
        (
            np.linalg.matrix_power(free[0], k) @ back[0] @ np.linalg.matrix_power(free[0], k)
            for k in range(rows)
        ),
        np.zeros((4, 4)),
    )
    assert swing == pytest.approx(expected, rel=1e-9, abs=1e-14)


N, M = 90, 12


@pytest.mark.parametrize(
    "rows",
    [
        *([k] for k in (0, 1, 11, 12, 13, 76, 77, 78, 88, 89)),
        [0, 89], [12, 77], [20, 37], [20, 38], [20, 21, 22, 60], [1, 88],
    ],
)  # fmt: skip
def test_spans_hold_exactly_what_the_continued_record_has_of_these_rows(rows):
    """The continuation of numpy for each row alone; first and last sample always belong to it."""
    changed = np.zeros(N + 2 * M, dtype=bool)
    changed[[0, -1]] = True
    for row in rows:
        unit = np.zeros(N)
        unit[row] = 1.0
        changed |= np.pad(unit, M, mode="reflect", reflect_type="odd") != 0
    places = np.flatnonzero(changed).tolist()
    expected = [[places[0], places[0] + 1]]
    for place in places[1:]:
        if place - expected[-1][1] <= NEAR:
            expected[-1][1] = place + 1
        else:
            expected.append([place, place + 1])
    assert spans_of(np.array(rows), N, M, 0.1).tolist() == expected
    assert spans_of(np.array(rows), N, M, LEAST_CUTOFF).tolist() == expected
    assert spans_of(np.array(rows), N, M, 0.99 * LEAST_CUTOFF).tolist() == [[0, N + 2 * M]]


@pytest.mark.parametrize("cutoff", [20.0, 150.0])
def test_a_row_reaches_as_far_as_the_slowest_pole_decays_to_1e_18(cutoff):
    poles = np.abs(butter(4, cutoff, fs=1 / H, output="zpk")[1]).max()
    rows = reach(cutoff, H)
    assert poles**rows <= 1e-18 < poles ** (rows - 1)


@pytest.mark.parametrize("cutoff", [20.0, 150.0])
def test_the_response_of_a_row_ends_where_a_thousandth_is_left(cutoff):
    n = 2001
    impulse = np.zeros((n, 1))
    impulse[n // 2] = 1.0
    side = np.abs(by_scipy(impulse, cutoff, 600))[n // 2 :, 0]
    answer = response(cutoff, H)
    assert answer == pytest.approx(side[: len(answer)], rel=1e-9, abs=1e-15)
    assert answer[-1] > 1e-3 * side[0] and side[len(answer) :].max() <= 1e-3 * side[0]


def gains_by_matrix(rows, n, response):
    """Groups by distance; of each the largest sum of a line of its matrix, at most 1."""
    far = len(response)
    groups = [[rows[0]]]
    for a, b in itertools.pairwise(rows):
        if b - a >= far:
            groups.append([])
        groups[-1].append(b)
    bounds = []
    for group in groups:
        apart = np.abs(np.subtract.outer(group, group))
        matrix = np.where(apart < far, np.asarray(response)[np.minimum(apart, far - 1)], 0.0)
        largest = min(matrix.sum(axis=1).max(), 1.0)
        at_an_end = group[0] < far or group[-1] >= n - far
        bounds += [1.0 if at_an_end else largest] * len(group)
    return bounds


@pytest.mark.parametrize(
    "rows",
    [
        [10], [2], [3], [2, 10], [3, 10], [36], [37], [10, 36], [10, 37], [10, 12], [10, 13],
        [10, 11, 12], [10, 12, 14], [10, 12, 14, 20, 21], [2, 4, 20, 22], [10, 15, 16, 17, 18, 30],
        [10, 12, 13, 15, 17],
    ],
)  # fmt: skip
def test_gains_of_rows_are_bounded_group_by_group(plain, rows):
    answer = [0.3, 0.15, 0.1]
    bounds = zero_phase_spans.gains(np.array(rows), 40, np.array(answer))
    assert bounds == pytest.approx(gains_by_matrix(rows, 40, answer))
    large = zero_phase_spans.gains(np.array(rows), 40, np.array([0.9, 0.4, 0.2]))
    assert large == pytest.approx(gains_by_matrix(rows, 40, [0.9, 0.4, 0.2]))


def test_columns_are_one_two_eight_and_from_there_a_multiple_of_four():
    assert [lanes(k) for k in (1, 2, 3, 8, 9, 12, 13)] == [1, 2, 8, 8, 12, 12, 16]
    rows = np.arange(6.0).reshape(3, 2)
    beside = zero_phase.columns(rows)
    assert beside.shape == (2, 8) and not beside[:, 3:].any()
    assert np.array_equal(beside[:, :3], rows.T)


def test_a_record_is_continued_by_0_6_s_but_by_less_than_its_length():
    assert [margin(n, H) for n in (2000, 602, 601, 600, 2, 1)] == [600, 600, 600, 599, 1, 1]
    assert margin(10, 2.0) == 1


def test_single_samples_of_the_filtered_record_are_those_of_all(plain):
    y = np.random.default_rng(5).normal(size=(2, 3, 30))
    whole = zero_phase.zero_phase(y, 40.0, H)
    assert whole.shape == y.shape
    assert whole[1, 2] == pytest.approx(by_scipy(y[1, 2], 40.0, 29), rel=1e-9, abs=1e-12)
    at = np.array([0, 7, 29])
    assert np.array_equal(zero_phase.zero_phase(y, 40.0, H, at), whole[..., at])


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([20], [(15, 26)]),
        ([20, 31], [(15, 26), (26, 37)]),
        ([20, 30], [(15, 36)]),
        ([5], [(0, 11)]),
        ([6], [(1, 12)]),
        ([93], [(88, 99)]),
        ([94], [(89, 100)]),
        ([20, 50, 80], [(15, 26), (45, 56), (75, 86)]),
        ([6, 17, 28, 39, 50, 61, 72], [(0, 100)]),  # 77 of 100 samples
        ([6, 17, 28, 39, 50, 61], [(k - 5, k + 6) for k in (6, 17, 28, 39, 50, 61)]),
    ],
)
def test_windows_of_rows_that_reach_five_samples(rows, expected):
    assert windows(np.array(rows), 100, 3, 5) == expected
    if rows == [5]:  # what mirrors the first m rows
        assert windows(np.array(rows), 100, 20, 5) == [(0, 21)]
    if rows == [94]:
        assert windows(np.array(rows), 100, 20, 5) == [(79, 100)]
