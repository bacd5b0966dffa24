"""Functions of exact integration steps, the same in every generated source.

    phi_1(z) = (e^z - 1)/z,   phi_2(z) = (phi_1(z) - 1)/z,   phi_3(z) = (phi_2(z) - 1/2)/z

Their derivatives need no other functions: phi_1' = phi_1 - phi_2, phi_2' = phi_2 - 2 phi_3.
"""

from __future__ import annotations

from math import factorial

#: terms of the series of phi_3 within abs(z) < 1: the first one left out is 2e-16 of it
_TERMS = 13


def _series() -> str:
    text = f"1 / {float(factorial(_TERMS + 2)):.1f}"
    for k in range(_TERMS - 2, -1, -1):
        text = f"1 / {float(factorial(k + 3)):.1f} + z * ({text})"
    return text


#: source of `phi`, for use after a line that defines `jitted`
PHI = f'''
@jitted
def phi_near(z):
    """exp, phi_1, phi_2, phi_3 of z by their series, within abs(z) < 1."""
    p3 = {_series()}
    p2 = z * p3 + 0.5
    p1 = z * p2 + 1.0
    return z * p1 + 1.0, p1, p2, p3


@jitted
def phi(z):
    """exp, phi_1, phi_2, phi_3 of z, accurate through zero."""
    if abs(z) < 1.0:
        return phi_near(z)
    e = exp(z)
    p1 = (e - 1.0) / z
    p2 = (p1 - 1.0) / z
    return e, p1, p2, (p2 - 0.5) / z
'''
#: source of `weights`, for use after `phi`
WEIGHTS = '''
@jitted
def weights(z, is_near):
    """exp and phi_1 of z/2, exp of z, and the three weights of a step;  is_near: abs(z) < 2."""
    e, p1, p2, p3 = phi_near(z / 2) if is_near else phi(z / 2)
    q1 = 0.5 * (e + 1.0) * p1
    q2 = 0.25 * (p1 * p1 + 2 * p2)
    q3 = 0.125 * (p1 * p2 + p2 + 2 * p3)
    return e, p1, e * e, q1 - 3 * q2 + 4 * q3, 2 * q2 - 4 * q3, 4 * q3 - q2
'''
_JIT = """from numba import njit

jitted = njit(cache=True, nogil=True, error_model="numpy")
"""
_NO_JIT = """

def jitted(function):
    return function
"""


def head(text: str, *, jit: bool = True) -> str:
    """First lines of a generated module: its docstring, its imports, and `jitted`."""
    return f'"""{text}"""\nfrom math import *\n\nimport numpy as np\n{_JIT if jit else _NO_JIT}\n'
