"""Two-ports: Raisbeck's and Llewellyn's criteria, exact, over frequency and with exact delay."""

import json
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    absolutely_stable,
    delayed_spring,
    passive,
    read_record,
    region,
    sweep_margins,
    teleoperator_two_port,
    two_port,
    write_record,
)
from teleopdesign.passivity.search.growing_wave import value_at
from teleopdesign.realise.lti import S

MASTER, SLAVE = 0.2 * S + 1, 0.5 * S + 1


def coupled(**changes):
    """A spring of 1000 N/m between dampings of 1 N s/m, unless changed."""
    arguments = {"master": MASTER, "slave": SLAVE, "stiffness": 1000} | changes
    return teleoperator_two_port(**arguments)


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
    margins = sweep_margins(coupled(stiffness=1250, delay=1e-3), f)
    assert np.array_equal(margins.passive >= 0, margins.llewellyn >= 0)
    assert passive(coupled(stiffness=900, delay=1e-3)).holds
    assert passive(coupled(stiffness=1100, delay=1e-3)).status == "refuted"


def test_margins_over_frequency_change_sign_where_the_criterion_says():
    """b_m b_s against (P T sinc(w T))^2: with P T = 1.25 the margin crosses where sinc = 0.8."""
    f = np.linspace(1.0, 400.0, 3991)
    margins = sweep_margins(coupled(stiffness=1250, delay=1e-3), f)
    crossing = f[np.flatnonzero(margins.llewellyn >= 0)[0]]
    y = 2 * np.pi * crossing * 1e-3
    assert np.sin(y) / y == pytest.approx(0.8, abs=2e-4)  # steps of 0.1 Hz
    assert margins.graph().x_label == "frequency (Hz)"


@pytest.mark.slow
def test_the_region_of_stable_couplings_is_that_of_the_formula():
    """Stiffness and delay: proved or refuted at every point, as P T <= sqrt(b_m b_s) says."""
    stiffness, delay = np.array([300.0, 700.0, 1500.0]), np.array([0.5e-3, 1e-3, 2e-3])
    plane = region(lambda k, late: delayed(k, late), stiffness, delay)
    expected = stiffness[None, :] * delay[:, None] <= 1.0
    assert np.array_equal(plane.status == "proved", expected)
    assert np.array_equal(plane.holds == 1, expected)
    assert "proved" in repr(plane)


@pytest.mark.parametrize("number", [4, pytest.param(60, marks=pytest.mark.slow)])
def test_passivity_by_the_sweep_agrees_with_the_exact_verdict(number):
    """Random two-ports of first order: a negative margin iff refuted."""
    rng = np.random.default_rng(3)
    for _ in range(number):
        n = [sp.Rational(int(x), 4) for x in rng.integers(-6, 9, 6)]
        z = [[abs(n[0]) + 1 / (S + 1), n[1] + n[2] / (S + 2)], [n[3], abs(n[4]) + 1 + S]]
        system = two_port(z)
        margins = sweep_margins(system)
        for claim, margin in (
            (passive(system), margins.passive),
            (absolutely_stable(system), margins.llewellyn),
        ):
            if abs(np.min(margin)) > 1e-9:
                assert claim.status == ("proved" if np.min(margin) > 0 else "refuted"), z


def test_a_double_integrator_between_the_ports_is_not_called_stable():
    """z12 = 0, so Llewellyn's inequality holds; yet what passes through 1/s^2 grows."""
    assert absolutely_stable(two_port([[1, 0], [1 / S**2, 1]])).holds is not True


AT_INFINITY = [[S + 1, S], [S, 1 + S / 2]]
AT_ZERO = [[1, 1 / S], [1 / S, 1]]
LOOSE = [[S + 1 + 1 / S, 2 / S], [2 / S, S + 1 + 1 / S]]
TANK = S / (S**2 + 2)


@pytest.mark.parametrize(
    "z",
    [
        LOOSE,
        AT_ZERO,
        AT_INFINITY,
        [[0, TANK], [TANK, 1]],
        [[TANK, TANK], [TANK, sp.Rational(999999, 1000000) * TANK]],
        [[1 + TANK, 2 * TANK], [2 * TANK, 1 + TANK]],
    ],
)
def test_residues_that_the_axis_does_not_show_refute(z):
    """Llewellyn's inequality holds at every frequency, but the two-port grows between its ports."""
    system = two_port(z)
    assert np.min(sweep_margins(system).llewellyn) > -1e-9
    claim = absolutely_stable(system)
    assert claim.status == "refuted"
    assert claim.record.is_confirmed()
    assert claim.record.replay() == pytest.approx(claim.record.energy, rel=1e-6)


def test_a_slave_that_falls_over_is_refuted():
    """-k/s at the slave, weaker than the coupling: port 2 alone is passive, the pair is not."""
    falls = coupled(master=S + 1, slave=S + 1 - 1 / S, stiffness=10)
    assert absolutely_stable(falls).status == "refuted"
    assert passive(falls).status == "refuted"


@pytest.mark.parametrize(
    "z",
    [
        [[1, 1 / (S - 1)], [0, 1]],  # port 2 does not see it
        [[1, 1 / (S - 1)], [S - 1, 1]],  # cancelled in the product
        [[1, (S - 1) / (S + 1)], [(S + 1) / (S - 1) / 9, 1]],
        [[1, 1 / (S**2 - S + 3)], [1 / (S + 1), 1]],
        [[1 / (S**2 - S + 3), 0], [0, 1]],
    ],
)
def test_a_mode_that_grows_by_itself_is_refuted(z):
    claim = absolutely_stable(two_port(z))
    assert claim.status == "refuted"
    assert claim.record.is_confirmed()
    assert claim.record.energy > 0


@pytest.mark.parametrize(
    "z",
    [
        [[0, 1], [-1, 0]],  # ideal gyrator: no port has an impedance of its own
        [[1, 1], [1, 1]],  # equality at every frequency
        [[1 + 1 / S, 1 / S], [1 / S, 1 + 1 / S]],  # equality of residues
        [[TANK + 1, TANK], [TANK, TANK]],
        [[S, -S], [-S, S]],
        [[1, 1 / S], [S, 1]],  # the product is a number
        [[1, 1 / S], [0, 1]],
        [[1 + 2 * TANK, 3 * TANK], [TANK / 2, 1 + TANK]],  # not reciprocal: 2 >= 3/2
    ],
)
def test_equality_and_degenerate_two_ports_are_proved(z):
    assert absolutely_stable(two_port(z)).status == "proved"


def test_a_multiple_pole_on_the_axis_of_one_way_is_left_unknown():
    for z in ([[1, 0], [1 / S**2, 1]], [[1, S**2], [0, 1]], [[1, 1 / (S**2 + 1) ** 2], [0, 1]]):
        claim = absolutely_stable(two_port(z))
        assert claim.status == "unknown"


def test_a_proof_of_absolute_stability_is_one_certificate_that_holds_z_alone():
    claim = absolutely_stable(coupled())
    (certificate,) = claim.certificates
    assert {*certificate.content} == {"kind", "title", "digest", "impedance"}
    assert "is absolutely stable" in certificate.check()


def test_a_growing_mode_is_written_and_read_back(tmp_path):
    for z in (AT_ZERO, [[S + 1, 3], [1, S + 1]], [[1, 0], [0, -1]], [[1, 1 / (S - 1)], [0, 1]]):
        record = absolutely_stable(two_port(z)).record
        write_record(record, tmp_path / "motion.json")
        assert read_record(tmp_path / "motion.json") == record


@pytest.mark.parametrize("held", [["9", "0", "0"], ["-1", "0", "0"]])
def test_a_growing_mode_with_other_terminations_is_refused(tmp_path, held):
    """Damped enough it does not grow; a negative damper is not passive."""
    record = absolutely_stable(two_port([[1, 1], [2, 1]])).record
    content = record.as_dict() | {"terminations": [held, ["9", "0", "0"]]}
    (tmp_path / "motion.json").write_text(json.dumps(content))
    with pytest.raises(ModelError, match="no record of a motion"):
        read_record(tmp_path / "motion.json")


def test_long_coefficients_are_proved_like_short_ones():
    """Microseconds and hundred-thousandths of a newton second per metre: 4300 digits on the way."""
    tank = S / (S**2 / 10**12 + sp.Rational(7, 9))
    z11, z22 = (sp.Rational(1517, 103680 * 10**9) * S, sp.Rational(1481, 196 * 10**11) * S)
    z12 = sp.Rational(151, 63 * 10**11) * S + 37 * tank / (35 * 10**11)
    z11 += 29 * tank / (245 * 10**10) + sp.Rational(1, 800000)
    z22 += 349 * tank / (225 * 10**11) + sp.Rational(3, 10**5)
    claim = absolutely_stable(two_port([[z11, z12], [z12, z22]]))
    assert claim.status == "proved"
    assert len(claim.certificates) == 1


LATE = sp.exp(-S / 1000)


@pytest.mark.parametrize(
    "z",
    [
        [[1, LATE / S], [LATE / S, 1]],  # residues at 0
        [[S + 1 + 1 / S, 2 * LATE / S], [2 * LATE / S, S + 1 + 1 / S]],
        [[S + 1, S], [S, 1 + S / 2 + LATE / (S + 1)]],  # at infinity
        [[1 + TANK, 2 * TANK * LATE], [2 * TANK * LATE, 1 + TANK]],  # at a pole on the axis
        [[1, LATE / (S - 1)], [0, 1]],  # grows by itself
        [[1, LATE / (S - 1)], [sp.Rational(1, 10), 1]],
        [[1, S * LATE / 10**9], [S * LATE / 10**9, 1]],  # fails far beyond the sweep
        [[1, 0], [LATE / S**2, 1]],
        [[1, 0], [0, 1 / (S - 1 + LATE / 2)]],  # it grows by itself
    ],
)
def test_with_delay_no_evidence_is_given_for_what_the_axis_does_not_show(z):
    for claim in (absolutely_stable(two_port(z)), passive(two_port(z))):
        assert claim.holds is not True


def test_with_delay_the_limit_of_low_frequency_counts():
    """b_m b_s against (P T)^2 within a millionth: it is in slow motion that they meet."""
    late = sp.exp(-S)
    for product, evidence in (
        (1 + sp.Rational(1, 10**6), True),
        (1 - sp.Rational(1, 10**6), False),
    ):
        z = [[1 + 1 / S, late / S], [late / S, product + 1 / S]]
        assert bool(absolutely_stable(two_port(z)).holds) is evidence


def test_with_delay_a_residue_that_refutes_is_detected():
    claim = absolutely_stable(two_port([[1, LATE / S], [LATE / S, 1]]))
    assert claim.status == "refuted"
    assert claim.record.replay() > 0


def test_residues_that_are_not_semidefinite_are_not_passive():
    """At 0, at infinity and on the axis, with lossy ports whose real part shows nothing."""
    for z in (LOOSE, AT_ZERO, AT_INFINITY, [[1 + TANK, 2 * TANK], [2 * TANK, 1 + TANK]]):
        claim = passive(two_port(z))
        assert claim.status == "refuted"
        assert claim.record.energy > 0


def test_negative_inertia_or_delay_is_one_clear_line():
    with pytest.raises(ModelError, match="expected a number >= 0"):
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


def test_a_late_two_port_is_refuted_by_no_rounding_beside_zero():
    """What two dead times and 1/s leave at 1e-9 rad/s agrees in tens of digits: 1 N s/m stay."""
    late = sp.exp(-S / 20)
    z = [[3 + (1 - late**2) / S, -1 + late], [-1 + late, 3 + (1 - late**2) / S]]
    for rate in (1e-12, 1e-9, 1e-6):
        value = value_at(sp.ImmutableMatrix(z), Fraction(rate), Fraction(rate))
        series = 3 + 0.1 - 0.1**2 / 2 * rate * (1 + 1j)
        assert value[0, 0] == pytest.approx(series, rel=1e-9)
    assert passive(two_port(z)).status != "refuted"
