"""Three true effects, added together, replace a fourth one that explains the most alone."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import load_experiment
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.ladder_state import begin, look, search_for
from teleopdesign.diagnose.rung import Rung
from teleopdesign.diagnose.search_plan import PLAN, QUICK
from teleopdesign.diagnose.together import add_together
from teleopdesign.effects import EFFECTS
from teleopdesign.model import Model

pytestmark = pytest.mark.slow  # diagnoses of whole cases

KNOWN = (
    "bias coulomb coulomb_asymmetry quadratic_drag spring stribeck viscous viscous_asymmetry"
).split()


def sway(seed):
    rng = np.random.default_rng(seed)
    frequency, phase = rng.uniform(0.1, 1.2, 8), rng.uniform(0.0, 2 * np.pi, 8)

    def motion(t):
        waves = np.sin(2 * np.pi * np.outer(frequency, t) + phase[:, None])
        return 0.06 * (waves / frequency[:, None]).sum(axis=0)

    return motion


def force(t, x, v):
    falls = 0.4 * np.exp(-((v / 0.15) ** 2))
    return (0.5 + falls) * np.sign(v) + 0.6 * v + 1.0 * v * np.abs(v) - 0.12


@pytest.fixture(scope="module")
def ladder(tmp_path_factory):
    """The search on a machine whose model lacks all three, and its first state."""
    folder = write_made(
        tmp_path_factory.mktemp("three"),
        {"fit": [(15.0, sway(3))], "check": [(12.0, sway(4))]},
        force,
        effects="coulomb = { level = 0.5 }\nviscous = { damping = 1.0 }",
        step=1e-5,
        noise=5e-3,
        bandwidth=20,
        rate=200,
    )
    experiment = load_experiment(folder)
    known = {name: EFFECTS[name] for name in KNOWN}
    search = search_for(experiment, Model.from_experiment(experiment, known))
    return search, begin(search)


def added(state):
    return {rung.added.key[0] for rung in state.rungs[1:]}


def with_first(search, state, name):
    """The state in which one candidate was added alone."""
    ranked = next(r for r in state.ranking.ranked if r.candidate.key[0] == name)
    return look(search, (state.rungs[0], Rung(ranked.candidate, ranked.fit, state.ranking)), state)


def test_all_three_take_the_place_of_one_that_did_most_alone(ladder):
    search, state = ladder
    stand_in = with_first(search, state, "quadratic_drag")
    moved = add_together(search, stand_in)
    assert added(moved) in (
        {"quadratic_drag", "stribeck", n} for n in ("bias", "coulomb_asymmetry")
    )
    assert moved.together and moved.replaced
    errors = [rung.fit.check_error for rung in moved.rungs]
    assert errors == sorted(errors, reverse=True) and errors[-1] < 0.1 * stand_in.fit.check_error
    # one direction and a constant force are the same on these records, and both are said
    (constant,) = [r for r in moved.rungs[1:] if r.added.key[0] in ("bias", "coulomb_asymmetry")]
    assert {constant.added.key[0], *(c.key[0] for c in constant.alternatives)} == {
        "bias",
        "coulomb_asymmetry",
    }
    drag = moved.fit.model.parameters["device.quadratic_drag.drag"]
    assert abs(drag.value - 1.0) < 5 * drag.stderr + 0.02


def test_many_are_added_at_once_only_once_and_never_at_a_joint(ladder):
    search, state = ladder
    stand_in = with_first(search, state, "quadratic_drag")
    assert add_together(search, replace(stand_in, together=True)) is None
    for plan in (PLAN.for_joints(2), QUICK):
        assert add_together(replace(search, plan=plan), stand_in) is None


def test_what_was_set_aside_is_not_among_them(ladder):
    search, state = ladder
    stand_in = with_first(search, state, "quadratic_drag")
    aside = type("Aside", (), {"candidate": Candidate(EFFECTS["stribeck"], "device")})()
    moved = add_together(search, replace(stand_in, set_aside=(aside,)))
    assert moved is None or "stribeck" not in added(moved)
