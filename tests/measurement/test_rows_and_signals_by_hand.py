"""Rows that a log repeats or lost, and signals on the clock of a record, by hand."""

from dataclasses import replace

import numpy as np
import pytest
from check.made_channels import H

from teleopdesign.measurement import log_clock
from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.record_clock import RecordClock
from teleopdesign.measurement.repeated_rows import (
    _goes_on,
    _leaps,
    _noise_vanishes,
    rows_between_readings,
    stuck_stretches,
)
from teleopdesign.measurement.resample import filling_error, resample_on_grid
from teleopdesign.measurement.signals_of_log import (
    _describe_lost_rows,
    _describe_signal_clock,
    _restore_steps,
    rule_of,
)


def made_clock(off, **more):
    """Rows on a grid of 1 ms, with stamps that are off by parts of it."""
    n = len(off)
    places, whole = np.arange(n), (slice(0, n),)
    known = RecordClock(places, H * (places + off), places, H * places, H, whole, whole)
    return replace(known, **more)


# repeated rows


@pytest.mark.parametrize(("readings", "there"), [(49, False), (50, True)])
def test_a_slower_source_needs_fifty_readings(readings, there):
    source = np.repeat(np.arange(readings + 1), 4)
    stamps = 0.001 * np.arange(len(source))
    x, u = 10.0 * np.sin(0.1 * source), np.cos(0.3 * source)
    between = rows_between_readings([x, u], [x], stamps)
    assert np.count_nonzero(~between) == (readings if there else len(stamps))
    assert not between[4::4].any() and between[1::4].all() == there


def test_a_force_goes_on_where_it_changes_in_each_of_six_rows_before_and_behind():
    y = np.array([0.0, 1, 2, 3, 4, 5, 5, 5, 5, 6, 7, 8, 9, 10, 11, 12])
    first, past = 5, 8  # changes 5, 6, 7 are zero
    assert _goes_on(y, first, past)
    for same in range(1, 6):
        z = y.copy()
        z[same:] -= z[same] - z[same - 1]
        assert not _goes_on(z, first, past), "before"
    for same in range(10, 14):
        z = y.copy()
        z[same:] -= z[same] - z[same - 1]
        assert not _goes_on(z, first, past), "behind"


@pytest.mark.parametrize(("leap", "there"), [(4.9, False), (5.1, True)])
def test_a_reading_leaps_by_more_than_five_usual_changes(leap, there):
    x = np.array([*np.arange(8.0), 7.0, 7.0, 7.0, *(7.0 + leap + np.arange(8.0))])
    assert _leaps(x, 7, 10, 0.0) == there
    assert not _leaps(x, 7, 10, 1.1) and not _leaps(x, 4, 10, 0.0)
    assert _leaps(x[:17], 7, 10, 0.0) == there and not _leaps(x[:16], 7, 10, 0.0)
    behind = x.copy()
    behind[11:] += np.arange(8.0)  # twice the change behind it
    assert not _leaps(behind, 7, 10, 0.0)


@pytest.mark.parametrize("turns", [7, 8])
def test_noise_turns_round_in_four_of_ten_changes_on_both_sides(turns):
    """Twenty changes to either side, nineteen pairs of them: eight of nineteen are enough."""
    changes = [(-1.0) ** min(k, turns) for k in range(20)]
    side = np.cumsum([0.0, *changes])
    y = np.concatenate([side, [side[-1]] * 12, side[-1] + side[1:]])
    first, past = 20, 32
    assert _noise_vanishes(y, first, past) == (turns == 8)
    assert not _noise_vanishes(y[1:], first - 1, past - 1)
    assert not _noise_vanishes(y[:-1], first, past)


@pytest.mark.parametrize(
    ("changes", "is_stuck"),
    [((12, 12, 6), False), ((12, 12, 12), True), ((12, 9, 12), True), ((14, 12, 12), True),
     ((17, 12, 12), False), ((12, 12, 3), False), ((4, 4, 4), True), ((3, 3, 3), False)],
)  # fmt: skip
def test_a_position_stops_dead_where_it_slows_by_less_than_a_fifth_of_its_speed(changes, is_stuck):
    """A sample, over the last three changes before the hold; three steps are no motion."""
    x = np.cumsum([0.0, changes[0], changes[0], *changes, *[0.0] * 12])
    stretches = stuck_stretches(x, 1.0, "position")
    assert stretches == ([(5, 18)] if is_stuck else [])
    assert stuck_stretches(x, 1.0, "actuator_force") == []
    assert stuck_stretches(x[1:], 1.0, "position") == [], "four changes before it are few"


# signals on the clock


def test_the_rule_of_a_channel_between_rows():
    def rule(quantity, values):
        return rule_of(Channel(quantity, "device", "x", "N", None, None), np.asarray(values))

    sixteen, seventeen = np.tile(np.arange(16.0), 3), np.tile(np.arange(17.0), 3)
    assert rule("actuator_force", seventeen + 0.5) == "held"
    assert rule("position", sixteen) == "position"
    assert rule("load", sixteen) == "held" and rule("load", seventeen) == "line"
    assert rule("load", sixteen + 0.5) == "line"
    assert rule("velocity", sixteen) == "line" == rule("interaction_force", sixteen)


def test_a_filled_position_keeps_the_steps_of_its_readings():
    known = Channel("position", "device", "x", "m", None, None)
    values = 7.0 + 0.5 * np.array([0, 1, 3, 4, 6, 7, 9.0])
    out = np.array([7.0, 7.26, 7.5, 8.2, 8.5])
    assert _restore_steps(out, values, known, 0.5).tolist() == [7.0, 7.5, 7.5, 8.0, 8.5]
    for other, step in ((known, 0.0), (replace(known, resolution=0.5), 0.5), (known, 0.3)):
        assert _restore_steps(out, values, other, step) is out
    force = replace(known, quantity="interaction_force")
    assert _restore_steps(out, values, force, 0.5) is out
    assert _restore_steps(values, values, known, 0.5) is values


def test_lost_rows_say_how_far_positions_and_forces_err():
    """Filled as if each known row were lost: by the cubic (x-term) and by the line between."""
    n = 41
    random = np.random.default_rng(5)
    x = np.cumsum(random.uniform(1.0, 2.0, n))
    f, v = random.normal(size=n), random.normal(size=n)
    made = log_clock.LogClock(made_clock(np.zeros(n), lost=3), False)
    channels = {
        "device.position": Channel("position", "device", "x", "m", 0.5, None),
        "device.velocity": Channel("velocity", "device", "v", "m/s", None, None),
        "device.actuator_force": Channel("actuator_force", "device", "f", "N", None, None),
    }
    readings = {"device.position": x, "device.velocity": v, "device.actuator_force": f}
    step = _describe_lost_rows(readings, channels, made, "a.csv")
    inner = np.arange(2, n - 2)
    cubic = (-x[inner - 2] + 4 * x[inner - 1] + 4 * x[inner + 1] - x[inner + 2]) / 6
    slow = x[inner + 1] - x[inner - 1] <= 2 * 2.5 * 0.5  # 2.5 steps a row
    half = x[inner - 1] + 0.5 * np.rint((x[inner + 1] - x[inner - 1]) / 2 / 0.5)
    wrong = np.sqrt(np.mean((np.where(slow, half, cubic) - x[inner]) ** 2))
    of_force = np.sqrt(np.mean((0.5 * (f[inner - 1] + f[inner + 1]) - f[inner]) ** 2))
    size = np.sqrt(3 / n) * of_force / np.sqrt(np.mean(f**2))
    assert step.observed == f"3 rows lost, {100 * 3 / n:.2g} %"
    assert step.effect.startswith(f"adds at most {100 * size:.2g} % of the force;")
    assert step.effect.endswith(f"positions there err by {float(f'{wrong / 0.5:.2g}'):g} steps")
    assert dict(step.numbers) == pytest.approx({"lost": 3, "part": 3 / n, "force_error": size})
    beside = {"device.position": x}  # the force has stamps of its own
    assert np.isnan(dict(_describe_lost_rows(beside, channels, made, "a").numbers)["force_error"])
    assert filling_error(x[:4], made_clock(np.zeros(4)), "line", step=0.0) != 0.0


def test_commands_in_no_row_say_how_far_they_err():
    f = np.random.default_rng(6).normal(size=41)
    made = log_clock.LogClock(made_clock(np.zeros(41)), True)
    step = _describe_signal_clock(f, made, 0.25, 0.04, "a.csv", "force")
    inner = np.arange(2, 39)
    wrong = np.sqrt(np.mean((0.5 * (f[inner - 1] + f[inner + 1]) - f[inner]) ** 2))
    size = 0.2 * wrong / np.sqrt(np.mean(f**2))
    expected = {"phase": 0.25 * H, "missing": 0.04, "force_error": size}
    assert dict(step.numbers) == pytest.approx(expected)
    assert step.effect == f"adds at most {100 * size:.2g} % of the force"
    assert "4 % of the commands are in no row" in step.rule


def test_after_a_clock_was_set_back_rows_go_on_at_their_places():
    """The second stretch begins 0.3 samples after its first place, but its clock was set."""
    places = np.array([0, 1, 2, 3, 4, 5, 6, 7])
    time = H * np.array([0, 1, 2, 3, 10, 11, 12, 13.0])
    stamps = H * np.array([0, 1, 2, 3, 0.3, 1.3, 2.3, 3.3])
    parts = slice(0, 4), slice(4, 8)
    made = RecordClock(places, stamps, places, time, H, parts, parts, False, restarts=1)
    values = np.array([0.0, 1, 2, 3, 50, 60, 70, 80])
    out = resample_on_grid(values, made, "line", stamped=True, step=0.0)
    assert out == pytest.approx(values)
    late = resample_on_grid(values, made, "line", stamped=True, step=0.0, delay=0.5 * H)
    assert late == pytest.approx([0.5, 1.5, 2.5, 3.0, 55.0, 65.0, 75.0, 80.0])
