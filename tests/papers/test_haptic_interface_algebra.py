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
    transfer_functions,
)
from teleopdesign.diagrams import ANY, haptic_interface

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
@pytest.mark.parametrize("size", [2, 3])
def test_exact_matrices_agree_with_every_proof(what, size):
    """The same identities on random rational matrices, exactly: a check of the prover."""
    name, printed = PRINTED[what]
    assert counterexample(DERIVED[name], printed, size=size) is None


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


def test_text_and_latex_read_as_a_paper():
    assert "T_H = Z_H (Z_M + Gamma Z_H - C)^-1 Gamma" in DERIVED.text()
    assert "Zhat_M = Gamma^-1 (Z_M - C)" in DERIVED.text()
    assert as_latex(Z_H * (Z_H + Z_M) ** -1) == r"Z_{H} \left(Z_{H} + Z_{M}\right)^{-1}"
    assert r"T_{\mathrm{MBC}} &= " in DERIVED.latex()
