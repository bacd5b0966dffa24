"""Place and time are judged over all records, segments, directions and turns together."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.diagnose.candidates import (
    candidates,
    tells_speed_from_time,
)
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare

TURN = 2 * np.pi


MODEL = """coulomb = { level = { value = 1.0, unit = "N*m" } }
viscous = { damping = { value = 0.5, unit = "N*m*s/rad" } }
"""


def known(*more):
    names = ("coulomb", "viscous", "spring", "bias", "cogging", "hardening_spring", "stribeck")
    return {n: EFFECTS[n] for n in names} | {e.name: e for e in more}


def run(start, end, speed):
    """A segment at constant speed, from place to place."""
    way = np.sign(end - start)
    return abs(end - start) / speed, lambda t: start + way * speed * t


def write_pendulum(folder):
    """Runs at constant speed over the same half turn, both ways, as segments."""
    speeds = np.linspace(0.2, 1.6, 10)
    runs = [run(*ends, v) for v in speeds for ends in ((-1.6, 1.5), (1.5, -1.6))]

    def force(t, x, v):
        return 8.0 * np.sin(x + 0.2) + 1.2 * np.sign(v) + 0.6 * v

    return write_made(
        folder,
        {"fit": runs[0::4] + runs[1::4], "check": runs[2::4] + runs[3::4]},
        force,
        effects=MODEL,
        step=1e-5,
        noise=0.02,
    )


@pytest.mark.slow
def test_gravity_that_the_catalogue_lacks_is_called_no_cogging(tmp_path):
    experiment = load_experiment(write_pendulum(tmp_path / "case"))
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, known()))
    assert "cogging" not in {c.effect.name for c in diagnosis.missing}
    (cogging,) = [c for c in diagnosis.candidates if c.candidate.effect.name == "cogging"]
    assert "does not repeat within the travel" in cogging.refused


@pytest.mark.slow
def test_eight_turns_of_a_motor_show_its_cogging(tmp_path):
    def turning(speed):
        return 8 * TURN / speed, lambda t: speed * t

    def force(t, x, v):
        return 0.15 * np.sin(6 * x + 0.5) + 0.3 * np.sign(v) + 0.02 * v

    folder = write_made(
        tmp_path / "case",
        {"fit": [turning(2.0), turning(5.0)], "check": [turning(3.0)]},
        force,
        effects=MODEL,
        step=1e-3,
        noise=0.01,
        inertia=0.001,
    )
    experiment = load_experiment(folder)
    model = Model.from_experiment(experiment, known())
    one_way = [s.motion for s in prepare(experiment).stretches]
    assert all((np.diff(m.position) > -1e-3).all() for m in one_way)
    assert "cogging" in {c.effect.name for c in candidates(model, one_way)}
    diagnosis = find_missing(experiment, model)
    assert [str(c) for c in diagnosis.missing] == ["cogging at device"]
    period = diagnosis.model.parameters["device.cogging.period"].value
    assert period == pytest.approx(TURN / 6, rel=0.01)


# place and speed


def write_sweep(folder, law):
    """A sine that gets faster, of one amplitude, under friction that grows over the first speeds.

    law: speed over the largest speed -> friction over its largest value; the catalogue lacks it
    """

    def to_and_fro(begin):
        def place(t):
            return 0.005 * np.sin(TURN * (0.3 * (begin + t) + 0.04 * (begin + t) ** 2))

        return place

    return write_made(
        folder,
        {"fit": [(7.2, to_and_fro(0.0))], "check": [(4.8, to_and_fro(7.2))]},
        lambda t, x, v: 7.0 * law(v / 0.04),
        effects=MODEL,
        step=2e-5,
        noise=0.14,
        bandwidth=2.5,
        inertia=20.0,
        fixed=False,
    )


@pytest.mark.slow
def test_friction_that_begins_with_speed_is_called_no_pattern_of_the_place(tmp_path):
    """A short period was named with a probability of 0.95: it was slow near turning points only."""
    names = ("coulomb", "viscous", "cogging", "torque_ripple", "position_dependent_friction")
    few = {n: EFFECTS[n] for n in (*names, "friction_drift", "shear_thinning", "bias")}

    def law(v):
        return np.arcsinh(20.0 * v) / np.arcsinh(20.0)

    experiment = load_experiment(write_sweep(tmp_path / "case", law))
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, few))
    assert {c.effect.name for c in diagnosis.missing} <= {"shear_thinning"}


# speed and time


@dataclass
class Speed:
    """A motion of which only speed, time and direction are asked."""

    velocity: np.ndarray
    time: np.ndarray
    file: str = "fit.csv"
    body: str = "device"
    sample_time: float = 0.01
    further: dict = field(default_factory=dict)

    def __post_init__(self):
        self.position = np.cumsum(self.velocity) * self.sample_time
        self.direction = np.sign(self.velocity).astype(np.int8)


def speeds(velocity_of, duration=20.0):
    time = np.arange(0.0, duration, 0.01)
    return Speed(velocity_of(time), time)


def spin_up(final):
    return speeds(lambda t: final * (1.0 - np.exp(-t / 8.0)) + 1e-6)


@pytest.mark.parametrize(
    "motions",
    [
        [speeds(lambda t: np.sin(2.0 * t))],
        [speeds(lambda t: np.full(len(t), 3.0))],  # one speed for long: what changes is time
        [speeds(lambda t: 200.0 * np.minimum(t, 20.0 - t))],  # up and down again
        [spin_up(50.0), spin_up(200.0)],  # the same speed early and late
        [speeds(lambda t: np.zeros(len(t)))],  # no motion: nothing is said
    ],
)
def test_speeds_that_come_again_tell_speed_from_time(motions):
    assert tells_speed_from_time(motions)


def test_a_drift_is_no_candidate_where_each_run_only_grows_faster(experiment):
    model, names = Model.from_experiment(experiment), {"friction_drift", "quadratic_drag"}
    once = {c.effect.name for c in candidates(model, [spin_up(200.0)])}
    both = {c.effect.name for c in candidates(model, [speeds(lambda t: np.sin(t))])}
    assert names & once == {"quadratic_drag"} and names & both == names
