"""Motions of a diagram that give out energy, found by search and confirmed by simulation."""

import numpy as np
import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import Strokes, released_energy, search_counterexample
from teleopdesign.simulate import Sampling


def joint(level, stiffness, compensation=None, damping=0.0):
    body = td.Body("prismatic", {"inertia": td.Value(0.01)})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": level})
    if stiffness:
        presliding = td.EFFECTS["presliding"].without("bristle_damping")
        body = body.with_effect(presliding, {"stiffness": stiffness})
    if damping:
        body = body.with_effect(td.EFFECTS["viscous"], {"damping": damping})
    if compensation is None:
        return haptic_interface(body)
    values = dict(zip(("level", "stiffness"), compensation, strict=True))
    return haptic_interface(body, cancellation=controller("dahl", values))


def searched(diagram, **more):
    settings = {"stroke": 1e-2, "speed": 0.3, "rng": np.random.default_rng(1), "tries": 15}
    settings["give"] = 1e-6  # a tenth of the shortest stroke tried, to be quick
    return search_counterexample(diagram, **settings | more)


def test_strokes_begin_and_end_at_rest_and_turn_where_they_say():
    motion = Strokes((2e-3, -1e-3), speed=0.1, rounds=2, pause=0.01)
    t = np.linspace(0, motion.duration, 20001)
    x, v, a = (f(t) for f in motion.motion().all)
    assert x[0] == v[0] == x[-1] == v[-1] == 0
    assert (x.max(), x.min()) == pytest.approx((2e-3, -1e-3))
    assert np.abs(v).max() == pytest.approx(0.1, rel=1e-4)  # sampled beside the peak
    # trapezoids of 4e-6 s: second order in the step
    assert np.cumsum(v) * (t[1] - t[0]) == pytest.approx(x, abs=1e-6)
    assert np.cumsum(a) * (t[1] - t[0]) == pytest.approx(v, abs=5e-3)


def test_coulomb_friction_takes_its_level_times_the_way():
    strokes = Strokes((5e-3, -5e-3), speed=0.1, rounds=3)
    energy = released_energy(joint(0.5, None), strokes)
    way = np.abs(np.diff(strokes.path)).sum()
    # 1e-3: friction gives by 0.1 micrometre at each reversal, and steps are a percent of a stroke
    assert energy.total == pytest.approx(-0.5 * way, rel=1e-3)
    assert energy.last_round == pytest.approx(-0.5 * 0.02, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    "diagram",
    [joint(0.5, None), joint(0.5, 2e4, (0.4, 1.5e4)), joint(0.5, None, (0.45, 1e4))],
    ids=["no compensation", "within the wedge", "within the Coulomb level"],
)
def test_the_search_is_silent_on_passive_systems(diagram):
    claim = searched(diagram)
    assert (claim.status, claim.holds) == ("evidence", True)
    assert "no proof" in str(claim.verdict)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("friction", "compensation"),
    [((0.5, None), (0.55, 1e4)), ((0.5, 2e4), (0.2, 1.5e4)), ((0.5, 2e4), (0.55, 1.5e4))],
    ids=["too high a level", "too stiff for its level", "both"],
)
def test_a_motion_that_gives_out_energy_is_detected_and_replays(friction, compensation):
    claim = searched(joint(*friction, compensation))
    assert claim.status == "refuted"
    assert claim.record.energy > 0
    assert claim.record.replay() == pytest.approx(claim.record.energy)
    assert claim.record.as_dict()["turning_points"]


@pytest.mark.slow
def test_viscous_damping_hides_over_compensation_from_fast_motion_only():
    """At speeds above (f_D - f_C)/B damping takes more than is given out: slow motion gives."""
    claim = searched(joint(0.5, None, (0.6, 1e5), damping=1.0), tries=30)
    assert claim.status == "refuted"
    assert claim.record.strokes.speed < 0.3


@pytest.mark.slow
def test_a_sampled_compensator_within_the_level_is_passive_too():
    diagram = joint(0.5, None, (0.45, 1e4))
    claim = searched(diagram, computer=Sampling(period=1e-3, delay=1e-3), tries=6)
    assert claim.holds


def test_a_stroke_that_makes_no_sense_is_refused():
    with pytest.raises(ModelError, match="expected stroke and speed > 0"):
        searched(joint(0.5, None), stroke=0.0)


@pytest.mark.slow
def test_evidence_says_what_a_motion_that_does_not_return_would_keep():
    """A spring that pushes away gives 1/2 K x^2, 0.2 J at 2 cm, and takes it back."""
    pushes = controller("spring_damper", {"stiffness": 1000.0, "damping": 0.0})
    diagram = haptic_interface(body(0.3, viscous__damping=2.0), cancellation=pushes)
    rng = np.random.default_rng(1)
    claim = search_counterexample(diagram, stroke=0.02, speed=0.1, rng=rng, tries=3)
    assert claim.status == "evidence" and "that returns" in claim.statement
    assert "on the way back to its start one releases 0." in claim.verdict.searched
