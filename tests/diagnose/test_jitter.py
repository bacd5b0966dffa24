"""A clock that jitters is noise: the floor holds it, and nothing that weakens it is an effect."""

import numpy as np
import pytest
from diagnose.made_records import jittered
from diagnose.simulated_cases import write_simulated

from teleopdesign import load_experiment
from teleopdesign.check.sample_clock import jitter_share
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.measurement.encoder import sampling_jitter
from teleopdesign.measurement.prepare import prepare
from teleopdesign.model import Model


@pytest.fixture(scope="module")
def adequate(tmp_path_factory):
    return load_experiment(
        write_simulated(tmp_path_factory.mktemp("jitter") / "case", None, seed=1)
    )


def test_a_right_model_lies_at_its_floor_though_the_clock_jitters(adequate):
    prepared = prepare(jittered(adequate, 0.3))
    model = Model.from_experiment(adequate)
    fit = estimate_from_starts(model, prepared)
    floor = noise_floor(fit.model, prepared, np.random.default_rng(0))
    still = noise_floor(fit.model, prepare(adequate), np.random.default_rng(0))
    assert floor.jitters and not still.jitters
    assert floor.value > 2.0 * still.value
    # the jitter is known to a fifth; noise in the acceleration makes the inertia look smaller
    assert 0.7 < fit.check_error / floor.value < 1.4


@pytest.mark.parametrize("share", [0.02, 0.1])
def test_a_fast_motion_without_jitter_shows_none(share):
    """A tenth of the sample rate: few rows a period, and slow and fast stretches in turn."""
    t = np.arange(8000.0)
    x = np.sin(2 * np.pi * 0.0008 * t) * np.sin(2 * np.pi * share * t)
    assert sampling_jitter(x, 1e-6, 1.0) < 0.01


def test_the_share_of_jitter_is_what_newly_drawn_readings_add_to_the_acceleration(adequate):
    """`jitter_share` is computed from gains; here the readings are drawn again."""
    jitters = jittered(adequate, 0.1)
    prepared, still = prepare(jitters), prepare(adequate)
    pairs = zip(prepared.of("fit"), still.of("fit"), strict=True)
    added = whole = 0.0
    for late, exact in pairs:
        ours, true = (s.motion.lowpassed(s.motion.acceleration, s.keep) for s in (late, exact))
        added, whole = added + np.sum((ours - true) ** 2), whole + np.sum(ours**2)
    assert jitter_share(prepared.of("fit"), jitters) == pytest.approx(added / whole, rel=0.5)
    assert jitter_share(still.of("fit"), adequate) == 0.0
