"""The functions of exact steps, against many digits."""

import math

import pytest
import sympy as sp

from teleopdesign.realise.exponentials import PHI, WEIGHTS, head


@pytest.fixture(scope="module")
def functions():
    module: dict = {}
    exec(head("test", jit=False) + PHI + WEIGHTS, module)
    return module


@pytest.mark.parametrize("z", [s * 10.0**k for s in (-1, 1) for k in (-12, -6, -2, -0.3)] + [
    -0.999, 0.999, -1.001, 1.001, -5.0, 5.0, -300.0, 30.0, 0.0])  # fmt: skip
def test_phi_and_its_slopes_hold_to_rounding(functions, z):
    x = sp.Rational(z)
    exact = [sp.exp(x)]
    for k in range(3):
        known = sp.Rational(1, math.factorial(k))
        limit = sp.Rational(1, math.factorial(k + 1))
        exact.append((exact[-1] - known) / x if z else limit)
    found = functions["phi"](z)
    for mine, true in zip(found, exact, strict=True):
        # three divisions by z, from a difference at abs(z) = 1: some units of the last digit
        assert mine == pytest.approx(float(sp.N(true, 30)), rel=1e-14)
    if z:
        _, p1, p2, p3 = found
        slopes = [(exact[0] - exact[1]) / x, (exact[1] - 2 * exact[2]) / x]
        for mine, true in zip((p1 - p2, p2 - 2 * p3), slopes, strict=True):
            assert mine == pytest.approx(float(sp.N(true, 30)), rel=1e-13)
