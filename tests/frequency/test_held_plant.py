"""The integral of e^(A t) over a part of a sample, against the exponential of a larger matrix."""

from fractions import Fraction

import mpmath
import pytest

from teleopdesign.frequency.held_plant import _companion, _growth_of

PLANTS = [
    (1, Fraction(1, 3)),
    (1, 0, 0),
    (1, 40, 8000, -3),
    (1, Fraction(1, 1000), 10**6, 0),
    (1, 600, 10**5, 10**7, 10**8, 1),
]


@pytest.mark.parametrize("monic", PLANTS)
@pytest.mark.parametrize("part", [0, Fraction(1, 10**7), Fraction(1, 3), Fraction(7, 8), 1])
def test_the_integral_of_a_part_of_a_sample_is_that_of_an_exponential(monic, part):
    monic = tuple(map(Fraction, monic))
    with mpmath.workdps(50):
        a, time = (
            _companion(monic),
            mpmath.mpf(Fraction(part).numerator) / Fraction(part).denominator,
        )
        n = a.rows
        whole = mpmath.matrix(2 * n, 2 * n)
        for i in range(n):
            whole[i, n + i] = time
            for j in range(n):
                whole[i, j] = a[i, j] * time
        with mpmath.workdps(80):
            known = mpmath.expm(whole, method="taylor")[:n, n:]
        by = _growth_of(monic, 50).integral(time)
        assert mpmath.mnorm(by - known, 1) <= mpmath.mpf(10) ** -47 * mpmath.mnorm(known, 1)
