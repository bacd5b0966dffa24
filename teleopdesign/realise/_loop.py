"""Source of a whole module: the laws of a structure, then the loop of `integrator.py`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from .exponentials import PHI, WEIGHTS

_HEAD = """from math import *

import numpy as np

"""
# Every part is inlined, so values that one part passes to the next stay in registers. A product and
# its sum are one instruction with one rounding (where the processor has it), and repeated divisions
# by one number become products with its inverse. Together this takes 0.75 of the time
_COMPILED = """from numba import njit

options = dict(nogil=True, error_model="numpy", fastmath={"contract", "arcp"})
inlined = dict(forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
jitted = njit(**options, **inlined)
entry = njit(cache=True, **options)
round_down = np.floor
"""
# a call of the library's exp would prevent the compiler from computing several lanes at once
_LANES = """from teleopdesign.realise.lane_exp import exp

"""
PLAIN = """

def jitted(function):
    return function


entry = jitted
round_down = np.floor
"""
_COLUMN = """
@jitted
def column_at(place, memory):
    return memory[place]

"""


def module_source(laws: str, *, jit: bool = True, lanes: int = 1) -> str:
    """The module whose `run` simulates `lanes` simulations;  laws: from `Generator.source`."""
    head = [_LANES if lanes > 1 else "", _COMPILED if jit else PLAIN, _COLUMN]
    return loop_source(laws, head, is_typed=jit, lanes=lanes)


def loop_source(laws: str, head: Sequence[str], *, is_typed: bool, lanes: int = 1) -> str:
    """A module of the laws and the loop.

    head: source that defines `jitted`, `entry`, `round_down` and `column_at`
    is_typed: whether numba compiles the module
    """
    text = '"""Generated from the laws of the blocks of a diagram; do not edit."""'
    if is_typed:
        # places by which functions are called: numba compiles a function again for each literal
        # number that it gets, and once for all numbers of a type
        laws = re.sub(r"^(\w+ = )(\d+ \* LANES)$", r"\1np.int64(\2)", laws, flags=re.MULTILINE)
    # numba takes as long for a product of constants as for any other
    laws = re.sub(r"(\d+) \* LANES", lambda match: str(int(match[1]) * lanes), laws)
    parts = [text, _HEAD, *head, f"LANES = {lanes}\n", PHI, WEIGHTS, "", laws, _integrator()]
    return "\n".join(parts)


@cache
def _integrator() -> str:
    """The part of `integrator.py` below its line of "#"; above it are imports for reading it."""
    text = Path(__file__).with_name("integrator.py").read_text(encoding="utf-8")
    return text.split("#" * 98 + "\n", 1)[1]
