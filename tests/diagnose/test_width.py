"""An essential parameter, as a width, counts as determined only if other values fit worse."""

import numpy as np
import pytest
import sympy as sp
from diagnose.made_records import write_made

from teleopdesign import Body, Effect, FitSearch, Model, Parameter, load_experiment
from teleopdesign.diagnose import identifiability as module
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.identifiability import explain_open_width
from teleopdesign.diagnose.rank import make_ranked
from teleopdesign.measurement.prepare import prepare

LEVEL, WIDTH = 0.3, 0.5
STATED = "coulomb = { level = { value = 0.05, unit = 'N*m' } }"
#: friction that grows with the speed up to a level, over a width without which it is another one
EFFECT = Effect(
    role="force",
    law=lambda now, p: p.level * sp.tanh(now.velocity / p.width),
    parameters={
        "level": Parameter("force", "level"),
        "width": Parameter(
            "velocity", "width", search=FitSearch(starts=(0.2, 1.0), essential=True)
        ),
    },
    absent={"level": 0.0},
    energy="dissipates",
).named("rounded_friction", "")
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


def fit_at_truth(experiment):
    """The fit that begins at the true values, and the prepared records."""
    prepared = prepare(experiment)
    known = {"coulomb": Model.from_experiment(experiment).known["coulomb"]}
    model = Model.from_experiment(experiment, known).with_effect(EFFECT, at="device")
    model = model.with_values({"device.rounded_friction.level": LEVEL, OF_WIDTH: WIDTH})
    return estimate(model, prepared), prepared


@pytest.mark.parametrize(("speed", "open_width"), [(1.5, False), (0.1, True)])
def test_a_width_is_determined_by_motion_beyond_it(tmp_path, speed, open_width):
    fit, prepared = fit_at_truth(recorded(tmp_path, speed))
    sentence = explain_open_width(fit, Candidate(EFFECT, "device"), prepared)
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


class ScoredFit:
    """A fit whose essential parameter has that value; it leaves more by this score."""

    def __init__(self, model, free, score=0.0):
        self.model, self.free, self.score = model, free, score


@pytest.fixture
def ask_width(monkeypatch):
    """What is said of a width of 0.5 where other values leave more by these scores, and which."""

    def ask(scores, effect=EFFECT, free=(OF_WIDTH,)):
        values = []

        def again(model, prepared, *, effort):
            values.append(model.parameters[OF_WIDTH])
            return ScoredFit(model, (), scores[round(values[-1].value, 6)])

        monkeypatch.setattr(module, "estimate", again)
        monkeypatch.setattr(module, "whole_score", lambda before, after: before.score - after.score)
        names = {"rounded_friction.level": LEVEL, "rounded_friction.width": WIDTH}
        model = Model({"device": Body("revolute", {"inertia": 1.0, **names}, (effect,))})
        fit = ScoredFit(model, free)
        return explain_open_width(fit, Candidate(effect, "device"), None), values

    return ask


def test_a_width_is_held_at_a_quarter_and_at_four_times_its_value(ask_width):
    sentence, values = ask_width({0.125: 9.0, 2.0: 9.0})
    assert sentence == "" and [v.value for v in values] == [0.125, 2.0]
    assert all(v.fixed for v in values)
    for scores, other in [((2.9, 9.0), "0.125"), ((9.0, 2.9), "2"), ((9.0, -9.0), "2")]:
        sentence, _ = ask_width(dict(zip((0.125, 2.0), scores, strict=True)))
        assert sentence.startswith(f"width = {other} rad/s fits as well as 0.5 rad/s")
    assert ask_width({0.125: 3.1, 2.0: 3.1})[0] == ""
