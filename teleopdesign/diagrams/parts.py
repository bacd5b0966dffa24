"""Blocks of a diagram, each with its signals; blocks and junctions are the parts of a diagram.

Parts of a diagram as text: the equation of each part, and its laws.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError, check_name
from ..base.frozen import Frozen
from ..blocks import Body, MatrixImpedance
from ..controllers import Controller, Stage
from .junctions import Junction, Kinematics, Weight, as_expression, check_names


@dataclass(frozen=True)
class AnyBlock:
    """A block that is only a name: enough to derive transfer functions, not to simulate."""

    def __repr__(self) -> str:
        return "ANY"


ANY = AnyBlock()
#: what a body that resists a motion is: a part of the device, or what acts at a port of the device
PortRole = Literal["part", "hand", "environment"]


@check_types
@dataclass(frozen=True)
class Moving:
    """A body that forces move: Z motion = command + loads.

    command: force commanded to its actuator (its actuation effects act between both)
    loads: other forces on the body, signal -> sign
    driver: outside force that becomes a result if the motion is prescribed
    """

    name: str
    body: Body | AnyBlock
    motion: str
    command: str
    loads: Mapping[str, float]
    driver: str

    def __post_init__(self) -> None:
        check_name(self.name, where="block")
        check_names(f"block {self.name}", self.motion, self.command, *self.loads)
        if self.driver:  # blank: none
            check_name(self.driver, where=f"block {self.name}: driver")
        for signal, sign in self.loads.items():
            as_expression(sign, where=f"block {self.name}: {signal}")
        object.__setattr__(self, "loads", Frozen(self.loads))

    @property
    def outputs(self) -> tuple[str, ...]:
        return (self.motion,)

    @property
    def inputs(self) -> tuple[str, ...]:
        return (self.command, *self.loads)


@check_types
@dataclass(frozen=True)
class Attached:
    """A body that is attached to a motion and resists it: force = sign Z motion.

    motion: name of the motion;  force: name of the force, N or N m
    sign: -1: the force is positive along the motion, so that it opposes it;  1: positive against it
    role: "hand" or "environment": it acts at a port, and claims about this port leave it out
    """

    name: str
    body: Body | AnyBlock
    motion: str
    force: str
    sign: int = -1
    role: PortRole = "part"

    def __post_init__(self) -> None:
        check_name(self.name, where="block")
        check_names(f"block {self.name}", self.motion, self.force)

    @property
    def outputs(self) -> tuple[str, ...]:
        return (self.force,)

    @property
    def inputs(self) -> tuple[str, ...]:
        return (self.motion,)


@check_types
@dataclass(frozen=True)
class Linked:
    """Bodies coupled by a linear impedance: forces = sign Z motions, Z a matrix.

    motions, forces: names of signals, one of each for a row of Z
    sign, role: as in `Attached`
    raises ModelError: the number of rows differs from that of motions or forces
    """

    name: str
    body: MatrixImpedance
    motions: tuple[str, ...]
    forces: tuple[str, ...]
    sign: int = -1
    role: PortRole = "part"

    def __post_init__(self) -> None:
        check_name(self.name, where="block")
        check_names(f"block {self.name}", *self.motions, *self.forces)
        if not len(self.motions) == len(self.forces) == self.body.size:
            raise ModelError(
                f"{self.name}: {self.body.size} rows, found {len(self.motions)} motions and "
                f"{len(self.forces)} forces"
            )

    @property
    def entries(self) -> tuple[tuple[int, int], ...]:
        """Row and column, from 0, of each entry that is not zero."""
        indices = {tuple(name.split("_")[1:]) for name in self.body.parameters}
        return tuple(sorted((int(i) - 1, int(j) - 1) for i, j in indices))

    def entry_name(self, row: int, column: int) -> str:
        """Name of one entry as a block, such as "Z_H_1_2"; row and column from 0."""
        return f"{self.name}_{row + 1}_{column + 1}"

    @property
    def outputs(self) -> tuple[str, ...]:
        return self.forces

    @property
    def inputs(self) -> tuple[str, ...]:
        return self.motions


@dataclass(frozen=True)
class Entry:
    """Place of a controller in a state space whose entries share their states.

    of: name of the system;  row, column: from 0;  entries: places of all entries that are blocks
    """

    of: str
    row: int
    column: int
    entries: tuple[tuple[int, int], ...]


@check_types
@dataclass(frozen=True)
class Control:
    """A controller: output = controller(input), along the velocity of `motion`.

    motion: of a body, or a junction or kinematics of motions; blank: the law receives no velocity
    analog: realised by electronics, so that no computer samples it
    entry: place in a system of several inputs and outputs whose states it shares
    others: further signals, of a law that is only code, or the command that a law reads
    """

    name: str
    controller: Controller | AnyBlock
    input: str
    output: str
    motion: str = ""
    analog: bool = False
    entry: Entry | None = None
    others: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_name(self.name, where="block")
        check_names(f"block {self.name}: others", *self.others)
        if self.others and not (self.is_code or reads_command(self.controller)):
            raise ModelError(
                f"{self.name}: others are for a law that is known as code alone, or reads a command"
            )
        check_names(f"block {self.name}", self.input, self.output)
        if self.motion:  # blank: none
            check_name(self.motion, where=f"block {self.name}: motion")

    @property
    def outputs(self) -> tuple[str, ...]:
        return (self.output,)

    @property
    def inputs(self) -> tuple[str, ...]:
        return (self.input, *((self.motion,) if self.motion else ()), *self.others)

    @property
    def dead_time(self) -> float | None:
        """Delay (s) of the block if it is a delay and nothing else; else None."""
        return self.controller.dead_time if isinstance(self.controller, Controller) else None

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The laws of the block, in the order of the signal; empty where it is only a name."""
        return self.controller.stages if isinstance(self.controller, Controller) else ()

    @property
    def is_code(self) -> bool:
        """Whether a stage is a nonlinear python-control system, which is only code."""
        return any(stage.law.system is not None for stage in self.stages)

    @property
    def is_measured(self) -> bool:
        """Whether a stage is a measured frequency response, known only at its frequencies."""
        return any(stage.law.response is not None for stage in self.stages)


def reads_command(controller: Controller | AnyBlock) -> bool:
    """Whether a law reads the force that is commanded without its block."""
    return isinstance(controller, Controller) and controller.reads_command


Block = Moving | Attached | Linked | Control
Part = Moving | Attached | Linked | Control | Junction | Kinematics


def _write_sum(terms: Iterable[tuple[str, Weight]]) -> str:
    text = " ".join(_write_term(signal, weight) for signal, weight in terms)
    return text.removeprefix("+ ") or "0"


def _write_term(signal: str, weight: Weight) -> str:
    if isinstance(weight, sp.Expr) and not weight.is_number:
        return f"+ ({weight}) {signal}"
    value = float(weight)
    factor = "" if abs(value) == 1 else f"{abs(value):g} "
    return f"{'-' if value < 0 else '+'} {factor}{signal}"


def write_equation(part: Part) -> str:
    """The equation of a block, junction or kinematics, such as "Z_M X_M = R_D - R_M"."""
    if isinstance(part, Moving):
        return f"{part.name} {part.motion} = {_write_sum([(part.command, 1), *part.loads.items()])}"
    if isinstance(part, Attached):
        return f"{part.force} = {'-' if part.sign < 0 else ''}{part.name} {part.motion}"
    if isinstance(part, Linked):
        sign = "-" if part.sign < 0 else ""
        return f"({', '.join(part.forces)}) = {sign}{part.name} ({', '.join(part.motions)})"
    if isinstance(part, Control):
        law = part.name if part.dead_time is None else f"exp(-s {part.name})"
        return f"{part.output} = {law} {part.input}"
    if isinstance(part, Kinematics):
        return f"{part.output} = {part.expression}"
    return f"{part.output} = {_write_sum(part.terms.items())}"


def list_laws(part: Part) -> str:
    """Names of the laws or effects in a block; "" for sums and kinematics."""
    if isinstance(part, Control):
        return ", ".join(stage.name for stage in part.stages)
    if isinstance(part, Moving | Attached):
        return ", ".join(e.name for e in part.body.effects) if isinstance(part.body, Body) else ""
    return ""
