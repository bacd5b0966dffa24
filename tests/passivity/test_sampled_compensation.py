"""A Dahl compensator in a computer: ideal friction keeps its bound, Dahl friction has none."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    Dahl,
    Trembling,
    confirmed_motion,
    dahl_compensation,
    read_record,
    sampled_compensation,
    write_record,
)
from teleopdesign.simulate import Sampling

JOINT = {"coulomb_level": 1, "presliding_stiffness": 10_000}
INSIDE = {"compensator_level": 0.8, "compensator_stiffness": 8_000}  # 0.64 <= 0.8: the wedge
dampings = st.floats(0, 5).map(lambda x: round(x, 9))
sizes = st.floats(-2, 2).map(lambda x: 10**x)


def stroke_by_stroke(record):
    """Energy given out, every stroke of the elements and every held force on its own."""
    helps = against = out = 0.0
    held = [0.0] * (record.late + 1)
    for way in (1.0, -1.0):
        for _ in range(record.samples):
            command = held.pop(0)
            for travel in (way * record.forth, -way * record.back):
                against, work = record.friction.leg(against, travel)
                out += command * travel - work
            out -= record.damping * record.path**2 / record.sample_time
            helps, _ = record.compensator.leg(helps, way * (record.forth - record.back))
            held.append(helps)
    return out


@given(
    level=sizes,
    stiffness=sizes,
    path=sizes,
    drift=st.floats(0.01, 0.99),
    damping=dampings,
    samples=st.integers(3, 40),
    late=st.integers(0, 2),
)
def test_the_sum_is_that_of_every_stroke(level, stiffness, path, drift, damping, samples, late):
    record = Trembling(
        Dahl(level, 1e4 * stiffness),
        Dahl(1.0, 1e4),
        damping,
        1e-3,
        1e-4 * path * (1 + drift) / 2,
        1e-4 * path * (1 - drift) / 2,
        samples,
        late,
    )
    turned = samples * (1.0 + level) * record.path
    assert record.replay() == pytest.approx(stroke_by_stroke(record), abs=1e-12 * turned)


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


def test_ideal_friction_keeps_its_bound_in_a_computer():
    law = {"compensator_stiffness": 1e4, "sample_time": 1e-3, "late": 2}
    assert sampled_compensation(coulomb_level=1, compensator_level=1, **law).status == "proved"
    assert sampled_compensation(coulomb_level=1, compensator_level=1.01, **law).status == "refuted"


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


def test_the_motion_is_written_and_replayed(tmp_path):
    claim = sampled_compensation(**JOINT, **INSIDE, sample_time=1e-3)
    write_record(claim.record, tmp_path / "motion.json")
    assert read_record(tmp_path / "motion.json") == claim.record


def test_numbers_that_make_no_sense_are_refused():
    with pytest.raises(ModelError, match="sample_time: expected a number > 0"):
        sampled_compensation(**JOINT, **INSIDE, sample_time=0)
