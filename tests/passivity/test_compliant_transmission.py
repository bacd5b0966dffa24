"""Compensation at the motor, with friction also behind a compliant transmission."""

import math

import numpy as np
import pytest

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    any_environment,
    free_motion,
    free_motion_margin,
    read_record,
    write_record,
)
from teleopdesign.passivity.rate_independent import (
    Coulomb,
    Cycle,
    Dahl,
    Spring,
    symmetric_cycle,
)

JOINT = {"motor_level": 1.0, "link_level": 2.0, "transmission_stiffness": 1e4}


def free(level, stiffness, seed=1):
    return free_motion(
        **JOINT,
        compensator_level=level,
        compensator_stiffness=stiffness,
        rng=np.random.default_rng(seed),
        paths=200,
    )


@pytest.mark.parametrize(("level", "status"), [(0.5, "proved"), (1, "proved"), (1.001, "refuted")])
def test_beside_any_environment_only_the_motors_friction_counts(level, status):
    """f_D <= f_1 whatever stiffness and link friction; else a clamped link gives energy away."""
    claim = any_environment(**JOINT, compensator_level=level, compensator_stiffness=1e4)
    assert claim.status == status


@pytest.mark.slow
def test_free_motion_is_evidence_or_refutation_never_proof(tmp_path):
    """1.5 N of compensation on 1 N at the motor: soft is fine, stiff gives out energy."""
    soft, stiff = free(1.5, 3e3), free(1.5, 5e4)
    assert soft.status == "evidence"
    assert soft.holds
    assert stiff.status == "refuted"
    write_record(stiff.record, tmp_path / "motion.json")
    assert read_record(tmp_path / "motion.json").replay() > 0
    assert free(3.1, 1e3).status == "refuted"  # more than both together
    assert free(3.0, 1e3).status == "evidence"


@pytest.mark.parametrize("u_link", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("ratio", [0.5, 1.0, 4.0])
def test_the_energy_of_a_cycle_is_the_closed_form(u_link, ratio):
    """4 f_D (A - lambda tanh u) - 4 f_1 A - 4 f_2 max(0, A - f_2/k), integrated leg by leg."""
    level, f_1, f_2, k = 1.5, 1.0, 2.0, 1e4
    length = f_2 / k / u_link
    amplitude = ratio * f_2 / k
    energy = symmetric_cycle(
        Dahl(level, level / length), [Coulomb(f_1), Spring(f_2, k)], amplitude
    ).energy
    given_out = 4 * level * (amplitude - length * math.tanh(amplitude / length))
    loss = 4 * f_1 * amplitude + 4 * f_2 * max(0.0, amplitude - f_2 / k)
    assert energy == pytest.approx(given_out - loss, rel=1e-9)


def test_no_cycle_of_any_amplitude_gives_out_energy_where_the_margin_is_zero():
    """On the limit f_D (1 - tanh(u)/u) = f_1 only the amplitude f_2/k balances."""
    from scipy.optimize import brentq

    stiffness = brentq(
        lambda s: free_motion_margin(**JOINT, compensator_level=1.5, compensator_stiffness=s),
        1e3,
        1e6,
    )
    helps, against = Dahl(1.5, stiffness), [Coulomb(1.0), Spring(2.0, 1e4)]
    amplitudes = 2e-4 * np.geomspace(1e-2, 1e2, 401)
    out = [symmetric_cycle(helps, against, float(a)).energy for a in amplitudes]
    assert max(out) <= 1e-9 * max(abs(x) for x in out)
    assert amplitudes[int(np.argmax(np.array(out) / amplitudes))] == pytest.approx(2e-4, rel=0.05)


def test_the_cables_stiffness_limits_that_of_the_compensator():
    """sigma_D <= k sqrt(3 f_1 f_D)/f_2 is always enough, since 1 - tanh(u)/u <= u^2/3."""
    for level in (1.2, 2.0, 3.0):
        enough = 1e4 * math.sqrt(3 * 1.0 * level) / 2.0
        assert (
            free_motion_margin(**JOINT, compensator_level=level, compensator_stiffness=enough) >= 0
        )


def test_steps_at_reversals_take_energy_out_where_plain_cycles_take_none():
    """f_D = sigma_D = f_2 = 1, k = 2, f_1 = 1/12 lies within the condition of plain cycles."""
    joint = {"motor_level": 1 / 12, "link_level": 1.0, "transmission_stiffness": 2.0}
    values = {**joint, "compensator_level": 1.0, "compensator_stiffness": 1.0}
    assert free_motion_margin(**values) > 0
    claim = free_motion(**values, rng=np.random.default_rng(1), paths=10)
    assert claim.status == "refuted"
    assert claim.record.replay() == pytest.approx(claim.record.energy, rel=1e-12)
    # with the link stuck: out on the way to the limit cycle's distance, exactly 0.0166 J at a = 0.5
    friction = (Coulomb(1 / 12), Spring(1.0, 2.0))
    points = (0.5, 0.4, 0.5, -0.5, -0.4, -0.5)
    assert Cycle(Dahl(1.0, 1.0), friction, points).energy == pytest.approx(0.0166, abs=5e-5)


@pytest.mark.slow
def test_what_is_refuted_gives_out_energy_and_what_the_motor_covers_is_never_refuted():
    """Twenty-four random joints inside the condition of plain cycles, 500 random paths each."""
    rng = np.random.default_rng(5)
    refuted = 0
    for _ in range(24):
        f_1, f_2 = rng.uniform(0.1, 2.0, 2)
        joint = {
            "motor_level": f_1,
            "link_level": f_2,
            "transmission_stiffness": 1e4,
            "compensator_level": rng.uniform(0.5 * f_1, f_1 + f_2),
            "compensator_stiffness": 10 ** rng.uniform(2.5, 5),
        }
        claim = free_motion(**joint, rng=rng, paths=500)
        if claim.status == "refuted":
            refuted += 1
            assert claim.record.replay() > 0
            assert joint["compensator_level"] > f_1, joint  # proved passive up to there
        elif free_motion_margin(**joint) >= 0:
            assert claim.holds, joint
    assert 0 < refuted < 24


def test_values_that_make_no_sense_are_one_clear_line():
    with pytest.raises(ModelError, match="compensator_level: expected a number > 0"):
        free(0.0, 1e3)
    with pytest.raises(ModelError, match="transmission_stiffness: expected a number > 0, found -1"):
        any_environment(
            **(JOINT | {"transmission_stiffness": -1}),
            compensator_level=0.5,
            compensator_stiffness=1e4,
        )
