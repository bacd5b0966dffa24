"""The loop for one structure of a diagram: equations -> generated source -> numba, compiled once.

Values are arguments: only another structure (other blocks, effects or laws) is compiled again.
Diagrams of one structure with different names share the loop (`private_names`).
A module consists of the laws of a structure, then the loop of `integrator.py`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from ..blocks import Body, MatrixImpedance
from ..controllers import ControlLaw, Controller
from ..diagrams import Attached, Control, Diagram, Kinematics, Moving
from ..effects import Effect
from ._codegen import Generator
from .compiled import PHI, WEIGHTS, compiled_module
from .equations import Equations, Layout, build_equations
from .laws import PrivateNames, private_names


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


_programs: dict[Any, Program] = {}
#: programs by structure with the user's names, each with the diagram for which it was made
_named: dict[Any, tuple[Diagram, Program]] = {}
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
    named = (_named_structure(diagram), prescribed, sampled, observer, jit)
    if named not in _named:
        made = _program(diagram, prescribed, sampled, observer, jit)
        if len(_named) >= _MOST_NAMED:
            _named.clear()
        _named[named] = diagram, made
    return _named[named][1]


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


def _named_structure(diagram: Diagram) -> tuple[Any, ...]:
    """Structure with names, for diagrams that differ in values only.

    Wiring and laws are compared by identity: the diagram that is kept with the program keeps them
    alive.
    """
    out: list[Any] = [tuple(diagram.outside.items()), diagram.measured]
    out.append((diagram.name, *map(id, diagram.junctions), *map(id, diagram.kinematics)))
    out += diagram.pose.items()
    for part in diagram.blocks:
        if isinstance(part, Control):
            block: Any = part.controller
            wires: tuple[Any, ...] = (*part.inputs, part.output, part.motion, part.analog)
        elif isinstance(part, Moving):
            block = part.body
            wires = (part.motion, part.command, part.driver, *part.loads.items())
        elif isinstance(part, Attached):
            block, wires = part.body, (part.motion, part.force, part.sign)
        else:
            block, wires = part.body, (part.motions, part.forces, part.sign)
        laws: tuple[Any, ...]
        if isinstance(block, Controller):
            laws = tuple((stage.name, id(stage.law)) for stage in block.stages)
        elif isinstance(block, Body):
            laws = tuple(map(id, block.effects))
        else:
            laws = tuple(block.parameters)
        out.append((type(part), part.name, wires, laws))
    return tuple(out)


def _structure(diagram: Diagram) -> tuple[Any, ...]:
    """All of a diagram that its equations depend on, without values; laws compare by identity."""
    out: list[Any] = [tuple(diagram.outside.items()), diagram.measured]
    for part in diagram.parts:
        wires = (part.name, part.inputs, part.outputs)
        terms = tuple(getattr(part, "terms", getattr(part, "loads", {})).items())
        block = getattr(part, "controller", getattr(part, "body", None))
        laws: tuple[Any, ...] = ()
        if isinstance(block, Controller):
            laws = tuple((g.name, g.law.law, _states(g.law)) for g in block.stages)
        elif isinstance(block, Body):
            laws = tuple((e.name, e.role, e.law, _states(e)) for e in block.effects)
        elif isinstance(block, MatrixImpedance):
            laws = tuple(block.parameters)
        elif isinstance(part, Kinematics):
            laws = (part.expression,)
        sign = getattr(part, "sign", 1)
        motion = (part.motion, part.analog) if isinstance(part, Control) else ()
        out.append((type(part).__name__, wires, terms, sign, motion, laws))
    return tuple(out)


def _states(law: Effect | ControlLaw) -> tuple[Any, ...]:
    return tuple(law.states.items())


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
