"""A motion one way against the measured force: a weight that is let down, or a wrong sign."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.fitted_checks import check_experiment

T = 0.01 * np.arange(400)
#: a drum that winds up a cable at a constant speed, with a force that varies along its turn
ANGLE = 6.0 * T + 0.06 * np.sin(5.0 * T) + 0.02 * np.sin(13.0 * T)
PULL = 5.0 + 0.8 * np.sin(0.5 * ANGLE) + 0.05 * np.random.default_rng(3).standard_normal(len(T))
BOTH_WAYS = 1.5 * np.sin(2.0 * T)


def motion_of(angle, force):
    table = {"t": T, "q": np.round(angle, 6), "u": force}
    channels = {"position": {"column": "q", "unit": "rad"}, "actuator_force": "u"}
    experiment = td.experiment(table, axis="revolute", inertia=0.01, **channels)
    (motion,) = [f for f in check_experiment(experiment) if f.topic == "motion"]
    return motion


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_force_against_the_whole_way_is_a_note(way):
    motion = motion_of(way * ANGLE, -way * PULL)
    assert "Along 100 % of the way, the measured forces act against the motion" in motion.sentence
    assert motion.numbers["against"] > 0.99


@pytest.mark.parametrize(
    ("angle", "force"),
    [
        (ANGLE, PULL),
        (BOTH_WAYS, np.sign(np.gradient(BOTH_WAYS)) * PULL),
        (ANGLE, np.where(T < 2.5, PULL, -PULL)),  # a controller brakes at the end of its way
    ],
)
def test_other_motions_are_not_against_their_force(angle, force):
    motion = motion_of(angle, force)
    assert "act against the motion" not in motion.sentence
    assert "against" not in motion.numbers
