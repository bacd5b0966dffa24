"""The measure `passivity`: never more than what holds with the computer of the study."""

import pytest
from devices import body

import teleopdesign as td
from teleopdesign.controllers import controller

#: N s/m, s: a sampled spring is passive up to 2 b/T = 2000 N/m
DAMPING, PERIOD = 1.0, 1e-3
DEVICE = body(0.1, viscous__damping=DAMPING)
RUBBING = body(0.1, viscous__damping=DAMPING, coulomb__level=0.01)


def status(diagram, computer):
    study = td.study(
        diagram, {"K.gain.gain": [100.0, 8000.0]}, measures="passivity", duration=0.1,
        computer=computer,
    )  # fmt: skip
    return list(study["passivity_status"].values), list(study["passivity_holds"].values)


@pytest.mark.slow
@pytest.mark.parametrize("device", [DEVICE, RUBBING])
def test_a_wall_that_its_computer_makes_active_is_not_called_proved(device):
    wall = td.haptic_interface(device, position_loop=controller("gain", {"gain": 1.0}))
    assert status(wall, td.Sampling(period=PERIOD)) == (["evidence", "refuted"], [1.0, 0.0])
    if device is DEVICE:
        assert status(wall, "continuous") == (["proved", "proved"], [1.0, 1.0])


@pytest.mark.slow
def test_a_proof_in_continuous_time_is_evidence_at_most_in_a_computer():
    rubbing = body(0.1, viscous__damping=DAMPING, coulomb__level=0.5)
    law = controller("dahl", {"level": 0.4, "stiffness": 1e4})
    loop = td.haptic_interface(rubbing, cancellation=law)
    for computer, words in ((td.Sampling(period=PERIOD), "evidence"), ("continuous", "proved")):
        study = td.study(
            loop, {"Z_M.inertia": [0.1]}, measures="passivity", duration=0.1, computer=computer
        )
        assert list(study["passivity_status"].values) == [words]


def test_what_no_computer_samples_is_proved_beside_one():
    wall = td.haptic_interface(
        DEVICE, position_loop=controller("gain", {"gain": 1.0}), analog=("K",)
    )
    assert status(wall, td.Sampling(period=PERIOD)) == (["proved", "proved"], [1.0, 1.0])
