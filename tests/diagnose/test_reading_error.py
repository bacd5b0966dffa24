"""What reading a motion by sensors does to estimates, found on a motion whose truth is known."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.reading_error import (
    ReadingError,
    as_read,
    with_reading_error,
)
from teleopdesign.diagnose.simulated_course import (
    as_led,
    simulated_course,
)
from teleopdesign.measurement.prepare import prepare
from teleopdesign.realise.along_motion import residual_along


def always(_):
    return True


@pytest.fixture(scope="module")
def rod():
    """The shipped rod with its true effects, fitted."""
    experiment = td.load_experiment(td.example("rod"))
    prepared = prepare(experiment)
    model = td.Model.from_experiment(experiment).with_effect(
        "stribeck", values={"extra_static_level": 0.2, "stribeck_velocity": 0.022}
    )
    return estimate(model, prepared), prepared


@pytest.mark.parametrize(
    # a tip behind a gap is a tip too
    "effect",
    ["transmission_compliance", pytest.param("backlash", marks=pytest.mark.slow), "actuator_lag"],
)
def test_bodies_with_hidden_states_start_with_the_record(rod, effect):
    fit, prepared = rod
    motion = prepared.of("fit")[0].motion
    values = {
        "transmission_compliance": {"tip_inertia": 0.05, "stiffness": 4000.0, "damping": 2.0},
        "backlash": {"tip_inertia": 0.05, "stiffness": 4000.0, "damping": 2.0, "gap": 1e-4},
        "actuator_lag": {"time_constant": 0.004},
    }[effect]
    model = fit.model.with_effect(effect, values=values)
    course = simulated_course(model.body("device"), motion, deflection=0.1)
    # a tip that began elsewhere would fling the body off
    assert np.max(np.abs(course.position - motion.position)) < 0.2 * np.ptp(motion.position)


@pytest.mark.slow
def test_a_second_simulation_predicts_by_how_much_estimates_miss(rod):
    """Records of a simulated rod, its truth known, each corrected by a simulation of its own."""
    rod_fit, prepared = rod
    fit = prepared.of("fit")[0]
    exact = replace(
        fit,
        motion=as_led(
            fit.motion, simulated_course(rod_fit.model.body("device"), fit.motion, deflection=0.1)
        ),
    )
    # but the inertia, which misses by less than a thousandth before and after
    names = [n for n in rod_fit.free if n != "device.inertia"]
    misses, left, errors = [], [], []
    for seed in range(3):
        read = as_read(exact, prepared, np.random.default_rng(seed))
        known = replace(prepared, stretches=(read,))
        again = estimate(rod_fit.model, known)
        drawn = np.random.default_rng(50 + seed)
        better = with_reading_error(again, known, drawn, adequate=always)
        for kept, fitted in ((misses, again), (left, better)):
            kept.append(
                [
                    fitted.model.parameters[n].value / rod_fit.model.parameters[n].value - 1.0
                    for n in names
                ]
            )
        values = [better.model.parameters[n] for n in names]
        errors.append([v.stderr / abs(v.value) for v in values])
    # what is within its own error may miss by chance
    chance = np.mean(errors, axis=0) / np.sqrt(len(errors))
    misses, left = (np.abs(np.mean(rows, axis=0)) for rows in (misses, left))
    assert np.all(left < np.maximum(0.6 * misses, chance))
    assert np.any(misses > 2.0 * chance)


def test_what_reading_moves_to_another_magnitude_is_not_corrected(rod, monkeypatch):
    rod_fit, prepared = rod
    far = np.where(np.arange(len(rod_fit.free)) == 0, 5.0, 0.01)  # the inertia, on a log scale
    error = ReadingError(shift=far, spread=0.001 * np.ones(len(rod_fit.free)))
    monkeypatch.setattr("teleopdesign.diagnose.reading_error.reading_error", lambda *_: error)
    after = with_reading_error(rod_fit, prepared, np.random.default_rng(1), adequate=always)
    inertia, level = (rod_fit.model.parameters[n] for n in rod_fit.free[:2])
    assert after.model.parameters["device.inertia"].value == inertia.value
    assert after.model.parameters["device.inertia"].stderr > 4.0 * inertia.value
    assert after.model.parameters["device.coulomb.level"].value == pytest.approx(level.value - 0.01)
    # and nothing where the corrected model would leave more than noise
    refused = with_reading_error(
        rod_fit, prepared, np.random.default_rng(1), adequate=lambda fit: fit is rod_fit
    )
    assert refused.model.parameters["device.coulomb.level"].value == level.value


# with friction of the tip another loop is compiled
@pytest.mark.parametrize("effects", [(), pytest.param(("tip_friction",), marks=pytest.mark.slow)])
def test_what_is_simulated_is_what_the_residual_knows(rod, effects):
    """Dry friction of a tip held by a bristle of 10 um was a spring beside the transmission."""
    rod_fit, prepared = rod
    fit = prepared.of("fit")[0]
    model = rod_fit.model.with_effect(
        "transmission_compliance", values={"tip_inertia": 0.05, "stiffness": 4e3, "damping": 2.0}
    )
    for name in effects:
        model = model.with_effect(name, values={"level": 0.3})
    body = model.body("device")
    course = simulated_course(body, fit.motion, deflection=0.1)
    motion = as_read(
        replace(fit, motion=as_led(fit.motion, course)), prepared, np.random.default_rng(3)
    ).motion
    left = motion.lowpassed(residual_along(body, motion).residual.value)[fit.keep]
    whole = motion.lowpassed(motion.at_rows(motion.command) + motion.interaction)[fit.keep]
    # 0.8 % without friction of the tip, 0.6 % with it; 1.6 % with a bristle of 10 um
    assert np.std(left) < 0.011 * np.std(whole)
