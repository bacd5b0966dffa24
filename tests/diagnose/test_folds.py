"""Parts of one log that are held out in turn: each leaves some motion in both directions."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.diagnose.folds import folds
from teleopdesign.measurement.prepare import FOLDS, prepare

H = 0.02


def speed_of_strokes(speed, edge=0.1):
    """Rest, one stroke backward, a pause, one stroke forward, rest; 20 s, so that a quarter of it
    holds a whole stroke. Between them the speed changes within `edge` s."""
    t = H * np.arange(1000)
    times = [0.0, 4.8, 4.8 + edge, 9.8, 9.8 + edge, 10.2, 10.2 + edge, 15.1, 15.1 + edge, 20.0]
    return t, np.interp(t, times, np.array([0, 0, -1, -1, 0, 0, 1, 1, 0, 0]) * float(speed))


def screw(speed, load=4.0, seed=3):
    """A screw that lifts a load by friction of its own: the load acts in both directions alike."""
    t, v = speed_of_strokes(speed)
    rng = np.random.default_rng(seed)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * H)])
    moved = 0.02 * np.gradient(v, H) + 14.0 * np.sign(v) + 0.1 * v + load
    wave = 1.5 * np.sin(2.0 * angle) + 0.3 * rng.standard_normal(len(t))
    return {"t": t, "q": 1e-3 * np.round(1e3 * angle), "u": np.where(v == 0.0, 0.0, moved + wave)}


def experiment_of(table):
    channels = {"position": {"column": "q", "unit": "rad"}, "actuator_force": "u"}
    return td.experiment(table, axis="revolute", inertia=0.02, **channels)


@pytest.fixture(scope="module")
def one_stroke_each_way():
    return experiment_of(screw(20.0))


def test_no_part_holds_most_of_the_motion_in_one_direction(one_stroke_each_way):
    stretches = prepare(one_stroke_each_way, bandwidth=5.0).of("fit")
    pairs = folds(stretches)
    (whole,) = (s.motion.direction[s.keep] for s in stretches)
    assert len(pairs) == FOLDS
    for fold in pairs:
        (kept,), (held,) = fold.known, fold.held_out
        np.testing.assert_array_equal(
            np.sort(np.concatenate([kept.keep, held.keep])), stretches[0].keep
        )
        for one in (-1, 1):
            rows = np.count_nonzero(whole == one)
            assert rows > 0
            assert np.count_nonzero(held.motion.direction[held.keep] == one) < 0.3 * rows


def screw_of_a_drive(lag, seed):
    """The same, as the recorder of a drive writes it at 25 Hz: whole rpm, ramps of one or two rows,
    means over each row. The angle is the integral of the logged speed."""
    row, fine = 0.04, 20
    t = row / fine * np.arange(500 * fine)
    turns = [0.0, 4.8, 4.8001, 9.8, 9.8001, 10.15, 10.1501, 15.1, 15.1001, 20.0]
    goal = 21.0 * np.interp(t, turns, np.array([0, 0, -1, -1, 0, 0, 1, 1, 0, 0.0]))
    v = np.zeros(len(t))
    for k in range(1, len(t)):
        v[k] = v[k - 1] + (goal[k] - v[k - 1]) * row / fine / lag
    v[np.abs(v) < 0.1] = 0.0
    angle = np.cumsum(v) * row / fine
    force = 14.0 * np.sign(v) + 0.1 * v + 4.0 + 1.5 * np.sin(2.0 * angle)
    u = np.where(v == 0.0, 0.0, force).reshape(-1, fine).mean(axis=1)
    rpm = 60.0 / (2.0 * np.pi)
    v = np.round(v.reshape(-1, fine).mean(axis=1) * rpm) / rpm
    u += (v != 0.0) * 0.3 * np.random.default_rng(seed).standard_normal(len(u))
    q = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * row)])
    return {"t": row * np.arange(500), "q": q, "u": np.round(u, 1)}


@pytest.mark.slow
@pytest.mark.parametrize("lag, seed", [(0.04, 0), (0.08, 1)])
def test_one_stroke_each_way_does_not_tell_a_load_from_friction_of_the_direction(lag, seed):
    """`viscous_asymmetry` was named: a part held the whole stroke, and what was left of the log
    told nothing of the constant force; or it followed the ramps, which are four moments."""
    channels = {
        "position": {"column": "q", "unit": "rad", "resolution": 0.002},
        "actuator_force": {"column": "u", "unit": "N*m", "noise": 0.089},
    }
    table = screw_of_a_drive(lag, seed)
    diagnosis = td.find_missing(
        td.experiment(table, axis="revolute", inertia=0.02, **channels),
        among=["bias", "coulomb_asymmetry", "viscous_asymmetry", "spring", "stribeck"],
    )
    assert not diagnosis.missing, diagnosis
    assert {"bias", "coulomb_asymmetry"} <= {c.effect.name for c in diagnosis.groups[0]}
