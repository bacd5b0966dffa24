"""The residual where a motion is made again: noise differs from pass to pass, no missing force."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.repeats import (
    repeatability,
)
from teleopdesign.measurement.prepare import prepare

NOISE, EXACT = 0.3, 1e-6  # N m, in each reading of the torque
PERIOD = 2.5  # s
LATER = 30.0  # s, of the check record


def again(t):
    """A path that begins anew after each period."""
    w = 2 * np.pi / PERIOD
    return 0.5 * np.sin(w * t) + 0.2 * np.sin(2 * w * t + 1.0) + 0.1 * np.cos(5 * w * t)


def never(t):
    return 0.5 * np.sin(2.6 * t) + 0.3 * np.sin(0.7 * t * (1 + 0.1 * t)) + 0.1 * np.cos(9.1 * t)


def fitted(folder, path, force=lambda t, x, v: 0.0 * t, noise=NOISE, seconds=15.0, **made):
    """The model of a body with friction, fitted to records that also have this force."""
    write_made(
        folder / "made",
        {"fit": [(seconds, path)], "check": [(seconds / 1.5, lambda t: path(t + LATER))]},
        lambda t, x, v: 2.0 * np.sign(v) + 1.0 * v + force(t, x, v),
        effects="coulomb = {}\nviscous = {}", step=1e-5, noise=noise, **{"rate": 400} | made,
    )  # fmt: skip
    experiment = load_experiment(folder / "made")
    prepared = prepare(experiment)
    fit = estimate(Model.from_experiment(experiment), prepared)
    return fit, prepared, repeatability(fit.model, prepared)


def test_what_noise_adds_does_not_repeat(tmp_path):
    """Without noise the filter of the readings leaves 0.9 % of the force, on each pass the same."""
    fit, _, repeats = fitted(tmp_path / "noisy", again)
    *_, exact = fitted(tmp_path / "exact", again, noise=EXACT)
    assert repeats.share > 0.9
    assert repeats.left == pytest.approx(fit.check_error, rel=0.2)
    assert exact.error < 0.1 * exact.left
    assert repeats.error == pytest.approx(np.sqrt(repeats.left**2 - exact.left**2), rel=0.15)


def test_a_missing_force_of_the_place_repeats_and_the_noise_beside_it_does_not(tmp_path):
    def wave(t, x, v):
        return 0.4 * np.sin(12.0 * x)

    _, _, alone = fitted(tmp_path / "alone", again)
    fit, prepared, repeats = fitted(tmp_path / "beside", again, wave)
    assert repeats.left > 2.0 * alone.left
    assert repeats.error == pytest.approx(alone.error, rel=0.15)
    # without noise all that is left is the missing force
    *_, clean = fitted(tmp_path / "clean", again, wave, noise=EXACT)
    assert repeats.repeating == pytest.approx(clean.left, rel=0.05)
    assert clean.error < 0.1 * clean.left


def test_a_force_that_drifts_differs_from_pass_to_pass(tmp_path):
    *_, steady = fitted(tmp_path / "steady", again, noise=EXACT)
    *_, drifting = fitted(tmp_path / "drifting", again, lambda t, x, v: 0.05 * t, noise=EXACT)
    assert steady.error < 0.1 * steady.left
    assert drifting.error > 0.5 * drifting.left


def test_a_motion_that_is_never_made_again_says_nothing(tmp_path):
    assert fitted(tmp_path, never)[2] is None


def with_noise(prepared, size, seed):
    """The same records with other noise of this size (N m) in each command."""
    rng = np.random.default_rng(seed)

    def noisy(s):
        m = s.motion
        command = m.command + size * rng.standard_normal(len(m.command))
        return replace(s, motion=replace(m, command=command))

    return replace(prepared, stretches=tuple(map(noisy, prepared.stretches)))


@pytest.mark.parametrize("seconds", [4.0, 12.0])
def test_noise_that_is_alike_by_chance_does_not_repeat(tmp_path, seconds):
    """Two passes of 1.6 s agree by chance: half of such records would seem to repeat."""
    fit, prepared, _ = fitted(tmp_path, again, noise=EXACT, seconds=seconds)
    many = [repeatability(fit.model, with_noise(prepared, 3.0, k)) for k in range(30)]
    assert sum(r.repeating > 0.0 for r in many) <= 4
    assert sum(r.error < r.left for r in many) > 10
    assert np.median([r.error / r.left for r in many]) == pytest.approx(1.0, abs=0.1)
    # what is left without noise is small but sure
    exact = repeatability(fit.model, prepared)
    assert exact.repeating == pytest.approx(exact.left, rel=0.05)


@pytest.mark.parametrize("finest", [0.4, 0.05])
def test_a_motion_that_is_only_nearly_made_again_leaves_no_missing_force_to_chance(
    tmp_path, finest
):
    """Passes that are apart by 4 % of the motion: a force of the place is another one there."""

    def nearly(t):
        return again(t / 5.0) + 0.02 * np.sin(0.2123 * t)

    *_, repeats = fitted(
        tmp_path, nearly, lambda t, x, v: 0.6 * np.sin(2 * np.pi * x / finest), EXACT,
        bandwidth=10, rate=100, seconds=60.0,
    )  # fmt: skip
    assert repeats is None or repeats.error < 0.35 * repeats.left


@pytest.mark.parametrize(("gain", "size"), [(0.8, 3.0), (1.0, 0.0)])
def test_another_force_of_the_hand_is_another_pass(tmp_path, gain, size):
    """What an actuator loses depends on its force, which a hand changes along the same motion."""
    fit, prepared, _ = fitted(tmp_path, again)

    def pushed(k, s):
        t = s.motion.time - s.motion.time[0]
        hand = size * np.sin(0.77 * t + k) + size * np.sin(2.9 * t)
        command = (s.motion.command - hand) / gain
        return replace(s, motion=replace(s.motion, command=command, interaction=hand))

    stretches = tuple(pushed(k, s) for k, s in enumerate(prepared.stretches))
    repeats = repeatability(fit.model, replace(prepared, stretches=stretches))
    assert (repeats is None) == (size > 0.0)
