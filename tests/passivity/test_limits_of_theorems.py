"""Claims about an identified device at the limits of what theorems ask, from both sides."""

from types import SimpleNamespace

import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.effects import EFFECTS
from teleopdesign.passivity.identified import identify_device
from teleopdesign.passivity.theorems import THEOREMS, Question
from teleopdesign.passivity.theorems.sampled_data import _claims


@pytest.mark.parametrize("level", [0.9, 1.0, 1.1])
def test_a_law_is_covered_by_what_resists_at_every_speed_up_to_that_force(level):
    device = identify_device(body(0.1).with_effect(EFFECTS["coulomb"], {"level": 1.0}))
    law = controller("dahl", {"level": level, "stiffness": 1e4}).stages[0]
    beside, damped = THEOREMS["bounded_compensation"].claims(Question(device, law))
    verdict = damped.claim.verdict
    assert verdict.holds == (level <= 1.0)
    assert verdict.margin == pytest.approx(1.0 - level) and verdict.unit == "N"
    assert beside.claim.status == ("proved" if level <= 1.0 else "refuted")


@pytest.mark.parametrize(("late", "least"), [(0, 0.5), (1, 1.5)])
@pytest.mark.parametrize("part", [0.99, 1.01])
def test_a_wall_so_many_samples_late_asks_for_that_damping(late, least, part):
    """b > (K T / 2)(1 + 2 d) of a wall of stiffness K alone, d samples late."""
    stiffness, period = 1000.0, 1e-3
    damping = SimpleNamespace(low=part * least * stiffness * period)
    question = SimpleNamespace(
        device=SimpleNamespace(damping=damping, presliding=None),
        computer=SimpleNamespace(period=period, encoder_step=0.0),
        wall=SimpleNamespace(stiffness=stiffness, damping=0.0),
        bristle=None,
        late=late,
    )
    (topic,) = _claims(question)
    assert (topic.claim.status == "proved") == (part > 1.0)
