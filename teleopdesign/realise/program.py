"""The loop for one structure of a diagram: equations -> generated source -> numba, compiled once.

Values are arguments: only another structure (other blocks, effects or laws) is compiled again.
Diagrams of one structure with different names share the loop (`private_names`).
A module consists of the laws of a structure, then the loop of `integrator.py`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any

from ..blocks import Body, MatrixImpedance
from ..controllers import Controller
from ..diagrams import Diagram
from ._codegen import Generator
from .compiled import PHI, WEIGHTS, compiled_module
from .equations import Equations, Layout, build_equations
from .laws import PrivateNames, private_names
from .needed_loop import needed_loop


@dataclass(frozen=True)
class CompiledLoop:
    """Functions of `integrator.py` with the laws of one structure, compiled or plain Python."""

    lanes: int
    run: Callable[..., None]
    follow: Callable[..., None]
    differentiate_at_rest: Callable[..., None]


@dataclass(frozen=True)
class Program:
    """The simulation loop for one structure of a diagram, for any values.

    equations: on private symbols (`private_names`), their parameters with the user's names
    laws: source of the laws;  loop: the loop with them, for one simulation
    functions: names of the plain Python module: its laws, its constants
    has_code: whether a block is known as code only, so that the loop is plain Python
    """

    equations: Equations
    layout: Layout
    laws: str
    loop: CompiledLoop
    functions: Mapping[str, Any]
    has_code: bool = False


#: programs by structure on private names, and with the user's names
_programs: dict[Any, Program] = {}
_named: dict[Any, Program] = {}
_MOST_NAMED = 256


def program(
    diagram: Diagram,
    *,
    prescribed: tuple[str, ...] = (),
    sampled: bool = True,
    observer: int = 0,
    jit: bool = True,
) -> Program:
    """The loop for this diagram's structure, built and compiled at the first call.

    observer: order of the velocity observer of the computer; 0: a filtered difference
    jit: False: the same generated source runs as plain Python, some hundred times slower
    """
    named = (_structure(diagram), prescribed, sampled, observer, jit)
    if named not in _named:
        if len(_named) >= _MOST_NAMED:
            _named.clear()
        _named[named] = _program(diagram, prescribed, sampled, observer, jit)
    return _named[named]


def _program(
    diagram: Diagram, prescribed: tuple[str, ...], sampled: bool, observer: int, jit: bool
) -> Program:
    names = private_names(diagram)
    motions = tuple(names.private.get(motion, motion) for motion in prescribed)
    key = (_structure(names.diagram), motions, sampled, observer, jit)
    if key not in _programs:
        with names.in_errors():
            private = build_equations(names.diagram, prescribed=motions, sampled=sampled)
        _programs[key] = write_program(private, observer=observer, jit=jit)
    return _restore_names(_programs[key], names)


def write_program(equations: Equations, *, observer: int = 0, jit: bool = True) -> Program:
    """The loop for equations on private symbols;  observer, jit: as in `program`."""
    generator = Generator(equations, observer=observer)
    laws = generator.source()
    calls = generator.calls()
    plain = _execute(module_source(laws, jit=False))
    plain.update(calls)
    loop = loop_of(laws, 1) if jit and not calls else _entries(plain, 1)
    return Program(equations, generator.layout(), laws, loop, plain, bool(calls))


@lru_cache(maxsize=256)
def loop_of(laws: str, lanes: int) -> CompiledLoop:
    """The compiled loop with these laws, for `lanes` simulations side by side."""
    return _entries(compiled_module(module_source(laws, lanes=lanes), "run"), lanes)


def _entries(module: Mapping[str, Any], lanes: int) -> CompiledLoop:
    return CompiledLoop(lanes, module["run"], module["follow"], module["differentiate_at_rest"])


def _restore_names(private: Program, names: PrivateNames) -> Program:
    """The program with the user's names of signals, states and parameters."""
    layout = private.layout
    named = (*layout.columns, *layout.states, *layout.computer_states, *layout.inputs)
    names.public_names(*named, *layout.sampled_inputs)
    public = {
        field.name: tuple(map(names.public_name, getattr(layout, field.name)))
        for field in fields(layout)
    }
    parameters = private.equations.parameters
    public_parameters = {symbol: names.public_name(name) for symbol, name in parameters.items()}
    equations = replace(private.equations, parameters=public_parameters)
    return replace(private, equations=equations, layout=Layout(**public))


@lru_cache(maxsize=64)
def _execute(source: str) -> dict[str, Any]:
    module: dict[str, Any] = {"__name__": "teleopdesign_plain_kernel"}
    exec(compile(source, "<generated>", "exec"), module)
    return module


def _structure(diagram: Diagram) -> tuple[Any, ...]:
    """All of a diagram but its values."""
    parts = (*diagram.blocks, *diagram.junctions, *diagram.kinematics)
    return (
        diagram.name,
        tuple(diagram.outside.items()),
        diagram.measured,
        *(
            (type(part), *(_without_values(getattr(part, f.name)) for f in fields(part)))
            for part in parts
        ),
    )


def _without_values(content: Any) -> Any:
    """What a field of a part holds, to be compared; of a body or controller its laws."""
    if isinstance(content, Controller):
        return tuple((stage.name, stage.law) for stage in content.stages)
    if isinstance(content, Body):
        return content.effects
    if isinstance(content, MatrixImpedance):
        return tuple(content.parameters)
    return tuple(content.items()) if isinstance(content, Mapping) else content


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
    loop = needed_loop(laws)
    # numba takes as long for a product of constants as for any other
    laws = re.sub(r"(\d+) \* LANES", lambda match: str(int(match[1]) * lanes), laws)
    parts = [text, _HEAD, *head, f"LANES = {lanes}\n", PHI, WEIGHTS, "", laws, loop]
    return "\n".join(parts)
