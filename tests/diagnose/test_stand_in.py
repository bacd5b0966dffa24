"""Parameters that the fit records leave open are not mistaken for a missing effect."""

import numpy as np
import pytest
from diagnose.made_records import write_made

import teleopdesign as td
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.climb import stands_in_for_values
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.diagnose.rung import Rung
from teleopdesign.diagnose.stated_fit import estimate_stated
from teleopdesign.measurement.prepare import prepare
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
    none = stands_in_for_values(base, Rung(added, fit), prepared, floor)
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
    assert "the fit records do not determine its values" in none.reason


@pytest.mark.slow
def test_an_adequate_model_gets_no_tip_for_the_steps_of_its_encoder(tmp_path):
    """Two sines at 500 Hz, steps of 0.1 mrad, next to no noise of the forces."""

    def motion(t):
        return 0.4 * np.sin(2 * np.pi * 0.5 * t) + 0.1 * np.sin(2 * np.pi * 2.1 * t)

    made = write_made(
        tmp_path,
        {"fit": [(12.0, motion)], "check": [(8.0, lambda t: motion(t + 12.0))]},
        lambda t, x, v: 0.02 * np.sign(v) + 0.004 * v,
        effects='coulomb = { level = { value = 0.015, unit = "N*m" } }\n'
        'viscous = { damping = { value = 0.003, unit = "N*m*s/rad" } }',
        step=1e-4,
        noise=1e-5,
        bandwidth=49,
        rate=500,
        inertia=2e-3,
        fixed=False,
    )
    diagnosis = td.find_missing(td.load_experiment(made), among=["transmission_compliance"])
    assert [r.added for r in diagnosis.rungs] == [None]
    assert diagnosis.verdict == "model_adequate"
    assert [one.candidate.effect.name for one in diagnosis.set_aside] == ["transmission_compliance"]
