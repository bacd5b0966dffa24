"""Work of the measured forces: who drives the device?"""

import numpy as np
import pytest
from check.made_channels import ask

import teleopdesign as td

H = 0.002
T = H * np.arange(4000)
DRIVE = 2.0 * np.sin(3.0 * T) + np.sin(7.3 * T)


def moved(force=0.0 * T, *, start=(0.0, 0.0), weight=0.0, **more):
    """Position of 1 kg on a spring, with viscous and dry friction, under a force (n,)."""
    stiffness, damping, friction = (more.get(n, 0.0) for n in ("stiffness", "damping", "friction"))
    x, (place, speed) = np.zeros(len(T)), start
    for k, push in enumerate(np.asarray(force).tolist()):
        x[k] = place
        brake = damping * speed + friction * np.tanh(speed / 1e-3)
        speed += H * (push - weight - stiffness * place - brake)
        place += H * speed
    return x


def log(position, force, *, step=1e-4, late=0, hand=None):
    """An experiment; late: rows by which the log of the force is late, negative: by which early."""
    table = {"t": T, "x": np.round(position / step) * step, "u": np.roll(force, late)}
    channels = {"position": {"column": "x", "unit": "m"}, "actuator_force": "u"}
    if hand is not None:
        table["f"], channels["interaction_force"] = hand, "f"
    return td.experiment(table, axis="prismatic", inertia=1.0, **channels)


def work_taken_out(experiment):
    """Work (J) that the check states; None: none."""
    findings = ask("work", experiment)
    assert all(f.stops and f.concern == "warning" for f in findings)
    return findings[0].numbers["work"] if findings else None


#: motions of devices that something measured moves, or nothing does
PASSIVE = {
    "friction": moved(DRIVE, friction=1.0),
    "damper": moved(DRIVE, damping=5.0),
    "a mass alone": moved(DRIVE, damping=0.01),
    "a spring": moved(DRIVE, stiffness=30.0, damping=0.1),
    "it coasts": moved(start=(0.0, 3.0), damping=0.2),
    "it falls": moved(weight=9.81, damping=0.3),
    "a spring lets go": moved(start=(0.5, 0.0), stiffness=60.0, damping=0.3),
}


@pytest.mark.parametrize("name", PASSIVE)
@pytest.mark.parametrize("late", [-10, 0, 10])
def test_no_passive_device_is_moved_by_an_unknown_hand(name, late):
    """An actuator or a log that is 20 ms late turns the force of inertia into work."""
    moves = name in ("friction", "damper", "a mass alone", "a spring")
    force = DRIVE if moves else 0.05 * np.sin(5.0 * T)
    assert work_taken_out(log(PASSIVE[name], force, late=late)) is None


def test_a_brake_that_lowers_a_weight_takes_energy_out_once():
    """Without a way back to the same position, a weight may have driven the motion."""
    x = moved(9.0 + 0.5 * np.sin(T), weight=9.81, damping=1.0)
    assert work_taken_out(log(x, 9.0 + 0.5 * np.sin(T))) is None


HAND = {
    "in a damper": (moved(DRIVE, damping=5.0), -4.0),
    "against friction": (moved(DRIVE, friction=1.0), -2.0),
}


@pytest.mark.parametrize("name", HAND)
def test_a_hand_that_is_not_logged_moves_the_device(name):
    x, damper = HAND[name]
    force = damper * np.gradient(x, H)
    made = log(x, force)
    out = -float(force[:-1] @ np.diff(x))
    assert 0.5 * out < work_taken_out(made) <= 1.01 * out
    assert "is not logged moves the device" in ask("work", made)[0].sentence
    assert work_taken_out(log(x, -force)) is None, "the force drives"
    assert work_taken_out(log(x, force, hand=DRIVE - force)) is None, "the hand is known"


def in_a_damper():
    x = HAND["in a damper"][0]
    return log(x, -4.0 * np.gradient(x, H))


def test_a_check_states_the_work():
    findings = td.check_experiment(in_a_damper())
    assert "work" in {f.topic for f in findings if f.concern == "warning"}
    assert findings[-1].sentence.startswith("not checked which effects the record can show")


@pytest.mark.slow
def test_a_diagnosis_names_nothing_where_an_unknown_hand_moves_the_device():
    diagnosis = td.find_missing(in_a_damper())
    assert diagnosis.verdict == "undecided" and "The measured forces take" in str(diagnosis)
