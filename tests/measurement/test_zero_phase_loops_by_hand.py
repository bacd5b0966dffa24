"""The loops of the low-pass as Python runs them, against scipy and against matrices."""

import itertools

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from teleopdesign.measurement import zero_phase
from teleopdesign.measurement.zero_phase import lanes, margin, reach, response, sections, windows

H = 1e-3


@pytest.fixture
def plain(monkeypatch):
    """No compiled function: each one in Python."""
    for name, value in list(vars(zero_phase).items()):
        if hasattr(value, "py_func"):
            monkeypatch.setattr(zero_phase, name, value.py_func)


def by_scipy(y, cutoff, m):
    sos = butter(4, cutoff, fs=1 / H, output="sos")
    return sosfiltfilt(sos, y, axis=0, padtype="odd", padlen=m)


@pytest.mark.parametrize(("n", "m", "signals"), [(25, 7, 2), (8, 7, 1)])
def test_forward_and_backward_is_the_filter_of_scipy(plain, n, m, signals):
    y = np.random.default_rng(3).normal(size=(n, signals))
    whole = np.full((n + 2 * m, signals), np.nan)
    zero_phase.filter_both_ways(y, whole, *sections(40.0, H))
    assert whole[m : m + n] == pytest.approx(by_scipy(y, 40.0, m), rel=1e-9, abs=1e-12)


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
    bounds = zero_phase.gains(np.array(rows), 40, np.array(answer))
    assert bounds == pytest.approx(gains_by_matrix(rows, 40, answer))
    large = zero_phase.gains(np.array(rows), 40, np.array([0.9, 0.4, 0.2]))
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
