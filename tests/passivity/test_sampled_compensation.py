"""A Dahl compensator in a computer: ideal friction keeps its bound, Dahl friction has none."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    confirmed_motion,
    dahl_compensation,
    sampled_compensation,
)
from teleopdesign.simulate import Sampling

JOINT = {"coulomb_level": 1, "presliding_stiffness": 10_000}
INSIDE = {"compensator_level": 0.8, "compensator_stiffness": 8_000}  # 0.64 <= 0.8: the wedge
dampings = st.floats(0, 5).map(lambda x: round(x, 9))
sizes = st.floats(-2, 2).map(lambda x: 10**x)


@settings(max_examples=25)
@given(
    level=st.floats(-1, 0.5).map(lambda x: 10**x),
    soft=sizes,
    damping=dampings,
)
def test_beside_a_contact_that_gives_no_numbers_are_passive(level, soft, damping):
    claim = sampled_compensation(
        **JOINT,
        compensator_level=level,
        compensator_stiffness=1e4 * soft,
        sample_time=1e-3,
        viscous_damping=damping,
    )
    assert claim.status == "refuted"
    assert claim.record.replay() > 0
    if damping:  # no law within f_D gives out more
        assert claim.record.power < level**2 / (4 * damping)


@pytest.mark.parametrize(("damping", "late"), [(0, 0), (2, 1)])
def test_simulation_gives_out_energy_too_where_continuous_time_is_proved(damping, late):
    assert dahl_compensation(**JOINT, **INSIDE).status == "proved"
    claim = sampled_compensation(
        **JOINT, **INSIDE, sample_time=1e-3, viscous_damping=damping, late=late
    )
    body = td.Body("prismatic", {"inertia": td.Value(1e-6)})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": 1.0})
    presliding = td.EFFECTS["presliding"].without("bristle_damping")
    body = body.with_effect(presliding, {"stiffness": 1e4})
    if damping:
        body = body.with_effect(td.EFFECTS["viscous"], {"damping": damping})
    law = controller("dahl", {"level": 0.8, "stiffness": 8e3})
    motion = confirmed_motion(
        haptic_interface(body, cancellation=law),
        claim.record.strokes(),
        computer=Sampling(period=1e-3, delay=late * 1e-3),
        give=1e-7,
    )
    # strokes that begin and end at rest lose pi^2/8 of the damping at one speed
    assert motion.energy == pytest.approx(claim.record.energy, rel=0.05 if not damping else 0.4)
