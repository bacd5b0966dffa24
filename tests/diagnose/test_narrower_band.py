"""A filtered or coarse position leads to a proposal of a narrower bandwidth, and only then."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

import teleopdesign as td
from teleopdesign import Model
from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.narrower_band import narrower_band
from teleopdesign.fitted_checks.bandwidth import check_bandwidth
from teleopdesign.measurement.prepare import prepare


def with_position(experiment, read):
    """The experiment with positions as another sensor reads them; no bandwidth stated."""
    name = "device.position"
    records = tuple(
        replace(r, signals={**r.signals, name: read(r.signals[name], r.sample_time)})
        for r in experiment.records
    )
    return replace(experiment, records=records, bandwidth=None)


def coarse_and_filtered(position, sample_time):
    """Read in 200 steps over its travel, then filtered by a firmware: no step is left to see."""
    step = np.ptp(position) / 200
    part = sample_time / (0.003 + sample_time)
    start = step * np.round(position[0] / step)
    steps = step * np.round(position / step) - start
    return start + lfilter([part], [1.0, part - 1.0], steps)


@pytest.fixture(scope="module")
def filtered(experiment):
    spoiled = with_position(experiment, coarse_and_filtered)
    return Model.from_experiment(spoiled), prepare(spoiled)


def test_a_coarse_and_filtered_position_is_reported_to_need_forces_that_nothing_shows(filtered):
    model, prepared = filtered
    narrower = narrower_band(model, prepared)
    assert narrower is not None and narrower.chosen == prepared.bandwidth
    assert narrower.bandwidth < narrower.chosen
    assert CRITERIA.far_larger * narrower.error < narrower.error_at_chosen
    assert f"bandwidth = {{ value = {narrower.bandwidth:.3g}" in str(narrower)


def test_check_proposes_the_narrower_band_and_no_wider_one(filtered):
    model, prepared = filtered
    topics = [f.topic for f in check_bandwidth(model, prepared)]
    assert "bandwidth" in topics and "motion beyond the bandwidth" not in topics


def test_a_position_as_its_encoder_reads_it_asks_for_no_narrower_band(experiment):
    plain = with_position(experiment, lambda position, sample_time: position)
    assert narrower_band(Model.from_experiment(plain), prepare(plain)) is None


def test_a_bandwidth_that_is_stated_is_the_users(filtered):
    model, prepared = filtered
    stated = replace(prepared.experiment, bandwidth=prepared.bandwidth)
    assert narrower_band(model, replace(prepared, experiment=stated)) is None


@pytest.mark.slow
def test_such_a_position_is_diagnosed_in_a_narrower_band(filtered):
    """The lag of the sensor's filter remains there, and looks like one of the actuator."""
    diagnosis = td.diagnose(filtered[1].experiment, among=("actuator_lag",))
    assert diagnosis.bandwidth < filtered[1].bandwidth
    assert diagnosis.after.check_error < 0.1
    assert any("faster than" in words for words in diagnosis.left_out)
