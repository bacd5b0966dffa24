"""Shifts of the logs of an arm's joints: one logger writes all joints in one row."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.blocks import Value
from teleopdesign.diagnose import part_search as at_joint
from teleopdesign.diagnose.error import force_error
from teleopdesign.diagnose.parts import prepare_parts
from teleopdesign.diagnose.parts_fit import estimate_parts
from teleopdesign.effects import EFFECTS
from teleopdesign.model import Model

#: s between rows
ROW = 0.01
ESTIMATED, HELD = Value(-0.0046, fixed=False, stderr=6e-4), Value(0.0, fixed=True, stderr=1e-3)


class Shifted:
    """A model that has nothing but shifts."""

    def __init__(self, shifts):
        self.record_shift = shifts

    def with_record_shift(self, shifts):
        return Shifted(shifts)


def chosen(monkeypatch, *, searched, fitted, left):
    """The shifts of the arm's fit, and those of joint 1 that were estimated with all joints.

    searched, fitted: shift of joint 1 in its search and in the fit of the arm
    left: check error of the arm with the shift of the search
    """
    estimated = []

    def estimate_parts(models, _):
        estimated.append(models["joint1"].record_shift)
        return arm_fit(models, left)

    def arm_fit(models, error):
        fits = {j: SimpleNamespace(model=m) for j, m in models.items()}
        return SimpleNamespace(fits=fits, check_error=error)

    monkeypatch.setattr(at_joint, "estimate_parts", estimate_parts)
    joints = {
        j: SimpleNamespace(state=SimpleNamespace(fit=SimpleNamespace(model=Shifted({j: late}))))
        for j, late in (("joint1", searched), ("joint2", ESTIMATED))
    }
    models = {"joint1": Shifted({"joint1": fitted}), "joint2": Shifted({"joint2": ESTIMATED})}
    fit = at_joint.with_shifts_of(joints, arm_fit(models, 0.008), None)
    return fit.fits["joint1"].model.record_shift["joint1"], estimated


@pytest.mark.parametrize(("searched", "fitted"), [(HELD, ESTIMATED), (ESTIMATED, HELD)])
def test_the_arm_takes_the_shift_of_the_search_where_less_is_left(monkeypatch, searched, fitted):
    shifts = dict(searched=searched, fitted=fitted)
    assert chosen(monkeypatch, **shifts, left=0.004) == (searched, [{"joint1": searched}])
    assert chosen(monkeypatch, **shifts, left=0.009) == (fitted, [{"joint1": searched}])


@pytest.mark.parametrize("shift", [HELD, ESTIMATED])
def test_nothing_is_estimated_again_where_search_and_arm_agree(monkeypatch, shift):
    assert chosen(monkeypatch, searched=shift, fitted=shift, left=0.004) == (shift, [])


def others_late(monkeypatch, shifts):
    """What the other joints say of the clock at joint 0; shifts: rows, standard error, held."""
    there = {
        f"joint{k + 1}": SimpleNamespace(
            late=rows * ROW, stderr=error * ROW, held=held, at_bound=rows < -1.0, at=f"joint{k + 1}"
        )
        for k, (rows, error, held) in enumerate(shifts)
    }
    joints = ["joint0", *there]
    records = {j: prepared_of_none(j) for j in joints}
    fits = {j: SimpleNamespace(model=j) for j in joints}
    monkeypatch.setattr(at_joint, "shifts_of", lambda j, _: [there[j]] if j in there else [])
    late = at_joint.with_clock_of_others(records, fits, "joint0").late_beside
    return None if late is None else late / ROW


def prepared_of_none(name):
    """Records of a joint without stretches."""
    return at_joint.Prepared(name, 8.0, ())


def test_the_shift_of_the_other_joints_is_the_median_of_what_they_know(monkeypatch):
    say = others_late
    assert say(monkeypatch, [(-0.93, 0.07, False)]) == pytest.approx(-0.93)
    # neither a joint that knows little moves it, nor one whose drive is late
    assert say(monkeypatch, [(-0.93, 0.07, False), (0.1, 0.45, False)]) == pytest.approx(-0.93)
    known = [(0.5, 0.05, False), (0.52, 0.05, False), (-0.4, 0.05, False)]
    assert say(monkeypatch, known) == pytest.approx(0.5)


def test_a_shift_that_was_not_estimated_says_nothing_of_the_clock(monkeypatch):
    held, at_bound = (0.4, 0.1, True), (-1.1, 0.5, False)
    assert others_late(monkeypatch, [held, at_bound]) is None
    assert others_late(monkeypatch, []) is None


@pytest.mark.slow
def test_the_links_are_those_of_the_shift_that_is_held(tmp_path):
    """They were those of an estimated shift, and the held one left far more than it must."""
    generator = np.random.default_rng(5)
    experiment = td.load_experiment(
        write_experiment(tmp_path, random_arm(generator, 1), generator, seconds=1.5)
    )
    known = {n: EFFECTS[n] for n in ("coulomb", "viscous")}
    stated = Model.from_experiment(experiment, known)
    held = stated.with_record_shift({"joint1": Value(-0.8 * ROW, fixed=True)})
    prepared = prepare_parts(experiment)
    arm = estimate_parts({"joint1": held.with_links(prepared.initial)}, prepared)
    model, records = arm.fits["joint1"].model, prepared.parts["joint1"].of("fit")
    assert model.log_late("joint1") == pytest.approx(-0.8 * ROW)
    least = force_error(model, records)
    for k in range(len(arm.links)):
        for part in (-0.02, 0.02):
            links = [x * (1 + part * (i == k)) for i, x in enumerate(arm.links)]
            assert force_error(model.with_links(tuple(links)), records) > 0.999 * least


@pytest.mark.slow
def test_a_right_model_is_adequate_where_few_reversals_mislead_the_shift(tmp_path):
    """The fit record has 12 reversals: with a shift of -4.6 ms 2.2 noise floors were left."""
    generator = np.random.default_rng([112701, 25, 1])
    folder = write_experiment(tmp_path, random_arm(generator, 2), generator)
    diagnosis = td.find_missing(td.load_experiment(folder), among=("bias",))
    assert diagnosis.verdict == "model_adequate"
    assert diagnosis.joints["joint1"].left < 1.2
    assert diagnosis.rungs[-1].joints["joint1"].check_error < 0.0045


def rows_late(diagnosis):
    """Joint -> rows by which its log is late."""
    return {j: d.model.log_late(j) / ROW for j, d in diagnosis.joints.items()}


@pytest.mark.slow
def test_a_joint_that_its_reversals_mislead_has_the_shift_of_the_other(tmp_path):
    """Alone it says 0.67 +- 0.04 rows early, and leaves 1.24 noise floors."""
    generator = np.random.default_rng([260113, 30, 1])
    folder = write_experiment(tmp_path, random_arm(generator, 2), generator, late=-1.0)
    diagnosis = td.find_missing(td.load_experiment(folder), among=("actuator_lag",))
    assert diagnosis.verdict == "model_adequate"
    for rows in rows_late(diagnosis).values():
        assert rows == pytest.approx(-1.0, abs=0.15)
    assert diagnosis.joints["joint1"].left < 1.15
    assert "as at the other joints" in str(diagnosis)


@pytest.mark.slow
def test_a_joint_of_an_arm_whose_drive_is_late_is_adequate_with_its_shift(tmp_path):
    generator = np.random.default_rng([900, 1])
    late = np.array([0.5, 0.5, -0.5])
    folder = write_experiment(tmp_path, random_arm(generator, 3), generator, late=late)
    diagnosis = td.find_missing(td.load_experiment(folder), among=("actuator_lag",))
    assert diagnosis.verdict == "model_adequate"
    assert rows_late(diagnosis)["joint3"] == pytest.approx(-0.5, abs=0.15)
    assert rows_late(diagnosis)["joint1"] == pytest.approx(0.5, abs=0.15)
