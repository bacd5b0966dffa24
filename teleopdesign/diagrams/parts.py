"""What a diagram is made of: blocks, junctions and kinematics, each with the signals it wires."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from ..arguments import check_types
from ..blocks import Body, MatrixImpedance
from ..controllers import Controller
from ..errors import ModelError, quote
from ..frozen import Frozen
from ..names import check_name


@dataclass(frozen=True)
class AnyBlock:
    """A block known by its name only: enough to derive transfer functions, not to simulate."""

    def __repr__(self) -> str:
        return "ANY"


ANY = AnyBlock()
#: a sign, a factor, or an expression of positions (on `position_symbol`), such as a lever arm
Weight: TypeAlias = float | sp.Expr


def position_symbol(name: str) -> sp.Symbol:
    """Symbol of a position (m or rad), for weights of forces and for kinematics."""
    return sp.Symbol(name, real=True)


def as_expression(weight: Weight, *, where: str) -> sp.Expr:
    """A weight as sympy expression; text is none: `read_expression` reads text.

    raises ModelError: neither a number nor an expression
    """
    try:
        expression = sp.sympify(weight, strict=True)
    except sp.SympifyError:
        expression = None
    if not isinstance(expression, sp.Expr):
        shown = quote(weight) if isinstance(weight, str) else type(weight).__name__
        raise ModelError(f"{where}: found {shown}, expected a number or a sympy expression")
    return expression


def _check_names(where: str, *names: str) -> None:
    for name in names:
        check_name(name, where=where)
        if name == "pi":  # in an expression it would be the number, in silence
            raise ModelError(f'{where}: found the name "pi", a number in expressions')


@check_types
@dataclass(frozen=True)
class Moving:
    """A body that forces move:  Z motion = command + loads.

    command: force commanded to its actuator (its actuation effects stand between)
    loads: other forces on it, signal -> sign
    driver: outside force that is whatever it must be where the motion is prescribed instead
    """

    name: str
    body: Body | AnyBlock
    motion: str
    command: str
    loads: Mapping[str, float]
    driver: str

    def __post_init__(self) -> None:
        check_name(self.name, where="block")
        _check_names(f"block {self.name}", self.motion, self.command, *self.loads)
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
    """A body on a motion, which the body resists:  force = sign Z motion.

    motion: name of the motion that it follows;  force: name of the force that it makes, N or N m
    sign: -1: the force is counted along the motion, so that it opposes it;  1: against the motion
    """

    name: str
    body: Body | AnyBlock
    motion: str
    force: str
    sign: int = -1

    def __post_init__(self) -> None:
        check_name(self.name, where="block")
        _check_names(f"block {self.name}", self.motion, self.force)

    @property
    def outputs(self) -> tuple[str, ...]:
        return (self.force,)

    @property
    def inputs(self) -> tuple[str, ...]:
        return (self.motion,)


@check_types
@dataclass(frozen=True)
class Linked:
    """Bodies joined by a linear impedance:  forces = sign Z motions, Z a matrix.

    motions, forces: names of signals, one of each for a row of Z;  sign: as of `Attached`
    raises ModelError: another number of rows than of motions or forces
    """

    name: str
    body: MatrixImpedance
    motions: tuple[str, ...]
    forces: tuple[str, ...]
    sign: int = -1

    def __post_init__(self) -> None:
        check_name(self.name, where="block")
        _check_names(f"block {self.name}", *self.motions, *self.forces)
        if not len(self.motions) == len(self.forces) == self.body.size:
            raise ModelError(
                f"{self.name}: {self.body.size} rows, found {len(self.motions)} motions and "
                f"{len(self.forces)} forces"
            )

    @property
    def entries(self) -> tuple[tuple[int, int], ...]:
        """Rows and columns, from 0, of what is not zero."""
        indices = {tuple(name.split("_")[1:]) for name in self.body.parameters}
        return tuple(sorted((int(i) - 1, int(j) - 1) for i, j in indices))

    def entry_name(self, row: int, column: int) -> str:
        """Name of an entry as a separate block, such as "Z_H_1_2"; row and column from 0."""
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

    of: name of the system;  row, column: from 0;  entries: places of all that are blocks
    """

    of: str
    row: int
    column: int
    entries: tuple[tuple[int, int], ...]


@check_types
@dataclass(frozen=True)
class Control:
    """A controller:  output = controller(input), along the velocity of `motion`.

    motion: of a body, or a junction or kinematics of motions; blank: its law sees no velocity
    analog: realised by electronics that no computer samples
    entry: its place in a system of several inputs and outputs whose states it shares
    others: further signals that a law known as code alone reads
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
        _check_names(f"block {self.name}: others", *self.others)
        if self.others and not self.is_code:
            raise ModelError(f"{self.name}: others are for a law that is known as code alone")
        _check_names(f"block {self.name}", self.input, self.output)
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
        """Time (s) by which the block is late, where it is a delay and nothing else; else None."""
        return self.controller.dead_time if isinstance(self.controller, Controller) else None

    @property
    def is_code(self) -> bool:
        """Whether a stage of it is a nonlinear python-control system, known as code only."""
        stages = self.controller.stages if isinstance(self.controller, Controller) else ()
        return any(stage.law.system is not None for stage in stages)

    @property
    def is_measured(self) -> bool:
        """Whether a stage of it is a measured frequency response, known at its frequencies only."""
        stages = self.controller.stages if isinstance(self.controller, Controller) else ()
        return any(stage.law.response is not None for stage in stages)


@check_types
@dataclass(frozen=True)
class Junction:
    """A summing junction:  output = sum of weight * signal.

    A weight may depend on positions: torque = lever arm(angle) * force.
    """

    output: str
    terms: Mapping[str, Weight]

    def __post_init__(self) -> None:
        check_name(self.output, where="junction")
        _check_names(self.name, *self.terms)
        for signal, weight in self.terms.items():
            as_expression(weight, where=f"{self.name}: {signal}")
        _check_names(self.name, *self.arms)
        object.__setattr__(self, "terms", Frozen(self.terms))

    @property
    def name(self) -> str:
        return f"junction {self.output}"

    @property
    def outputs(self) -> tuple[str, ...]:
        return (self.output,)

    @property
    def arms(self) -> tuple[str, ...]:
        """Positions that the weights depend on."""
        return tuple(sorted({x for w in self.terms.values() for x in _names(w)}))

    @property
    def inputs(self) -> tuple[str, ...]:
        return (*self.terms, *(x for x in self.arms if x not in self.terms))


@check_types
@dataclass(frozen=True)
class Kinematics:
    """A position that others determine:  output = expression of positions (`position_symbol`).

    axis: of the output, "prismatic" or "revolute"
    """

    output: str
    expression: sp.Expr
    axis: str = "prismatic"

    def __post_init__(self) -> None:
        check_name(self.output, where="kinematics")
        as_expression(self.expression, where=self.name)
        _check_names(self.name, *self.inputs)

    @property
    def name(self) -> str:
        return f"kinematics {self.output}"

    @property
    def outputs(self) -> tuple[str, ...]:
        return (self.output,)

    @property
    def inputs(self) -> tuple[str, ...]:
        return _names(self.expression)


Block = Moving | Attached | Linked | Control
Part = Moving | Attached | Linked | Control | Junction | Kinematics


def _names(expression: Weight) -> tuple[str, ...]:
    return tuple(sorted(s.name for s in sp.sympify(expression, strict=True).free_symbols))
