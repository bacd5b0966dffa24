"""Waves and terminations that refute: found where they are known to be, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    Coulomb,
    Dahl,
    Spring,
    absolutely_stable,
    available_storage,
    claim_over_intervals,
    passive,
)
from teleopdesign.passivity import two_port as two_port_of
from teleopdesign.passivity.linear.family import family_of_matrix
from teleopdesign.passivity.linear.judge import passive_claim
from teleopdesign.realise.lti import S


@pytest.mark.parametrize("turn", [1, 2])
@pytest.mark.parametrize("factor", [1, -1])
def test_ports_that_are_passive_alone_are_refuted_by_a_held_second_one(turn, factor):
    """z12 z21 turns by j at 1 rad/s: Llewellyn asks 2 r1 r2 - Re z12 z21 > abs(z12 z21)."""
    loop = sp.Integer(16) * turn * S**2 / (S + 1) ** 2
    system = two_port_of([[S + 1, factor * loop], [factor, S + 1]])
    frequency = 1 / (2 * np.pi)
    z = system.over(np.array([frequency]))[0]
    margin = (2 * z[0, 0].real * z[1, 1].real - (z[0, 1] * z[1, 0]).real) / abs(z[0, 1] * z[1, 0])
    claim = absolutely_stable(system)
    if margin < 1:
        assert claim.status == "refuted" and claim.record.energy > 0
        assert not any(held.clamped for held in claim.record.terminations)


@pytest.mark.slow
@pytest.mark.parametrize("narrow", [sp.Rational(1, 10), sp.Rational(1, 10**4)])
@pytest.mark.parametrize("frequency", [sp.Rational(1, 50), 1, 70])
def test_three_ports_are_refuted_however_narrow_the_dip_is(narrow, frequency):
    """At port 2 a damper of 1 less twice a resonance of that width, between dampers of 1."""
    w = frequency
    dip = 2 * narrow * w * S / (S**2 + narrow * w * S + w**2)
    for share, status in ((sp.Rational(1, 4), "proved"), (sp.Rational(3, 4), "refuted")):
        z = sp.diag(1 + S / w, 1 - 2 * share * dip / 2, 1 + w / S)
        claim = passive_claim(family_of_matrix(z.tolist()))
        assert claim.status == status, (share, claim)
        if status == "refuted":
            wave = claim.record
            assert wave.energy > 0 and wave.replay() > 0
            assert float(wave.frequency) == pytest.approx(float(w), rel=0.2)
            assert abs(wave.velocity[1]) > 10 * max(abs(wave.velocity[0]), abs(wave.velocity[2]))


CABLE = [Coulomb(1.0), Spring(2.0, 1e4)]


@pytest.mark.parametrize(("level", "holds"), [(0.5, True), (1.4, False), (3.5, False)])
def test_the_margin_of_a_storage_has_the_sign_of_its_verdict(level, holds):
    storage = available_storage(Dahl(level, 3e4), CABLE, points=21)
    verdict = storage.evidence()
    assert verdict.holds is holds and (verdict.margin > 0) is holds
    turned = replace(storage, gain=2 * storage.tolerance, round_trip=0.0).evidence()
    assert not turned.holds and turned.margin == pytest.approx(-storage.tolerance)
    released = replace(storage, gain=0.0, round_trip=0.3, stroke=0.01).evidence()
    assert not released.holds and released.margin == -0.3
    assert "0.01 m forth and back release 0.3 N" in released.searched


def rubbing(**more):
    device = body(0.15, viscous__damping=1.0, coulomb__level=0.5, presliding__stiffness=2e4, **more)
    law = controller("dahl", {"level": 0.3, "stiffness": 1e4})
    return haptic_interface(device, hand=body(0.5), cancellation=law)


def test_vertices_prove_nothing_of_friction_whose_other_values_are_not_in_the_conditions():
    """A bristle that damps stands in no condition on level and stiffness: evidence at points."""
    box = {"C.dahl.level": (0.2, 0.4)}
    assert claim_over_intervals(rubbing(), box).status == "proved"
    claim = claim_over_intervals(rubbing(presliding__bristle_damping=1.0), box)
    assert claim.status in ("evidence", "unknown") and "vertices decide" not in claim.how
    assert claim.status == "unknown" or claim.at_worst.holds


@pytest.mark.slow
def test_vertices_prove_nothing_where_the_linear_rest_is_not_passive_in_between():
    """A controller beside friction whose damping may drive at one end is refuted or unknown."""
    box = {"Z_M.inertia": (0.1, 0.3), "C.dahl.level": (0.2, 0.4)}
    assert claim_over_intervals(rubbing(), box).status == "proved"
    claim = claim_over_intervals(
        rubbing(), {"Z_M.viscous.damping": (0.0, 1.0), "C.dahl.level": (0.2, 0.6)}
    )
    assert claim.status != "proved" and claim.margin != claim.margin


@pytest.mark.parametrize(
    ("entries", "is_taken"),
    [
        ([[1, 1], [1, 1]], False),
        ([[1, 1], [1, 1 - sp.Rational(1, 10**30)]], True),
        ([[1, 3], [-3, 1]], False),
        ([[0, 1], [-1, 0]], False),
        ([[0, 1], [1, 5]], True),
        ([[-sp.Rational(1, 10**30), 0], [0, 5]], True),
        ([[5, 0], [0, -sp.Rational(1, 10**30)]], True),
        ([[S, 2 * S], [2 * S, 4 * S]], False),
        ([[1 / S, 2 / S], [2 / S, 4 / S]], False),
        ([[1, S], [-S, 1]], True),
    ],
)
def test_a_matrix_is_passive_where_it_is_positive_to_the_last_digit(entries, is_taken):
    """A lossless or singular matrix is, one a hair below is not."""
    claim = passive(two_port_of(entries))
    assert claim.status == "proved" if not is_taken else claim.holds is not True, claim
