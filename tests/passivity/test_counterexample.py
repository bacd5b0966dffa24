"""Motions of a diagram that give out energy, found by search and confirmed by simulation."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import search_counterexample


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
