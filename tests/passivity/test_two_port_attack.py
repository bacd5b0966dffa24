"""Absolute stability against an attacker that knows no criterion: no proof falls, no motion fails.

Most systems are made so that the axis alone shows nothing, or next to nothing: see KINDS.
"""

from collections import Counter

import numpy as np
import pytest
import sympy as sp
from passivity.random_two_ports import KINDS, attack, is_free_motion, random_two_port

from teleopdesign.passivity import absolutely_stable, passive, two_port
from teleopdesign.realise.lti import S

TRIES = 60  # pairs of terminations, and half as many steps from the worst of them


def judged(rng, kind):
    """Status of a random two-port, once it was held against the attacker or replayed."""
    z = random_two_port(rng, kind)
    claim = absolutely_stable(two_port(z.tolist()))
    if claim.status == "refuted":
        mode = claim.record
        assert is_free_motion(mode), z
        assert mode.is_confirmed(), z
        # what came before the last 500 periods, or twelve time constants, is left off
        assert 0 < mode.replay() <= mode.energy * (1 + 1e-5), z
        return "refuted"
    held = attack(rng, z, TRIES)
    assert held is None, (claim, z, held)
    return claim.status


@pytest.mark.slow
def test_no_termination_contradicts_what_is_claimed():
    rng, number = np.random.default_rng(2), 105
    counts = Counter(judged(rng, KINDS[i % len(KINDS)]) for i in range(number))
    print(dict(counts))
    # a test in which nearly all are refuted, or left open, would show nothing
    assert counts["proved"] >= 0.25 * number, counts
    assert counts["refuted"] >= 0.25 * number, counts
    assert counts["unknown"] <= 0.1 * number, counts


@pytest.mark.slow
def test_what_is_passive_has_no_wave_that_gives_out_energy():
    """Hermitian part over a grid of the right half plane, against the test of the matrix."""
    rng, number = np.random.default_rng(4), 75
    size, angle = np.geomspace(1e-7, 1e7, 113), np.linspace(0, 0.499 * np.pi, 9)
    s = (size[:, None] * np.exp(1j * angle)).ravel()
    counts = Counter()
    for i in range(number):
        z = random_two_port(rng, KINDS[i % len(KINDS)])
        system = two_port(z.tolist())
        claim = passive(system)
        counts[claim.status] += 1
        value = system.at(s)
        value = value[np.isfinite(value).all(axis=(1, 2))]
        hermitian = (value + value.conj().swapaxes(1, 2)) / 2
        lowest = np.linalg.eigvalsh(hermitian)[:, 0] / np.abs(value).max(axis=(1, 2))
        if claim.status == "proved":
            assert np.min(lowest) > -1e-9, z  # rounding of badly scaled entries
            assert absolutely_stable(system).status == "proved", z
        elif claim.status == "refuted":
            assert claim.record.energy > 0, z
        else:
            assert np.min(lowest) > -1e-6, (claim, z)
    assert min(counts["proved"], counts["refuted"]) >= 0.15 * number, counts
    assert counts["unknown"] <= 0.1 * number, counts


def test_the_attacker_finds_what_the_axis_does_not_show():
    """The three that were once called proved fall within so few tries; the attacker has teeth."""
    s = sp.Symbol("s")
    for rows in (
        [[s + 1 + 1 / s, 2 / s], [2 / s, s + 1 + 1 / s]],
        [[1, 1 / s], [1 / s, 1]],
        [[s + 1, s], [s, 1 + s / 2]],
    ):
        z = sp.Matrix([[two_port(rows).z[i, j] for j in range(2)] for i in range(2)])
        assert attack(np.random.default_rng(1), z, TRIES) is not None


@pytest.mark.parametrize("scale", [sp.Rational(1, 10**6), 1, 10**6])
@pytest.mark.parametrize("corner", [sp.Rational(1, 10**9), 1, 10**9])
def test_residues_that_are_not_hermitian_give_out_energy_however_near_to_their_pole(scale, corner):
    """det(Z + Z*) = 4 scale^2 (1 - (corner/w)^2): negative below the corner, in rad/s, alone."""
    k = corner / S
    system = two_port([[scale, scale * (2 + 2 * k)], [scale * -2, scale]])
    assert passive(system).status == "refuted"
    one_sided = two_port([[scale * (1 + 3 * k), scale * 2 * k], [0, scale * (1 + 3 * k)]])
    claim = passive(one_sided)
    assert claim.status == "refuted" and claim.record.replay() > 0


@pytest.mark.parametrize("share", ["1/10", "1/10000"])
def test_masses_that_are_not_positive_give_out_energy_at_fast_growth(share):
    """det of the masses is -share: only far out on the real axis do they outdo the dampers."""
    m = S * (1 + sp.Rational(share))
    claim = passive(two_port([[S + 9, m], [m, S + 1]]))
    assert claim.status == "refuted" and claim.record.replay() > 0
