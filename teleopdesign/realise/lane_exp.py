"""exp as plain arithmetic, so that a compiler works on several numbers by one instruction.

exp(x) = 2^n exp(r), n the whole number next to x/ln 2, exp(r) by its series; ln 2 in two parts
keeps r exact (Cody, Waite, Software Manual for the Elementary Functions, 1980, chapter 6). Within 2
units in the last place of `math.exp`; below 1e-307 it is 0.
"""

from __future__ import annotations

import struct
from math import factorial
from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic, overload

_PER_LN_2 = 1.4426950408889634
_LN_2 = 6.93145751953125e-1  # its first 22 bits: a product with n is exact
_LN_2_REST = 1.42860682030941723212e-6
#: between these 2^n is a normal number
_LEAST, _MOST = -708.0, 709.0
#: terms of the series within abs(r) < 0.35: the first one left out is 4e-18
_TERMS = tuple(1.0 / factorial(k) for k in range(13, -1, -1))


def power_of_two(n: float) -> float:
    """2^n for a whole number n from -1022 to 1023."""
    (power,) = struct.unpack("<d", struct.pack("<q", (int(n) + 1023) << 52))
    return float(power)


@intrinsic  # type: ignore[untyped-decorator,unused-ignore]
def _power_of_two(context: Any, n: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        # by 32 bits: older processors have no instruction for several doubles to 64
        whole = builder.fptosi(arguments[0], ir.IntType(32))
        exponent = builder.add(
            builder.sext(whole, ir.IntType(64)), ir.Constant(ir.IntType(64), 1023)
        )
        bits = builder.shl(exponent, ir.Constant(ir.IntType(64), 52))
        return builder.bitcast(bits, ir.DoubleType())

    return types.float64(types.float64), generate


@overload(power_of_two)
def _compiled_power_of_two(n):  # type: ignore[no-untyped-def]
    return lambda n: _power_of_two(n)  # type: ignore[call-arg,unused-ignore]


@njit(nogil=True, error_model="numpy", forceinline=True, fastmath={"contract", "arcp"})  # type: ignore[untyped-decorator,unused-ignore]
def exp(x: float) -> float:
    """exp(x)"""
    inside = min(max(x, _LEAST), _MOST)
    n = np.floor(inside * _PER_LN_2 + 0.5)
    r = (inside - n * _LN_2) - n * _LN_2_REST
    series = _TERMS[0]
    for term in _TERMS[1:]:
        series = series * r + term
    value = series * power_of_two(n)
    if x < _LEAST:
        value = 0.0
    if x > _MOST:
        value = np.inf
    return value
