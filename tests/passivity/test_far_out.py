"""What late two-ports do as the frequency grows, against their values at a very high one."""

import mpmath
import pytest
import sympy as sp

from teleopdesign.passivity import two_port
from teleopdesign.passivity.two_port.delayed_two_port import (
    _fades,
    _far_size,
    _real_far_out,
    late_terms,
    obstacles,
)
from teleopdesign.realise.lti import S

FAR = mpmath.mpf(10) ** 6
LATE = sp.exp(-S / 10)
ENTRIES = [
    S + 2, 3 / (S + 1), (2 * S + 1) / (S + 3), S * (S + 1) / (S**2 + S + 4), 5 * S / (S + 2) ** 2,
    2 + 1 / S, (S**2 + 3 * S + 1) / (S + 1),
]  # fmt: skip


def at(entry, w):
    with mpmath.workdps(60):
        return mpmath.mpmathify(sp.N(entry.subs(S, sp.I * sp.Float(w, 60)), 50))


@pytest.mark.parametrize("entry", ENTRIES, ids=str)
def test_the_real_part_and_the_size_go_as_the_stated_power(entry):
    value = at(entry, FAR)
    power, size = _real_far_out(late_terms(entry))
    assert float(value.real) == pytest.approx(float(size) * float(FAR) ** power, rel=1e-4)
    power, size = _far_size(late_terms(entry))
    assert float(abs(value)) == pytest.approx(float(size) * float(FAR) ** power, rel=1e-4)


@pytest.mark.parametrize("entry", [LATE, S + 1 + LATE / S, S - 3, -1 / (S + 1)], ids=str)
def test_of_a_late_term_or_a_negative_part_no_power_is_reported(entry):
    assert _real_far_out(late_terms(entry)) is None


LAG, LAG_2 = 1 / (S + 1), 1 / (S + 1) ** 2
FADING = [
    # z11, z12, z21, z22: whether the real parts far out are as large as each criterion asks
    (sp.S(2), LATE, LATE, sp.S(2), True, True),
    (sp.S(1), LATE, LATE, sp.S(1), True, True),  # just as large
    (sp.S(1), LATE, LATE, sp.Rational(99, 100), False, False),
    (sp.S(1), 4 * LATE, LATE / 4, sp.S(1), False, True),  # scaled: stable, not passive
    (sp.S(1), LAG * LATE, LAG * LATE, LAG, True, True),  # w^-2 for w^-2: Re 1/(s + 1)
    (LAG, LAG * LATE, LAG * LATE, LAG, False, False),  # w^-4 against w^-2
    (LAG, LAG_2 * LATE, LAG_2 * LATE, LAG, True, True),
    (LAG, LAG_2 * LATE, 2 * LAG_2 * LATE, LAG, False, False),
    (LAG, LAG_2 * LATE, sp.S(0), LAG, True, True),
    (S + 1, LATE, LATE, S + LATE, False, False),  # late itself: nothing is known
    (LAG, LAG, LAG, LAG, True, True),  # without dead times: left to other checks
]


@pytest.mark.parametrize("case", range(len(FADING)))
def test_couplings_fade_before_the_real_parts_do_or_the_test_reports_that_they_do_not(case):
    *entries, passive, stable = FADING[case]
    z = [late_terms(sp.sympify(e)) for e in entries]
    assert _fades(z, "passive") == passive
    assert _fades(z, "absolutely stable") == stable


@pytest.mark.parametrize("criterion", ["passive", "absolutely stable"])
@pytest.mark.parametrize(
    ("diagonal", "across"), [(5.5, 6), (6.5, 6), (1.1, 1), (0.9, 1), (3, 0), (-1, 0)]
)
@pytest.mark.parametrize("pole", [S, S**2 + 4, S**2 + sp.Rational(7, 3)])
def test_beside_a_dead_time_what_two_ports_share_without_loss_is_held_against_their_product(
    criterion, diagonal, across, pole
):
    """Springs, or oscillators, of a network that acts alike both ways: own squared, or nothing."""
    shape = (1 if pole == S else S) / pole
    rest = 5 + sp.exp(-S / 10) / (1 + S) / 10
    diagonal, across = sp.Rational(str(diagonal)) * shape, across * shape
    system = two_port([[diagonal + rest, across], [across, diagonal + 5]])
    shown = [text for text in obstacles(system, criterion) if text.startswith("the residues at")]
    is_met = diagonal / shape >= across / shape
    assert bool(shown) == (not is_met)
