"""Claims about an identified device at the limits of what theorems ask, from both sides."""

from types import SimpleNamespace

import pytest

from teleopdesign.passivity.theorems.bounded_compensation import (
    _compare_at_every_speed,
    _compare_level,
)
from teleopdesign.passivity.theorems.sampled_data import _claims


@pytest.mark.parametrize(("acting", "margin"), [(0.9, 0.1), (1.0, 0.0), (1.1, -0.1)])
def test_a_law_is_covered_by_what_resists_at_every_speed_up_to_that_force(acting, margin):
    least = SimpleNamespace(low=1.0)
    device = SimpleNamespace(least_resistance=least, lowest=least, force_unit="N")
    verdict = _compare_at_every_speed(device, acting).verdict
    assert verdict.holds == (margin >= 0.0)
    assert verdict.margin == pytest.approx(margin) and verdict.unit == "N"
    assert _compare_level(device, acting).status == ("proved" if margin >= 0.0 else "refuted")


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
