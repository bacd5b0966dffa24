"""Late two-ports: series, residues and growth against numbers, and the obstacles that they name."""

import cmath
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from teleopdesign.passivity import two_port
from teleopdesign.passivity.two_port import delayed_two_port as late
from teleopdesign.realise.lti import S

T = sp.Rational(1, 5)
#: entries whose limits differ: poles at zero and on the axis, dead times, growth like s
ENTRIES = [
    sp.S(0),
    3 + 2 * S,
    5 / S + 1,
    (S + 2) / (S**2 + 3 * S + 1),
    2 * sp.exp(-S * T) * (1 + 3 / S),
    sp.exp(-2 * S * T) * S / (S**2 + 4) - 3 / (S + 1),
    (4 * S + 1) * sp.exp(-S * T) + 2 - sp.exp(-3 * S * T) * S,
    (1 - sp.exp(-S * T)) * 7 / S,
    (1 - S / 3 + S**2) / (S + 2),
]


def number(entry, s):
    return complex(sp.N(entry.subs(S, sp.sympify(s)), 30))


def terms_of(entry):
    return late.late_terms(two_port([[entry, 0], [0, 1]]).z[0, 0])


@pytest.mark.parametrize("entry", ENTRIES)
def test_an_entry_is_the_sum_of_its_late_terms(entry):
    s = 0.3 + 0.8j
    terms = terms_of(entry)
    assert sorted({t.delay for t in terms}) == [t.delay for t in terms]
    total = sum(
        np.polyval([float(c) for c in reversed(p)], s)
        / np.polyval([float(c) for c in reversed(q)], s) * cmath.exp(-s * float(t.delay))
        for t in terms for p, q in [t.ratio]
    )  # fmt: skip
    assert total == pytest.approx(number(entry, s), rel=1e-12, abs=1e-15)


def test_a_dead_time_below_the_line_is_no_sum_of_late_terms():
    assert late.late_terms(1 / (1 + sp.exp(-S * T))) is None
    assert late.late_terms(sp.exp(-S * sp.pi)) is None
    assert late.late_terms(sp.exp(-S * T) - sp.exp(-S * T) * (S + 1) / (S + 1)) == ()


@pytest.mark.parametrize("entry", ENTRIES)
def test_the_series_at_zero_is_the_entry_nearby(entry):
    series = late._series(terms_of(entry))
    s = 0.08 + 0.05j  # the nearest pole is at 0.38: 0.25^24 is 1e-15
    total = sum(float(c) * s**n for n, c in series.items())
    assert total == pytest.approx(number(entry, s), rel=1e-11, abs=1e-14)


@pytest.mark.parametrize("shift", range(4))
def test_what_must_not_be_negative_at_low_frequency_is_that_of_both_criteria(shift):
    z = [(ENTRIES[1:5] + ENTRIES[7:])[(i + shift) % 6] for i in range(4)]
    series = [late._series(terms_of(e)) for e in z]
    w = 0.06
    z11, z12, z21, z22 = (number(e, sp.I * sp.Rational(6, 100)) for e in z)
    loop, over = z12 * z21, 2 * z11.real * z22.real - (z12 * z21).real
    expected = {
        "passive": [z11.real, z22.real,
                    w**2 * (4 * z11.real * z22.real - abs(z12 + z21.conjugate()) ** 2)],
        "absolutely stable": [z11.real, z22.real, w**2 * over,
                              w**4 * (over**2 - abs(loop) ** 2)],
    }  # fmt: skip
    for criterion, figures in expected.items():
        values = [
            np.polyval([float(c) for c in reversed(p)], w)
            for p in late._low_frequency(series, criterion)
        ]
        assert values == pytest.approx(figures, rel=1e-7, abs=1e-9), criterion


@pytest.mark.parametrize("shift", range(4))
def test_no_coefficient_counts_that_the_rest_of_a_series_would_change(shift, monkeypatch):
    """Of series that are twice as long, the first coefficients are the same."""
    z = [(ENTRIES[1:5] + ENTRIES[7:])[(i + shift) % 6] for i in range(4)]
    points = {}
    for terms in (late._TERMS, 2 * late._TERMS):
        monkeypatch.setattr(late, "_TERMS", terms)
        series = [late._series(terms_of(e)) for e in z]
        points[terms] = [
            p for c in ("passive", "absolutely stable") for p in late._low_frequency(series, c)
        ]
    short, long = points.values()
    assert min(map(len, short)) > 6
    for few, many in zip(short, long, strict=True):
        assert few == [*many, *[0] * len(few)][: len(few)]


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("s", [2j, 1j])
def test_a_residue_is_the_limit_of_the_entry_times_the_distance(entry, s):
    residue = late._residue(terms_of(entry), s)
    near = 1e-6
    value = number(entry, sp.nsimplify(s.imag) * sp.I + sp.Rational(1, 10**6)) * near
    assert residue == pytest.approx(value, abs=2e-5)


@pytest.mark.parametrize("entry", ENTRIES)
def test_growth_far_out_is_that_of_numbers(entry):
    terms = terms_of(entry)
    w = 1e7
    power, size = late._far_size(terms)
    sizes = [abs(number(e, sp.I * 10**7)) for e in sp.Add.make_args(sp.expand(entry))]
    if entry != 0:
        assert size * Fraction(w) ** power >= abs(number(entry, sp.I * 10**7)) * (1 - 1e-6)
        assert size * Fraction(w) ** power <= sum(sizes) * (1 + 1e-6)
    plain = [t for t in terms if not t.delay]
    slope = sum((late._slope(t) for t in terms), Fraction(0))
    if not any(t.delay for t in terms):
        assert float(slope) == pytest.approx(number(entry, sp.I * 10**7).imag / w, abs=1e-5)
        far = late._real_far_out(terms)
        real = number(entry, sp.I * 10**7).real
        if far is None:
            assert real <= 1e-20
        else:
            assert float(far[1]) * w ** far[0] == pytest.approx(real, rel=1e-5)
    elif len(plain) < len(terms):
        assert late._real_far_out(terms) is None


SMALL = st.fractions(-3, 3, max_denominator=6)


@settings(max_examples=40)
@given(SMALL, SMALL, SMALL, SMALL, SMALL, SMALL)
def test_residues_are_allowed_as_their_matrix_says(a, b, c, d, e, f):
    """Passive: Hermitian and semidefinite.  Stable: 2 k11 k22 - Re k12 k21 >= abs(k12 k21)."""
    k12, k21 = complex(b, e), complex(c, f)
    for forth, back in ((k12, k21), (k12, k12.conjugate())):
        k = [complex(a), forth, back, complex(d)]
        matrix = np.array(k).reshape(2, 2)
        least = np.linalg.eigvalsh(matrix)[0]
        assume(abs(least) > 1e-9)
        passive = bool(forth == back.conjugate() and least >= 0)
        assert late._is_allowed(k, "passive", 1e-12) == passive
        over = 2 * float(a * d) - (forth * back).real - abs(forth * back)
        assume(abs(over) > 1e-9)
        stable = bool(min(a, d) >= 0 and over >= 0)
        assert late._is_allowed(k, "absolutely stable", 1e-12) == stable
    exact = late._holds_exactly([a, b, c, d], "absolutely stable")
    assert exact == (min(a, d) >= 0 and 2 * a * d - b * c >= abs(b * c))
    assert late._holds_exactly([a, b, b, d], "passive") == (min(a, d) >= 0 and a * d >= b * b)
    assert late._holds_exactly([a, b, c, d], "passive") == (
        b == c and min(a, d) >= 0 and a * d >= b * b
    )


E_T = sp.exp(-S * T)
#: what is in the way, by criterion: words, or nothing
NAMED = {
    "a late spring between dampers": ([1 + 3 / S, E_T / S, E_T / S, 1 + 3 / S], ""),
    "a residue that is no spring": ([1 + 1 / S, 3 * E_T / S, 3 * E_T / S, 1 + 1 / S],
                                    "residues at s = 0"),
    "two poles at zero": ([1 + 1 / S**2, E_T, E_T, 1], "multiple pole at s = 0"),
    "a growing pole": ([1 + 1 / (S - 1), E_T, E_T, 1], "right half plane"),
    "a dead time below": ([1, E_T, 1 / (2 + E_T), 1], "denominator of z21"),
    "a late port": ([2 + S, E_T, E_T, 3 + E_T], "does not fade"),
    "growth like s^2": ([S**2 + 1, E_T, E_T, 1], "faster than s"),
    "a late mass": ([1 + S, S * E_T, S * E_T, 1 + S], "growth like s"),
    "dampers that a late one outdoes": ([1, 2 * E_T, 2 * E_T, 1], "no bound"),
    "two poles on the axis": ([1 + 1 / (S**2 + 1) ** 2, E_T / 2, E_T / 2, 1], "on the axis"),
    "a resonance that one port has": ([1, E_T / 4 + S / (S**2 + 4), E_T / 4 + S / (S**2 + 4), 1],
                                      "residues at 2 rad/s"),
}  # fmt: skip


@pytest.mark.parametrize("name", NAMED)
def test_what_is_in_the_way_of_margins_on_the_axis_is_named(name):
    entries, words = NAMED[name]
    system = two_port([entries[:2], entries[2:]])
    reasons = late.obstacles(system, "absolutely stable")
    if words:
        assert any(words in reason for reason in reasons), reasons
    else:
        assert reasons == ()


def test_late_dampers_stay_within_those_of_the_ports_up_to_their_mean():
    """Stable: r1 r2 >= abs(z12 z21).  Passive: twice the root of r1 r2 >= abs(z12) + abs(z21)."""
    for r1, r2, forth, back in ((1, 4, 1, 4), (1, 4, 2, 2), (2, 2, 3, 1), (1, 4, 4, 2)):
        system = two_port([[r1, forth * E_T], [back * E_T, r2]])
        stable = not late.obstacles(system, "absolutely stable")
        passive = not late.obstacles(system, "passive")
        assert stable == (r1 * r2 >= forth * back)
        assert not passive or 2 * (r1 * r2) ** 0.5 >= forth + back


@pytest.mark.parametrize(("r1", "r2"), [(1, 4), (4, 1), (1, 1), (2, 2)])
def test_what_counts_far_out_is_what_is_left_of_both_ports_there(r1, r2):
    """Dampers that are ten times as strong at low frequency bound no late coupling beyond."""
    for forth, back in ((1, 1), (2, 2), (4, 2), (1, 4)):
        rest = 10 / (S + 1)
        system = two_port([[r1 + rest, forth * E_T], [back * E_T, r2 + rest]])
        assert (not late.obstacles(system, "absolutely stable")) == (r1 * r2 >= forth * back)
