"""A tone from outside: told from what the motion itself brings about."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.made_records import write_made
from diagnose.simulated_cases import write_simulated

import teleopdesign as td
from teleopdesign.diagnose.error import weigh_residuals
from teleopdesign.diagnose.evidence import check_squares
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.outside_tone import best_tone
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.measurement.prepare import prepare

FRICTION = 'coulomb = { level = { value = 1.0, unit = "N*m" } }'


@pytest.fixture(scope="module")
def rod():
    experiment = td.load_experiment(td.example("rod"))
    prepared = prepare(experiment)
    return prepared, estimate_from_starts(td.Model.from_experiment(experiment), prepared)


def with_residual(fit, prepared, force):
    """The fit with force(time) as what it leaves, N."""

    def left(use):
        stretches = prepared.of(use)
        return weigh_residuals(stretches, [force(s.motion.time[s.keep]) for s in stretches])

    return replace(fit, fit_residual=left("fit"), check_residual=left("check"))


@pytest.mark.parametrize("frequency", [17.0, 23.0])
def test_a_tone_is_taken_away_whatever_its_phase_on_each_record(rod, frequency):
    prepared, fit = rod
    noise = np.random.default_rng(1)
    hum = with_residual(
        fit,
        prepared,
        lambda t: np.sin(2 * np.pi * frequency * t + t[0]) + 0.1 * noise.standard_normal(len(t)),
    )
    # noise of a tenth: a hundredth of twice the squares
    assert best_tone(hum, prepared).squares < 0.03 * check_squares(hum)


@pytest.mark.parametrize("harmonic", [2, 3])
def test_harmonics_of_a_periodic_motion_are_no_tone_from_outside(tmp_path, harmonic):
    """Friction makes them of one sine: of its direction the odd ones, of its size the even ones."""

    def sine(t):
        return 0.1 * np.sin(2 * np.pi * 0.5 * t)

    runs = {"fit": [(40.0, sine)], "check": [(40.0, sine)]}
    how = {"effects": FRICTION, "step": 1e-5, "noise": 1e-3}
    folder = write_made(tmp_path / "case", runs, lambda t, x, v: np.sign(v), **how)
    experiment = td.load_experiment(folder)
    prepared = prepare(experiment)
    fit = estimate(td.Model.from_experiment(experiment), prepared)
    left = with_residual(fit, prepared, lambda t: np.sin(2 * np.pi * 0.5 * harmonic * t))
    assert best_tone(left, prepared).residual is None
    beside = with_residual(fit, prepared, lambda t: np.sin(2 * np.pi * 0.5 * (harmonic + 0.5) * t))
    assert best_tone(beside, prepared).residual is not None


@pytest.mark.parametrize("bandwidth", [18.0, 60.0])
def test_a_tone_above_the_band_is_as_strong_as_what_the_band_shows_of_it_says(rod, bandwidth):
    """At 23 Hz a band of 18 Hz shows an eighth of the force."""
    prepared, fit = rod
    prepared = prepare(prepared.experiment, bandwidth=bandwidth)
    fit = estimate(fit.model, prepared)
    size = 0.8 * fit.model.parameters["device.coulomb.level"].value

    def driven(stretch):
        motion = stretch.motion
        wave = size * np.sin(2 * np.pi * 23.0 * motion.time)
        return replace(stretch, motion=replace(motion, interaction=motion.interaction + wave))

    hummed = replace(prepared, stretches=tuple(driven(s) for s in prepared.stretches))
    before = estimate(fit.model, hummed)
    assert best_tone(before, hummed).squares == pytest.approx(check_squares(fit), rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2])
def test_a_hum_that_moves_the_machine_is_no_tip_that_rings(tmp_path, seed):
    folder = write_simulated(tmp_path / "case", "outside_hum", seed=seed, level="outside")
    among = ["transmission_compliance", "backlash"]
    assert not td.find_missing(td.load_experiment(folder), among=among).missing
