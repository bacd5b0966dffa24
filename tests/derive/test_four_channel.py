"""The four-channel teleoperator against an independent derivation, by either convention."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.derive import (
    convert_convention,
    hybrid_from_impedance,
    impedance_from_hybrid,
    two_port_functions,
)
from teleopdesign.diagrams import (
    four_channel,
)

S = sp.Symbol("s")
NAMES = "Z_m Z_s C_m C_s C_1 C_2 C_3 C_4 K_1 K_2 K_3 K_4".split()
B = {n: sp.Symbol(n) for n in NAMES}
T = {k: sp.Symbol(f"T_{k}", positive=True) for k in range(1, 5)}


def by_hand(scaled):
    """F_m and X_s on X_m and F_s, solved from Lawrence's equations by sympy."""
    x_m, x_s, f_m, f_s = sp.symbols("X_m X_s F_m F_s")
    late = {
        k: B[f"C_{k}"] * (B[f"K_{k}"] if scaled else 1) * sp.exp(-S * T[k]) for k in range(1, 5)
    }
    master = sp.Eq(B["Z_m"] * x_m, f_m - B["C_m"] * x_m + late[2] * f_s + late[4] * x_s)
    slave = sp.Eq(B["Z_s"] * x_s, f_s - B["C_s"] * x_s + late[1] * x_m + late[3] * f_m)
    solved = sp.solve([master, slave], [f_m, x_s], dict=True)[0]
    return {
        f"h_{i}{j}": sp.diff(sp.expand(sp.together(solved[row])), column)
        for i, row in ((1, f_m), (2, x_s))
        for j, column in ((1, x_m), (2, f_s))
    }


def commuting(expression):
    """The derived expression with symbols that commute, as those of one degree of freedom do."""
    names = {a: B.get(a.name, T.get(int(a.name[2:])) if a.name[:2] == "T_" else S)
             for a in expression.free_symbols}  # fmt: skip
    return expression.xreplace(names)


def number(expression, at, late):
    """The expression at these blocks and numbers for e^(-s T_k)."""

    def product(power):
        powers = sp.expand(power).coeff(S)
        return sp.Mul(*(late[k] ** -powers.coeff(t) for k, t in T.items()))

    return sp.nsimplify(expression.replace(sp.exp, product).subs(at))


@pytest.mark.parametrize("scaled", [pytest.param(False, marks=pytest.mark.slow), True])
def test_the_hybrid_matrix_is_that_of_an_independent_derivation(scaled):
    """Compared at random rational numbers in exact arithmetic, each e^(-s T) one."""
    scales = {"position_scale": 0.5, "force_scale": 2.0} if scaled else {}
    functions, expected = two_port_functions(four_channel(delay=0.02, **scales)), by_hand(scaled)
    rng = np.random.default_rng(1)
    for _ in range(3):
        at = {x: sp.Rational(int(rng.integers(1, 99)), 7) for x in B.values()}
        numbers = {k: sp.Rational(int(rng.integers(1, 99)), 100) for k in T}
        for name, formula in expected.items():
            values = [number(e, at, numbers) for e in (commuting(functions[name]), formula)]
            assert values[0] == values[1], name


def test_perfect_transparency_is_the_ideal_hybrid_matrix():
    """C_1 = Z_s + C_s, C_4 = Z_m + C_m, C_2 = C_3 = 1, no delay: Lawrence's condition."""
    functions = two_port_functions(four_channel())
    ideal = {"h_12": -1, "h_21": 1, "h_22": 0}
    z = {"Z_m": 3, "C_m": 5, "Z_s": 7, "C_s": 2, "C_1": 9, "C_4": 8, "C_2": 1, "C_3": 1}
    for name, number in ideal.items():
        e = commuting(functions[name])
        assert sp.nsimplify(e.subs({B[n]: v for n, v in z.items()})) == number
    assert sp.nsimplify(commuting(functions["h_11"]).subs({B[n]: v for n, v in z.items()})) == 0


def test_scales_are_of_both_ways():
    diagram = four_channel(position_scale=0.5, force_scale=4.0)
    scales = {k: diagram.values[f"K_{k}.gain.gain"] for k in range(1, 5)}
    assert scales == {1: 0.5, 2: 4.0, 3: 0.25, 4: 2.0}


NUMBER = st.fractions(-9, 9, max_denominator=9).map(
    lambda x: sp.Rational(x.numerator, x.denominator)
)
CONVENTION = st.sampled_from(["position", "velocity"])


@given(z=st.tuples(NUMBER, NUMBER, NUMBER, NUMBER.filter(bool)), convention=CONVENTION)
@settings(deadline=None)
def test_matrices_convert_there_and_back_exactly(z, convention):
    matrix = sp.Matrix(2, 2, z)
    h = hybrid_from_impedance(matrix, convention=convention)
    assert impedance_from_hybrid(h, convention=convention) == matrix


@given(z=st.tuples(NUMBER, NUMBER, NUMBER, NUMBER.filter(bool)))
@settings(deadline=None)
def test_both_conventions_are_one_two_port(z):
    """The way by matrices and the way by single functions meet."""
    by_position = sp.Matrix(2, 2, z)
    by_velocity = by_position / S
    h = hybrid_from_impedance(by_position, convention="position")
    expected = hybrid_from_impedance(by_velocity, convention="velocity")
    for i in range(2):
        for j in range(2):
            name = f"h_{i + 1}{j + 1}"
            turned = convert_convention(name, h[i, j], "velocity")
            assert sp.simplify(turned - expected[i, j]) == 0
            assert sp.simplify(convert_convention(name, turned, "position") - h[i, j]) == 0


@pytest.mark.parametrize("convention", ["position", "velocity"])
def test_entries_of_several_axes_keep_their_order(convention):
    """Every symbol replaced by a matrix of numbers; the equations of the port are solved anew."""
    rng = np.random.default_rng(5)
    names = "Z_mm Z_ms Z_sm Z_ss"
    symbols = sp.symbols(names, commutative=False)
    blocks = dict(zip(symbols, rng.integers(1, 9, (4, 2, 2)) + 9.0 * np.eye(2), strict=True))
    h = hybrid_from_impedance(sp.Matrix(2, 2, symbols), convention=convention)
    made = [[_in_numbers(e, blocks) for e in row] for row in h.tolist()]
    motion = rng.normal(size=(2, 2))
    z_mm, z_ms, z_sm, z_ss = (blocks[x] for x in symbols)
    f_m, f_s = z_mm @ motion[0] + z_ms @ motion[1], z_sm @ motion[0] + z_ss @ motion[1]
    sign = -1 if convention == "velocity" else 1  # F_e = -F_s and -v_s
    np.testing.assert_allclose(made[0][0] @ motion[0] + made[0][1] @ (sign * f_s), f_m)
    np.testing.assert_allclose(made[1][0] @ motion[0] + made[1][1] @ (sign * f_s), sign * motion[1])
    back = impedance_from_hybrid(h, convention=convention)
    for entry, symbol in zip(back, symbols, strict=True):
        np.testing.assert_allclose(_in_numbers(entry, blocks), blocks[symbol], rtol=1e-12)


def _in_numbers(expression, blocks):
    """A sum of products of symbols and inverses, in their order, as a matrix."""
    if expression.is_Add:
        return sum(_in_numbers(e, blocks) for e in expression.args)
    if expression.is_Mul:
        product = np.eye(2)
        for factor in expression.args:
            product = product @ _in_numbers(factor, blocks)
        return product
    if expression.is_Pow:
        assert expression.exp == -1
        return np.linalg.inv(_in_numbers(expression.base, blocks))
    return float(expression) * np.eye(2) if expression.is_Number else blocks[expression]
