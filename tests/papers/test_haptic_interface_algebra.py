"""Transfer functions of Bernstein, Lawrence, Pao, World Haptics 2005, derived from the wiring.

The blocks are matrices that need not commute. `proved_equal` is a proof: exact rewriting by
X X^-1 = I, with denominators multiplied out. Exact rational matrices guard the prover itself.
"""

import pytest
import sympy as sp

from teleopdesign.derive import (
    as_latex,
    block_symbol,
    counterexample,
    insert_matrices,
    proved_equal,
    return_difference,
    transfer,
    transfer_functions,
)
from teleopdesign.diagrams import ANY, Attached, haptic_interface

Z_M, Z_H, C, H, K, G = map(block_symbol, ("Z_M", "Z_H", "C", "H", "K", "Gamma"))
GAMMA = 1 + H
ZHAT_M = GAMMA**-1 * (Z_M - C)
ALL = haptic_interface(
    hand=ANY, cancellation=ANY, force_feedback=ANY, position_loop=ANY, device=ANY
)
DERIVED = transfer_functions(ALL)

PRINTED = {
    "T_o": ("T_o", Z_H * (Z_H + Z_M) ** -1),
    "T_MBC": ("T_MBC", Z_H * (Z_H + Z_M - C) ** -1),
    "T_FF": ("T_FF", (Z_M * Z_H**-1 + GAMMA) ** -1 * GAMMA),
    "T_H": ("T_H", ((Z_M - C) * Z_H**-1 + GAMMA) ** -1 * GAMMA),
    "T_H by the apparent impedance": ("T_H", Z_H * (ZHAT_M + Z_H) ** -1),
    "apparent impedance": ("Zhat_M", ZHAT_M),
    "its inverse": ("Zhat_M", ((Z_M - C) ** -1 * GAMMA) ** -1),
    "position loop": ("L/L_D", (ZHAT_M + Z_H + K) ** -1 * K),
    "hand in the position loop": ("L/R_V", (ZHAT_M + Z_H + K) ** -1),
}


@pytest.mark.parametrize("what", PRINTED)
def test_the_wiring_gives_what_the_paper_prints(what):
    """Eqs (2), (3), (4), (5), (7) and figure 4, each as a proven identity."""
    name, printed = PRINTED[what]
    assert proved_equal(DERIVED[name], printed)


@pytest.mark.parametrize("what", PRINTED)
@pytest.mark.parametrize("size", [2, 3])
def test_exact_matrices_agree_with_every_proof(what, size):
    """The same identities on random rational matrices, exactly: a check of the prover."""
    name, printed = PRINTED[what]
    assert counterexample(DERIVED[name], printed, size=size) is None


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("T_FF", GAMMA * (Z_M * Z_H**-1 + GAMMA) ** -1),
        ("Zhat_M", (Z_M - C) * GAMMA**-1),
        ("T_o", (Z_H + Z_M) ** -1 * Z_H),
    ],
)
def test_the_other_order_of_factors_fails_unless_the_blocks_commute(name, wrong):
    """Eqs (2), (4), (7): the reading with exchanged factors is refuted by matrices.

    For scalars, which commute, both readings are one.
    """
    assert not proved_equal(DERIVED[name], wrong)
    assert counterexample(DERIVED[name], wrong, size=3) is not None
    scalars = {s: sp.Symbol(f"x_{s}") for s in (Z_M, Z_H, C, H, K)}
    assert sp.simplify((DERIVED[name] - wrong).subs(scalars)) == 0


def test_the_passive_hand_must_push_against_the_motion():
    """Eq (2) and the text at figure 1: with R_H = +Z_H L the diagram contradicts eq (2)."""
    base = haptic_interface(hand=ANY, device=ANY)
    from dataclasses import replace

    blocks = tuple(replace(b, sign=1) if isinstance(b, Attached) else b for b in base.blocks)
    wrong = transfer(replace(base, blocks=blocks), "R_M", ("R_D",))["R_D"]
    assert proved_equal(wrong, -Z_H * (Z_M - Z_H) ** -1)
    assert counterexample(wrong, PRINTED["T_o"][1]) is not None


def test_what_a_hand_feels_in_free_space_is_the_apparent_impedance():
    """At R_D = 0: R_M = -Zhat_M L, and L = (Zhat_M + Z_H)^-1 R_V."""
    diagram = ALL.open_at("K")
    assert proved_equal(transfer(diagram, "R_M", ("L",), given="L")["L"], -ZHAT_M)
    assert proved_equal(transfer(diagram, "L", ("R_V",))["R_V"], (ZHAT_M + Z_H) ** -1)


def test_the_measured_impedance_does_not_contain_the_load():
    """Figure 4: a mass hung on the rod enters the loop, not (R_D - R_M)/L."""
    assert not DERIVED["Zhat_M"].has(Z_H)
    assert DERIVED["L/L_D"].has(Z_H)


@pytest.mark.parametrize(
    ("name", "values", "left"),
    [
        ("T_MBC", {C: Z_M}, sp.S(1)),
        ("Zhat_M", {C: Z_M}, sp.S(0)),
        ("T_H", {H: 0}, DERIVED["T_MBC"]),
        ("T_H", {C: 0}, DERIVED["T_FF"]),
        ("T_H", {C: 0, H: 0}, DERIVED["T_o"]),
    ],
)
def test_limits_of_the_transfer_functions(name, values, left):
    """C = Z_M is perfect; with H = 0 or C = 0 the hybrid is MBC, FF or nothing."""
    assert proved_equal(sp.sympify(DERIVED[name]).subs(values), left)


def test_force_feedback_becomes_perfect_as_its_gain_grows():
    """I - T_FF = (Z_M Z_H^-1 + Gamma)^-1 Z_M Z_H^-1, which falls as 1/Gamma."""
    ratio = Z_M * Z_H**-1
    assert proved_equal(1 - DERIVED["T_FF"], (ratio + GAMMA) ** -1 * ratio)
    sizes = []
    for gain in (10, 1000, 100000):
        blocks = {
            Z_M: sp.Matrix([[3, 1], [-2, 5]]),
            Z_H: sp.Matrix([[2, -1], [1, 4]]),
            H: gain * sp.Matrix([[2, 1], [0, 1]]),
        }
        sizes.append(float(insert_matrices(1 - DERIVED["T_FF"], blocks).norm()))
    assert sizes[1] / sizes[0] < 0.02 and sizes[2] / sizes[1] < 0.011


def test_force_feedback_stays_below_one_exactly_where_the_ratio_says():
    """One DOF, X = Z_M/Z_H: abs(T_FF) <= 1 iff Re(X/Gamma) >= -abs(X/Gamma)^2 / 2.

    Proof: T_FF = 1/(1 + y), y = X/Gamma, and abs(1 + y)^2 - 1 = 2 Re y + abs(y)^2.
    """
    re, im = sp.symbols("re im", real=True)
    gamma, ratio = sp.symbols("gamma ratio")
    scalar = DERIVED["T_FF"].subs({H: gamma - 1, Z_M: ratio, Z_H: 1})
    assert sp.simplify(scalar - 1 / (1 + ratio / gamma)) == 0
    y = re + sp.I * im
    excess = sp.expand((1 + y) * sp.conjugate(1 + y)) - 1
    assert sp.simplify(excess - (2 * re + re**2 + im**2)) == 0


def test_loops_that_must_stay_stable():
    """Force feedback 1 + H (I + Z_M Z_H^-1)^-1; MBC is positive feedback, 1 - C Z_T^-1."""
    force = ALL.open_at("K")
    assert proved_equal(
        return_difference(force.without("C"), "H"), 1 + H * (1 + Z_M * Z_H**-1) ** -1
    )
    assert proved_equal(return_difference(force.without("H"), "C"), 1 - C * (Z_H + Z_M) ** -1)


def test_two_masses_and_a_free_rod_give_the_loop_gain_of_the_mass_ratio():
    """Loop gain H m_H/(m + m_H) for two masses, 0 for a free rod."""
    s, m, m_hand = sp.symbols("s m m_H", positive=True)
    loop = return_difference(ALL.open_at("K").without("C"), "H")
    scalar = loop.subs({Z_M: m * s**2, Z_H: m_hand * s**2})
    assert sp.simplify(scalar - (1 + H * m_hand / (m + m_hand))) == 0
    assert sp.limit(m_hand / (m + m_hand), m_hand, 0) == 0


def test_text_and_latex_read_as_a_paper():
    assert "T_H = Z_H (Z_M + Gamma Z_H - C)^-1 Gamma" in DERIVED.text()
    assert "Zhat_M = Gamma^-1 (Z_M - C)" in DERIVED.text()
    assert as_latex(Z_H * (Z_H + Z_M) ** -1) == r"Z_{H} \left(Z_{H} + Z_{M}\right)^{-1}"
    assert r"T_{\mathrm{MBC}} &= " in DERIVED.latex()
