"""Block algebra of the haptic interface: P1 to P11, all derived from the wiring.

Blocks are matrices that need not commute. H and C depend on speed, so that the forms hold at a
fixed speed or in the sense of describing functions.
"""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from ..derive import block_symbol, return_difference, transfer, transfer_functions
from ..diagrams import ANY, Attached, haptic_interface
from ._proof import BlocksDiffer, Equal, Holds, Limit, NotNegative, ProofSteps, proof
from ._statement import BERNSTEIN, shows

Z_M, Z_H, C, H, K = map(block_symbol, ("Z_M", "Z_H", "C", "H", "K"))
GAMMA = 1 + H
ZHAT_M = GAMMA**-1 * (Z_M - C)
ALL = haptic_interface(
    device=ANY, hand=ANY, cancellation=ANY, force_feedback=ANY, position_loop=ANY
)
FORCE = ALL.open_at("K")  # the loop is open at K: R_D comes from outside
T = transfer_functions(ALL)


@shows(1, BERNSTEIN, "text at figure 1")
def sign_of_the_passive_hand() -> ProofSteps:
    """Only a hand that resists, R_H = -Z_H L, fits both R_M = -(R_H + R_V) and eq (2).

    formula: R_H = -Z_H L
    printed: a sign is missing: R_H = Z_H L
    """
    base = haptic_interface(device=ANY, hand=ANY)
    turned = tuple(replace(b, sign=1) if isinstance(b, Attached) else b for b in base.blocks)
    other = transfer(replace(base, blocks=turned), "R_M", ("R_D",))["R_D"]
    return proof(
        Equal("R_H = -Z_H L gives eq (2)", T["T_o"], Z_H * (Z_H + Z_M) ** -1),
        Equal("R_H = +Z_H L gives another form", other, -Z_H * (Z_M - Z_H) ** -1),
        BlocksDiffer("which is not eq (2)", other, T["T_o"]),
    )


@shows(2, BERNSTEIN, "eq (2)")
def desired_to_felt_force() -> ProofSteps:
    """Desired force to force on the hand, without compensation.

    formula: T_o = Z_H (Z_H + Z_M)^-1
    printed: the inverse is missing in the available text
    """
    right = Z_H * (Z_H + Z_M) ** -1
    return proof(
        Equal("the wiring without C and H gives eq (2)", T["T_o"], right),
        BlocksDiffer("the other order of factors fails", T["T_o"], (Z_H + Z_M) ** -1 * Z_H),
    )


@shows(3, BERNSTEIN, "eq (3)")
def motion_based_cancellation() -> ProofSteps:
    """Desired force to force on the hand, with motion-based cancellation C alone.

    formula: T_MBC = Z_H (Z_H + Z_M - C)^-1
    printed: the inverse and the minus sign are missing in the available text
    """
    return proof(Equal("the wiring without H", T["T_MBC"], Z_H * (Z_H + Z_M - C) ** -1))


@shows(4, BERNSTEIN, "eq (4)")
def force_feedback() -> ProofSteps:
    """Desired force to force on the hand, with force feedback H alone.

    formula: T_FF = (Z_M Z_H^-1 + Gamma)^-1 Gamma,  Gamma = I + H
    printed: the inverses are missing in the available text; Gamma (...)^-1 is wrong for matrices
    """
    denominator = Z_M * Z_H**-1 + GAMMA
    return proof(
        Equal("the wiring without C", T["T_FF"], denominator**-1 * GAMMA),
        BlocksDiffer("the other order of factors fails", T["T_FF"], GAMMA * denominator**-1),
    )


@shows(5, BERNSTEIN, "eq (5)")
def hybrid() -> ProofSteps:
    """Desired force to force on the hand, with both: the device acts like a mechanism Zhat_M.

    formula: T_H = ((Z_M - C) Z_H^-1 + Gamma)^-1 Gamma = Z_H (Zhat_M + Z_H)^-1
    printed: inverses and minus sign are missing in the available text
    """
    form = ((Z_M - C) * Z_H**-1 + GAMMA) ** -1 * GAMMA
    return proof(
        Equal("the wiring with C and H", T["T_H"], form),
        Equal("by the apparent impedance", T["T_H"], Z_H * (ZHAT_M + Z_H) ** -1),
    )


@shows(6, BERNSTEIN, "eq (7)")
def apparent_impedance() -> ProofSteps:
    """Apparent impedance of the mechanism after compensation.

    formula: Zhat_M = Gamma^-1 (Z_M - C)
    printed: the order of factors cannot be read; (Z_M - C) Gamma^-1 needs commuting blocks
    """
    other = (Z_M - C) * GAMMA**-1
    scalars = {s: sp.Symbol(f"scalar_{s}") for s in (Z_M, C, H)}
    return proof(
        Equal("force error over motion, from the wiring", T["Zhat_M"], ZHAT_M),
        Equal("its inverse", T["Zhat_M"], ((Z_M - C) ** -1 * GAMMA) ** -1),
        BlocksDiffer("the other order fails for matrices", T["Zhat_M"], other),
        Equal("for scalars both orders are one", ZHAT_M.subs(scalars), other.subs(scalars)),
    )


@shows(7, BERNSTEIN, "figure 4")
def position_loop() -> ProofSteps:
    """In the position loop a load changes the loop, but not the impedance measured in the loop.

    formula: L = (Zhat_M + Z_H + K)^-1 (K L_D + R_V);  Zhat_M = (R_D - R_M)/L
    """
    closed = (ZHAT_M + Z_H + K) ** -1
    return proof(
        Equal("response to the reference", T["L/L_D"], closed * K),
        Equal("response to the hand", T["L/R_V"], closed),
        Equal("Z_H is not in the measured impedance", sp.diff(T["Zhat_M"], Z_H), sp.S(0)),
        BlocksDiffer("it is in the loop", T["L/L_D"], T["L/L_D"].subs(Z_H, 2 * Z_H)),
    )


@shows(8, BERNSTEIN, "figure 3")
def free_space() -> ProofSteps:
    """In free space a hand feels the apparent impedance, which is the transparency error.

    formula: R_D = 0: R_M = -Zhat_M L,  L = (Zhat_M + Z_H)^-1 R_V
    """
    felt = transfer(FORCE, "R_M", ("L",), given="L")["L"]
    moved = transfer(FORCE, "L", ("R_V",))["R_V"]
    return proof(
        Equal("force on the hand over motion", felt, -ZHAT_M),
        Equal("motion over the hand's force", moved, (ZHAT_M + Z_H) ** -1),
    )


@shows(9, BERNSTEIN, "limits of eqs (3) to (5)")
def limits() -> ProofSteps:
    """Perfect cancellation and infinite force feedback each give the desired force exactly.

    formula: C = Z_M: T_MBC = I;  I - T_FF = (Z_M Z_H^-1 + Gamma)^-1 Z_M Z_H^-1 -> 0 for large Gamma
    """
    x = Z_M * Z_H**-1
    q = sp.Symbol("q", positive=True)

    def at(name: str, values: dict[sp.Symbol, sp.Expr]) -> sp.Expr:
        return sp.sympify(T[name]).subs(values)

    return proof(
        Equal("C = Z_M: T_MBC = I", at("T_MBC", {C: Z_M}), sp.S(1)),
        Equal("C = Z_M: Zhat_M = 0", at("Zhat_M", {C: Z_M}), sp.S(0)),
        Equal("what force feedback leaves", 1 - T["T_FF"], (x + GAMMA) ** -1 * x),
        Equal(
            "the same as (I + Y)^-1 Y with Y = Gamma^-1 Z_M Z_H^-1, of norm at most q = "
            "norm(Z_M Z_H^-1)/(smallest singular value of Gamma)",
            1 - T["T_FF"],
            (1 + GAMMA**-1 * x) ** -1 * GAMMA**-1 * x,
        ),
        Limit(
            "its norm is at most q + q^2 + ... = q/(1 - q), which goes to 0", q / (1 - q), q, 0, 0
        ),
        Equal("H = 0: hybrid is MBC", at("T_H", {H: 0}), T["T_MBC"]),
        Equal("C = 0: hybrid is FF", at("T_H", {C: 0}), T["T_FF"]),
        Equal("both 0: nothing", at("T_H", {C: 0, H: 0}), T["T_o"]),
    )


@shows(10, BERNSTEIN, "text on eq (4)")
def size_of_force_feedback() -> ProofSteps:
    """One degree of freedom: condition for a force on the hand no larger than the desired force.

    formula: T_FF = Gamma/(Gamma + X), X = Z_M/Z_H;  abs(T_FF) <= 1 iff Re y >= -abs(y)^2/2, y =
        X/Gamma
    printed: less than unity if Gamma has the sign of X: the case of real values
    """
    re, im = sp.symbols("re im", real=True)
    gamma, ratio = sp.symbols("gamma ratio")
    y = sp.Symbol("y", positive=True)
    scalar = sp.sympify(T["T_FF"]).subs({H: gamma - 1, Z_M: ratio, Z_H: 1})
    z = re + sp.I * im
    return proof(
        Equal("T_FF = 1/(1 + X/Gamma)", scalar, 1 / (1 + ratio / gamma)),
        Equal(
            "1/abs(T_FF)^2 - 1 = 2 Re y + abs(y)^2, not negative exactly under the condition",
            sp.expand((1 + z) * sp.conjugate(1 + z)) - 1,
            2 * re + re**2 + im**2,
        ),
        NotNegative("real, of one sign: y > 0 satisfies it", 2 * y + y**2, 2 * y + y**2),
        Holds(
            "the sign alone does not decide: y = -3 has the other sign and abs(T_FF) = 1/2",
            sp.Abs(1 / (1 + sp.Integer(-3))),
            "==",
            sp.Rational(1, 2),
        ),
    )


@shows(11, BERNSTEIN, "figure 3")
def loops() -> ProofSteps:
    """Loops that must stay stable: force feedback, and motion-based cancellation, a positive
    feedback.

    formula: FF: 1 + H (I + Z_M Z_H^-1)^-1;  MBC: 1 - C (Z_H + Z_M)^-1
    """
    m, m_h, h, s = sp.symbols("m m_H h s", positive=True)
    loop = return_difference(FORCE.without("C"), "H")
    masses = sp.sympify(loop).subs({H: h, Z_M: m * s**2, Z_H: m_h * s**2})
    return proof(
        Equal("force feedback", loop, 1 + H * (1 + Z_M * Z_H**-1) ** -1),
        Equal(
            "cancellation", return_difference(FORCE.without("H"), "C"), 1 - C * (Z_H + Z_M) ** -1
        ),
        Equal("two masses: loop gain H m_H/(m + m_H)", masses - 1, h * m_h / (m + m_h)),
        Limit("a free rod has loop gain 0", masses - 1, m_h, 0, 0),
    )
