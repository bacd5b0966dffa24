"""Two-ports: Raisbeck's and Llewellyn's criteria, exact, over frequency and with exact delay."""

import numpy as np
import pytest
import sympy as sp

from teleopdesign.errors import ModelError
from teleopdesign.passivity import (
    absolutely_stable,
    delayed_spring,
    over_frequency,
    passive,
    region,
    teleoperator,
    two_port,
)
from teleopdesign.realise.lti import S

MASTER, SLAVE = 0.2 * S + 1, 0.5 * S + 1


def coupled(**changes):
    """A spring of 1000 N/m between dampings of 1 N s/m, unless changed."""
    given = {"master": MASTER, "slave": SLAVE, "stiffness": 1000} | changes
    return teleoperator(**given)


def delayed(stiffness=1000, delay=1e-3, dampings=(1, 1)):
    return delayed_spring(
        master_inertia=0.2,
        master_damping=dampings[0],
        slave_inertia=0.5,
        slave_damping=dampings[1],
        stiffness=stiffness,
        delay=delay,
    )


@pytest.mark.parametrize("damping", [0, 2])
def test_a_coupling_without_delay_is_always_passive(damping):
    """Spring and damper store and lose energy: proved for both criteria."""
    for claim in (passive(coupled(damping=damping)), absolutely_stable(coupled(damping=damping))):
        assert claim.status == "proved"
        for certificate in claim.certificates:
            certificate.check()


def test_passive_implies_absolutely_stable_but_not_the_reverse():
    """A unilateral two-port: absolutely stable as long as abs(z12 z21) is small, never passive."""
    one_way = two_port([[S + 1, 0], [5, S + 1]])
    assert absolutely_stable(one_way).status == "proved"
    assert passive(one_way).status == "refuted"
    gyrator = two_port([[S + 1, 3], [-3, S + 1]])
    assert passive(gyrator).status == "proved"
    assert absolutely_stable(gyrator).status == "proved"


@pytest.mark.parametrize(
    ("loop", "status"), [(sp.Rational(999, 1000), "proved"), (1, "proved"), (1.001, "refuted")]
)
def test_llewellyns_limit_is_met_exactly(loop, status):
    """r11 = r22 = 1, z12 z21 = loop > 0: 2 >= 2 loop, equality included."""
    claim = absolutely_stable(two_port([[1, 1], [loop, 1]]))
    assert claim.status == status


def test_a_refutation_names_a_termination_that_is_passive():
    """Port 2 held by a mass or spring; then port 1 gives out energy along the wave."""
    claim = absolutely_stable(two_port([[S + 1, 3], [1, S + 1]]))
    assert claim.status == "refuted"
    assert "held by" in claim.verdict.method
    assert claim.record.energy > 0
    assert claim.record.replay() == pytest.approx(claim.record.energy, rel=1e-6)


def test_an_active_port_is_refuted_with_the_other_clamped():
    for z in ([[1, 0], [0, -1]], [[-1, 0], [0, 1]], [[1 / (S - 1), 0], [0, 1]]):
        assert passive(two_port(z)).status == "refuted"
        assert absolutely_stable(two_port(z)).status == "refuted"


@pytest.mark.parametrize(("stiffness", "status"), [(999, "proved"), (1000, "proved")])
def test_a_delayed_spring_is_absolutely_stable_up_to_its_limit(stiffness, status):
    """b_m b_s >= (P T)^2 with the exact delay, equality included."""
    claim = delayed(stiffness)
    assert claim.status == status
    claim.certificates[0].check()


def test_a_delayed_spring_is_refuted_beyond_its_limit():
    """0.1 % beyond: port 2 held by a passive termination, port 1 gives out energy."""
    claim = delayed(1001)
    assert claim.status == "refuted"
    assert claim.record.energy > 0
    assert claim.record.replay() > 0


def test_the_delay_is_exact_not_approximated():
    """At 250 Hz and 1 ms the phase is -90 degrees; a rational approximation would be off."""
    z = coupled(delay=1e-3).over(np.array([250.0]))
    s = 2j * np.pi * 250
    assert z[0, 0, 1] == pytest.approx(-1000 / s * np.exp(-s * 1e-3), rel=1e-12)
    assert z[0, 0, 1] == pytest.approx(-1000 / s * -1j, rel=1e-9)


def test_with_delay_a_positive_margin_is_evidence_never_proof():
    claim = absolutely_stable(coupled(stiffness=900, delay=1e-3, damping=0))
    assert claim.status == "evidence"
    assert claim.holds
    assert "numerical" not in claim.verdict.searched  # said by the status itself
    assert repr(claim).startswith("evidence: ")
    assert "proved" not in repr(claim)


def test_a_reciprocal_two_port_is_passive_where_it_is_absolutely_stable():
    """With z12 = z21 both criteria are r11 r22 >= (Re z12)^2, also with equal delays each way."""
    f = np.geomspace(0.1, 1000, 200)
    margins = over_frequency(coupled(stiffness=1250, delay=1e-3), f)
    assert np.array_equal(margins.passive >= 0, margins.absolutely_stable >= 0)
    assert passive(coupled(stiffness=900, delay=1e-3)).holds
    assert passive(coupled(stiffness=1100, delay=1e-3)).status == "refuted"


def test_margins_over_frequency_change_sign_where_the_criterion_says():
    """b_m b_s against (P T sinc(w T))^2: with P T = 1.25 the margin crosses where sinc = 0.8."""
    f = np.linspace(1.0, 400.0, 3991)
    margins = over_frequency(coupled(stiffness=1250, delay=1e-3), f)
    crossing = f[np.flatnonzero(margins.absolutely_stable >= 0)[0]]
    y = 2 * np.pi * crossing * 1e-3
    assert np.sin(y) / y == pytest.approx(0.8, abs=2e-4)  # steps of 0.1 Hz
    assert margins.graph().x_label == "frequency (Hz)"


def test_the_region_of_stable_couplings_is_that_of_the_formula():
    """Stiffness and delay: proved or refuted at every point, as P T <= sqrt(b_m b_s) says."""
    stiffness, delay = np.array([300.0, 700.0, 1500.0]), np.array([0.5e-3, 1e-3, 2e-3])
    found = region(lambda k, late: delayed(k, late), stiffness, delay)
    expected = stiffness[None, :] * delay[:, None] <= 1.0
    assert np.array_equal(found.status == "proved", expected)
    assert np.array_equal(found.holds == 1, expected)
    assert "proved" in repr(found)


@pytest.mark.parametrize("number", [4, pytest.param(60, marks=pytest.mark.slow)])
def test_passivity_by_the_sweep_agrees_with_the_exact_verdict(number):
    """Random two-ports of first order: a negative margin iff refuted."""
    rng = np.random.default_rng(3)
    for _ in range(number):
        n = [sp.Rational(int(x), 4) for x in rng.integers(-6, 9, 6)]
        z = [[abs(n[0]) + 1 / (S + 1), n[1] + n[2] / (S + 2)], [n[3], abs(n[4]) + 1 + S]]
        system = two_port(z)
        margins = over_frequency(system)
        for claim, margin in (
            (passive(system), margins.passive),
            (absolutely_stable(system), margins.absolutely_stable),
        ):
            if abs(np.min(margin)) > 1e-9:
                assert claim.status == ("proved" if np.min(margin) > 0 else "refuted"), z


def test_a_double_integrator_between_the_ports_is_not_called_stable():
    """z12 = 0, so Llewellyn's inequality holds; yet what passes through 1/s^2 grows."""
    assert absolutely_stable(two_port([[1, 0], [1 / S**2, 1]])).holds is not True


def test_negative_inertia_or_delay_is_one_clear_line():
    with pytest.raises(ModelError, match="must not be negative"):
        delayed(delay=-1e-3)


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ([[1, 2]], "expected"),
        ([[sp.Symbol("b"), 0], [0, 1]], "values are needed for b"),
        ([[sp.exp(S), 0], [0, 1]], "expected a dead time"),
        ([[sp.exp(-(S**2)), 0], [0, 1]], "expected a dead time"),
    ],
)
def test_what_is_no_two_port_is_one_clear_line(entries, message):
    with pytest.raises(ModelError, match=message):
        two_port(entries)
