"""A channel of another clock: its lag grows along the record; a delay corrects the mean alone."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign import Model, example, load_experiment
from teleopdesign.check import clock_drift
from teleopdesign.check.clock_drift import _grows_evenly, _quarters, find_drift
from teleopdesign.check.force_balance import Estimate
from teleopdesign.check.plausibility import check_plausibility
from teleopdesign.measurement.prepare import prepare


@pytest.fixture(scope="module")
def rod():
    return load_experiment(example("rod"))


def findings_with(experiment, quantity, moments):
    """Findings where the row at each time holds the value of another moment: moments(t) (s)."""
    key = f"device.{quantity}"

    def change(record):
        t = record.sample_time * np.arange(len(record.signals[key]))
        signal = np.interp(moments(t), t, record.signals[key])
        return replace(record, signals={**record.signals, key: signal})

    records = tuple(map(change, experiment.records))
    changed = replace(experiment, records=records)
    findings = check_plausibility(Model.from_experiment(changed), prepare(changed))
    return [f for f in findings if f.topic in ("clock drift", "time shift")]


@pytest.mark.parametrize("quantity", ["actuator_force", "position"])
@pytest.mark.parametrize("rate", [-2e-3, 2e-3])
def test_a_channel_with_another_clock_is_named_with_the_rate(rod, quantity, rate):
    (finding,) = findings_with(rod, quantity, lambda t: (1.0 + rate) * t)
    assert (finding.topic, finding.concern) == ("clock drift", "warning")
    assert finding.sentence.startswith(quantity)
    assert finding.numbers["rate"] == pytest.approx(rate, rel=0.15)
    assert np.sign(finding.numbers["last"]) == -np.sign(rate)
    assert f"value of time {1.0 + finding.numbers['rate']:.5g} t" in finding.sentence
    # corrected by what it says, no lag is left that grows
    rest = (1.0 + rate) / (1.0 + finding.numbers["rate"])
    left = findings_with(rod, quantity, lambda t: rest * t)
    assert not [f for f in left if f.topic == "clock drift"]


@pytest.mark.parametrize("quantity", ["actuator_force", "position"])
def test_a_constant_lag_is_no_drift(rod, quantity):
    (finding,) = findings_with(rod, quantity, lambda t: t - 5e-3)
    assert finding.topic == "time shift"
    # nor is one that jumps in the middle, as where a logger lost rows
    jumps = findings_with(rod, quantity, lambda t: t - 8e-3 * (t > t[-1] / 2))
    assert not [f for f in jumps if f.topic == "clock drift"]


def lags(*values, error=1e-4):
    return [Estimate(v, error) for v in values]


MIDDLES = np.array([1.0, 3.0, 5.0, 7.0])


@pytest.mark.parametrize(
    ("late", "rate", "grows"),
    [
        (lags(0.0, 2e-3, 4e-3, 6e-3), -1e-3, True),
        (lags(9e-3, 7e-3, 5e-3, 3e-3), 1e-3, True),
        (lags(0.0, 2e-3, 4e-3, 6e-3, error=2e-3), -1e-3, False),  # not sure
        (lags(0.0, 0.3e-3, 0.6e-3, 0.9e-3), -0.15e-3, False),  # less than a row
        (lags(0.0, 0.5e-3, 5.5e-3, 6e-3), -1.15e-3, True),  # 1.35 ms from the line, of 6.9 ms
        (lags(0.0, 0.0, 0.0, 6e-3), -0.9e-3, False),  # 2.1 ms from the line, of 5.4 ms
    ],
)
def test_a_lag_grows_evenly_by_a_row_or_more(late, rate, grows):
    assert _grows_evenly(MIDDLES, late, rate, 1e-3) == grows


CONSTANT, GROWS, HALF, FALLS = (
    (0.0, 0.0, 0.0, 0.0),
    (0.0, 2e-3, 4e-3, 6e-3),
    (0.0, 1e-3, 2e-3, 3e-3),
    (0.0, -2e-3, -4e-3, -6e-3),
)


@pytest.mark.parametrize(
    ("actuator", "interaction", "position", "expected"),
    [
        (CONSTANT, GROWS, None, ("interaction_force", -1e-3, 0.0, 6e-3)),
        (FALLS, CONSTANT, None, ("actuator_force", 1e-3, 0.0, -6e-3)),
        (GROWS, GROWS, None, ("position", 1e-3, 0.0, -6e-3)),  # both forces alike
        (None, None, FALLS, ("position", 1e-3, 0.0, -6e-3)),
        (GROWS, HALF, None, None),
        (GROWS, FALLS, None, None),
        (CONSTANT, CONSTANT, None, None),
    ],
)
def test_the_channel_is_the_one_whose_lag_grows_alone(
    rod, monkeypatch, actuator, interaction, position, expected
):
    """Of two measured forces; what is not named in a quarter has no lag there."""
    late = {"actuator_force": actuator, "interaction_force": interaction, "position": position}

    def balance(k=None, left=0.1):
        named = {n: Estimate(v[k], 1e-4) for n, v in late.items() if k is not None and v}
        return SimpleNamespace(
            lead="actuator_force", other="interaction_force", shifts=named, left=left
        )

    def find(left=0.1, missing=None):
        quarters = iter(range(4))
        one = lambda *_: None if (k := next(quarters)) == missing else balance(k, left)  # noqa: E731
        monkeypatch.setattr(clock_drift, "force_balance", one)
        monkeypatch.setattr(clock_drift, "_quarters", lambda _: (MIDDLES, [[]] * 4))
        return find_drift(None, prepare(rod).of("fit"), balance(left=0.2))

    drift = find()
    if expected is None:
        assert drift is None
        return
    channel, rate, first, last = expected
    assert drift.channel == channel and drift.left == pytest.approx(0.1)
    assert (drift.rate, drift.first, drift.last) == pytest.approx((rate, first, last))
    assert find(left=0.19) is None, "the quarters leave as much"
    assert find(missing=2) is None, "a quarter without motion"


def test_quarters_are_those_of_the_time_since_each_record_began(rod):
    """Two stretches of one record, and a record of less than half the time."""
    stretch = prepare(rod).of("fit")[0]
    half = len(stretch.keep) // 2
    first, second = (replace(stretch, keep=rows) for rows in np.split(stretch.keep, [half]))
    middles, parts = _quarters([first, second])
    times = stretch.motion.time[stretch.keep] - stretch.motion.time[0]
    quarter = np.clip((4 * times / times[-1]).astype(int), 0, 3)
    assert middles == pytest.approx([times[quarter == k].mean() for k in range(4)], rel=1e-2)
    rows = sum(len(s.keep) for part in parts for s in part)
    assert 0 <= rows - len(stretch.keep) <= 3, "a row at a border counts on both sides"
    early = stretch.keep[times < 0.45 * times[-1]]
    short = replace(stretch, keep=early, motion=replace(stretch.motion, file="other.csv"))
    assert [len(part) for part in _quarters([stretch, short])[1]] == [2, 2, 1, 1]
