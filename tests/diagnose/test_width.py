"""An essential parameter, as a width, counts as determined only if other values fit worse."""

import numpy as np
import pytest
import sympy as sp
from diagnose.made_records import write_made

from teleopdesign import Effect, FitSearch, Model, Parameter, load_experiment
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.identifiability import explain_open_width
from teleopdesign.diagnose.rank import make_ranked
from teleopdesign.measurement.prepare import prepare

LEVEL, WIDTH = 0.3, 0.5
STATED = "coulomb = { level = { value = 0.05, unit = 'N*m' } }"


def rounded_friction(**bounds):
    """Grows with the speed up to a level, over a width without which it is another friction."""
    search = FitSearch(starts=(0.2, 1.0), essential=True)
    return Effect(
        role="force",
        law=lambda now, p: p.level * sp.tanh(now.velocity / p.width),
        parameters={
            "level": Parameter("force", "level"),
            "width": Parameter("velocity", "width", search=search, **bounds),
        },
        absent={"level": 0.0},
        energy="dissipates",
    ).named("rounded_friction", "")


EFFECT = rounded_friction()
OF_WIDTH = "device.rounded_friction.width"


def recorded(folder, speed):
    """An experiment on a body with such friction, at speeds up to that one (rad/s)."""

    def motion(t, phase=0.0):
        return speed * (np.sin(1.1 * t + phase) / 2.2 + np.sin(1.9 * t) / 3.8)

    records = {"fit": [(12.0, motion)], "check": [(8.0, lambda t: motion(t, 0.7))]}

    def force(t, x, v):
        return 0.05 * np.sign(v) + LEVEL * np.tanh(v / WIDTH)

    write_made(folder, records, force, effects=STATED, step=1e-6, noise=0.002)
    return load_experiment(folder)


def fit_at_truth(experiment, effect=EFFECT):
    """The fit that begins at the true values, and the prepared records."""
    prepared = prepare(experiment)
    known = {"coulomb": Model.from_experiment(experiment).known["coulomb"]}
    model = Model.from_experiment(experiment, known).with_effect(effect, at="device")
    model = model.with_values({"device.rounded_friction.level": LEVEL, OF_WIDTH: WIDTH})
    return estimate(model, prepared), prepared


@pytest.mark.parametrize(
    ("speed", "bounds", "open_width"),
    # within each bound, other widths are allowed on one side only
    [(1.5, {}, False), (0.02, {"upper": 1.0}, True), (0.1, {"lower": 0.2}, True)],
)
def test_a_width_is_determined_by_motion_beyond_it(tmp_path, speed, bounds, open_width):
    effect = rounded_friction(**bounds)
    fit, prepared = fit_at_truth(recorded(tmp_path, speed), effect)
    sentence = explain_open_width(fit, Candidate(effect, "device"), prepared)
    assert bool(sentence) == open_width
    if open_width:
        assert "rad/s fits as well as" in sentence and "do not determine it" in sentence


def test_a_candidate_of_any_width_does_not_count(tmp_path):
    fit, prepared = fit_at_truth(recorded(tmp_path, 0.1))
    base = estimate(fit.model.without_effect(EFFECT.name, at="device"), prepared)
    candidate = Candidate(EFFECT, "device")
    unasked = make_ranked(base, candidate, fit, prepared=prepared, has_open_width=False)
    entry = make_ranked(base, candidate, fit, prepared=prepared)
    assert "determine" not in unasked.implausible
    assert "determine" in entry.note and not entry.counts
