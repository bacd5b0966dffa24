"""Shifts of the logs of an arm's joints: one logger writes all joints in one row."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.blocks import Value
from teleopdesign.diagnose.arms import joint as at_joint
from teleopdesign.diagnose.arms.fit import estimate_arm
from teleopdesign.diagnose.arms.prepared import prepare_arm
from teleopdesign.diagnose.error import force_error
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

    def estimate_arm(models, _):
        estimated.append(models["joint1"].record_shift)
        return arm_fit(models, left)

    def arm_fit(models, error):
        fits = {j: SimpleNamespace(model=m) for j, m in models.items()}
        return SimpleNamespace(fits=fits, check_error=error)

    monkeypatch.setattr(at_joint, "estimate_arm", estimate_arm)
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
    prepared = prepare_arm(experiment)
    arm = estimate_arm({"joint1": held.with_links(prepared.initial)}, prepared)
    model, records = arm.fits["joint1"].model, prepared.joints["joint1"].of("fit")
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
    diagnosis = td.find_missing_in_arm(td.load_experiment(folder), among=("bias",))
    assert diagnosis.verdict == "model_adequate"
    assert diagnosis.joints["joint1"].left < 1.2
    assert diagnosis.rungs[-1].fit.check_errors["joint1"] < 0.0045
