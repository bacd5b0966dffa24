"""Values that the fit records leave open are no missing effect, whatever a check record shows."""

import numpy as np
import pytest
from diagnose.made_records import write_made

import teleopdesign as td
from teleopdesign.diagnose.all_records import estimable_on_all, explained_by_values
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.diagnose.prepare import prepare
from teleopdesign.diagnose.rung import Rung
from teleopdesign.diagnose.stated_fit import estimate_stated
from teleopdesign.model import Model

FRICTION = 'coulomb = { level = { value = 0.5, unit = "N*m" } }\n'
FRICTION += 'viscous = { damping = { value = 0.5, unit = "N*m*s/rad" } }'


def to_and_fro(speed):
    """Ways of 1.2 s at one speed, both ways, that turn softly."""

    def motion(t):
        w = 2 * np.pi / 2.4
        return speed / w * np.arcsin(0.97 * np.sin(w * t))

    return motion


def experiment(folder, *, drag, speeds):
    """Coulomb friction, damping and drag: fitted at these speeds (rad/s), checked at 3 rad/s."""
    return td.load_experiment(
        write_made(
            folder,
            {
                "fit": [(9.6, to_and_fro(v)) for v in speeds],
                "check": [(9.6, to_and_fro(3.0))],
            },
            lambda t, x, v: 0.8 * np.sign(v) + 0.4 * v + drag * v * abs(v),
            effects=FRICTION,
            step=1e-4,
            noise=0.03,
            rate=200,
        )
    )


def judge_drag(recorded):
    """(check error without `quadratic_drag`, with it, why it is none)."""
    prepared = prepare(recorded)
    base = estimate_stated(Model.from_experiment(recorded), prepared)
    floor = noise_floor(base.model, prepared, np.random.default_rng(0))
    fit = estimate(base.model.with_effect("quadratic_drag", values={"drag": 0.05}), prepared)
    added = Candidate(fit.model.body("device").effect("quadratic_drag"), "device")
    none = explained_by_values(base, Rung(added, fit), prepared, floor)
    return base.check_error, fit.check_error, none


def test_a_force_that_is_there_is_no_matter_of_values(tmp_path):
    without, with_it, none = judge_drag(experiment(tmp_path, drag=0.3, speeds=(0.3, 1.0, 2.5)))
    assert with_it < 0.5 * without
    assert none is None


def test_an_effect_that_all_records_do_not_ask_for_is_set_aside(tmp_path):
    """Whatever it did for the check records when they were not estimated on."""
    recorded = experiment(tmp_path, drag=0.0, speeds=(0.3, 0.32))
    _, _, none = judge_drag(recorded)
    assert none is not None and none.candidate.key == ("quadratic_drag", "device")
    assert "the fit records leave its values open" in none.reason


def test_an_experiment_without_a_check_record_has_nothing_to_hold_an_effect_against(tmp_path):
    prepared = prepare(experiment(tmp_path, drag=0.0, speeds=(0.3,)))
    assert estimable_on_all(prepared) is not None
    alone = type(prepared)(prepared.experiment, prepared.bandwidth, prepared.of("fit"))
    assert estimable_on_all(alone) is None


@pytest.mark.parametrize("drag", [0.0, 0.3])
def test_all_records_are_estimated_on_and_the_check_records_compared_on(tmp_path, drag):
    prepared = prepare(experiment(tmp_path, drag=drag, speeds=(0.3, 2.5)))
    together = estimable_on_all(prepared)
    assert together is not None
    files = [s.motion.file for s in together.of("fit")]
    assert files == [s.motion.file for s in prepared.stretches]
    assert together.of("check") == prepared.of("check")
