"""A diagram: named blocks, wired by the names of their signals; data, no computation.

All uses (symbolic transfer functions, LTI systems, interconnected python-control system, compiled
simulation) follow from this one wiring.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError, check_name, did_you_mean, unknown
from ..base.frozen import Frozen
from ..base.shown import html_table
from ..base.units import QUANTITIES
from ..blocks import Body, MatrixImpedance
from ..controllers import Controller
from .junctions import Junction, Kinematics, Weight, position_symbol
from .parts import (
    AnyBlock,
    Attached,
    Block,
    Control,
    Linked,
    Moving,
    Part,
    list_laws,
    write_equation,
)
from .units import require_one_axis


@check_types
@dataclass(frozen=True, repr=False)
class Diagram:
    """Blocks and junctions wired by signal names.

    outside: signals from outside, name -> quantity
    measured: signals from the sensors to the computer; signals of sampled controllers follow from
        them
    texts: meaning of each signal, with its sign
    kinematics: positions computed from those of bodies
    pose: position of each motion (default 0) at which weights and kinematics are linearised
    raises ModelError: a signal that nothing makes, or that two parts make
    """

    name: str
    blocks: tuple[Block, ...]
    junctions: tuple[Junction, ...]
    outside: Mapping[str, str]
    measured: tuple[str, ...]
    texts: Mapping[str, str] = field(default_factory=dict)
    kinematics: tuple[Kinematics, ...] = ()
    pose: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for where in ("outside", "measured", "texts", "pose"):
            for name in getattr(self, where):
                check_name(name, where=f"{self.name}: {where}")
        for signal, quantity in self.outside.items():
            if quantity not in QUANTITIES:
                raise ModelError(
                    f'{self.name}: outside["{signal}"]: no quantity "{quantity}"'
                    f"{did_you_mean(quantity, QUANTITIES)}; expected force (a torque too), "
                    "position (an angle too), velocity, acceleration or dimensionless"
                )
        made: dict[str, str] = dict.fromkeys(self.outside, "outside")
        names = [b.name for b in self.blocks]
        if doubled := {n for n in names if names.count(n) > 1}:
            raise ModelError(f'{self.name}: block "{min(doubled)}" is there twice')
        for part in self.parts:
            for signal in part.outputs:
                if signal in made:
                    raise ModelError(
                        f'{self.name}: signal "{signal}" is made by {part.name} and {made[signal]}'
                    )
                made[signal] = part.name
        needed = [(p.name, s) for p in self.parts for s in p.inputs]
        needed += [("measured", s) for s in self.measured]
        needed += [(f"{b.name}: driver", b.driver) for b in self.moving]
        for where, signal in needed:
            if signal not in made:
                raise ModelError(
                    f'{self.name}: {where}: nothing makes signal "{signal}"'
                    f"{did_you_mean(signal, made)}"
                )
        require_one_axis(self.name, self.blocks, self.kinematics, self.junctions)
        for name in ("outside", "texts", "pose"):
            object.__setattr__(self, name, Frozen(getattr(self, name)))

    @property
    def parts(self) -> tuple[Part, ...]:
        """Blocks, kinematics and junctions."""
        return (*self.blocks, *self.kinematics, *self.junctions)

    @check_types
    def position(self, name: str) -> sp.Expr:
        """A motion, or a junction or kinematics of motions, as a function of the bodies' positions.

        raises ModelError: the signal is no position that bodies determine
        """
        expression = self._position(name)
        if expression is None:
            raise ModelError(
                f'{self.name}: "{name}" is no motion: expected that of a body or a sum of such'
            )
        return expression

    def is_position(self, name: str) -> bool:
        """Whether bodies determine the signal: a motion, or a junction or kinematics of motions."""
        return self._position(name) is not None

    def _position(self, name: str, visited: tuple[str, ...] = ()) -> sp.Expr | None:
        if any(b.motion == name for b in self.moving):
            return position_symbol(name)
        makers: tuple[Junction | Kinematics, ...] = (*self.kinematics, *self.junctions)
        maker = next((p for p in makers if p.output == name), None)
        if maker is None or name in visited:
            return None
        parts = {s: self._position(s, (*visited, name)) for s in maker.inputs}
        if any(p is None for p in parts.values()):
            return None
        if isinstance(maker, Kinematics):
            whole = maker.expression
        else:
            whole = sp.Add(*(w * position_symbol(s) for s, w in maker.terms.items()))
        placed = {position_symbol(s): p for s, p in parts.items()}
        return sp.sympify(whole, strict=True).xreplace(placed)

    def here(self, weight: Weight) -> sp.Expr:
        """A weight (or a derivative of kinematics) at the pose of the diagram."""
        expression = sp.sympify(weight, strict=True)
        pose = {
            s: self.position(s.name).subs(
                {x: self.pose.get(x.name, 0.0) for x in self.position(s.name).free_symbols}
            )
            for s in expression.free_symbols
        }
        return expression.subs(pose)

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of all signals, those from outside first."""
        return (*self.outside, *(s for part in self.parts for s in part.outputs))

    @property
    def bodies(self) -> tuple[Moving | Attached, ...]:
        return tuple(b for b in self.blocks if isinstance(b, Moving | Attached))

    @property
    def moving(self) -> tuple[Moving, ...]:
        return tuple(b for b in self.blocks if isinstance(b, Moving))

    @property
    def controls(self) -> tuple[Control, ...]:
        return tuple(b for b in self.blocks if isinstance(b, Control))

    @check_types
    def block(self, name: str) -> Block:
        """The block of that name; raises ModelError with the nearest name: no such block."""
        for block in self.blocks:
            if block.name == name:
                return block
        names = [b.name for b in self.blocks]
        raise ModelError(f"{self.name}: {unknown('block', name, names)}")

    def has(self, name: str) -> bool:
        """Whether the diagram has a block of that name."""
        return any(b.name == name for b in self.blocks)

    @check_types
    def signal(self, name: str) -> str:
        """The name itself; raises ModelError with the nearest name: no such signal."""
        if name not in self.signals:
            raise ModelError(f"{self.name}: {unknown('signal', name, self.signals)}")
        return name

    def without(self, *names: str) -> Diagram:
        """The diagram without these blocks; their outputs are zero. Unknown names are ignored."""
        gone = {s for n in names if self.has(n) for s in self.block(n).outputs}
        junctions = tuple(
            replace(j, terms={s: g for s, g in j.terms.items() if s not in gone})
            for j in self.junctions
        )
        kept = tuple(
            replace(b, loads={s: g for s, g in b.loads.items() if s not in gone})
            if isinstance(b, Moving)
            else b
            for b in self.blocks
            if b.name not in names
        )
        wanted = [
            b.command if isinstance(b, Moving) else b.input
            for b in kept
            if isinstance(b, Moving | Control)
        ]
        nothing = tuple(Junction(s, {}) for s in dict.fromkeys(wanted) if s in gone)
        return replace(
            self,
            blocks=kept,
            junctions=(*junctions, *nothing),
            measured=tuple(s for s in self.measured if s not in gone),
        )

    def open_at(self, *names: str) -> Diagram:
        """The diagram with its loops open at these controllers, whose outputs come from outside.

        Signals that only these controllers used are left out. Unknown names are ignored.
        """
        free = {s: "force" for n in names if self.has(n) for s in self.block(n).outputs}
        kept = tuple(b for b in self.blocks if b.name not in names)
        return _prune(replace(self, blocks=kept, outside={**self.outside, **free}))

    @check_types
    def with_block(self, name: str, block: Body | MatrixImpedance | Controller) -> Diagram:
        """The diagram with another body or controller in place of the named block.

        raises ModelError: no such block, or content of another kind
        """
        old = self.block(name)
        if isinstance(old, Control):
            if not isinstance(block, Controller):
                raise ModelError(f"{self.name}: {name} is a controller, found a body")
            new: Block = replace(old, controller=block)
        elif isinstance(old, Linked):
            if not isinstance(block, MatrixImpedance):
                raise ModelError(f"{self.name}: {name} is a matrix of impedances")
            new = replace(old, body=block)
        else:
            if not isinstance(block, Body):
                raise ModelError(f"{self.name}: {name} is a body, found a controller")
            new = replace(old, body=block)
        return replace(self, blocks=tuple(new if b is old else b for b in self.blocks))

    @property
    def values(self) -> dict[str, float]:
        """Every parameter as "block.law.parameter", such as "Z_M.coulomb.level" -> value (SI)."""
        values: dict[str, float] = {}
        for block in self.blocks:
            if isinstance(block, Control):
                if isinstance(block.controller, Controller):
                    values |= {f"{block.name}.{n}": v for n, v in block.controller.names().items()}
            elif isinstance(block.body, Body):
                values |= {f"{block.name}.{n}": v.value for n, v in block.body.parameters.items()}
            elif isinstance(block.body, MatrixImpedance):
                values |= {f"{block.name}.{n}": v for n, v in block.body.parameters.items()}
        return values

    @check_types
    def with_values(self, values: Mapping[str, float]) -> Diagram:
        """The diagram with other parameter values (SI), by the names of `Diagram.values`.

        raises ModelError: no parameter of that name, with the nearest one
        """
        known, diagram = self.values, self
        for name in values:
            if name not in known:
                raise ModelError(f'{self.name}: no parameter "{name}"{did_you_mean(name, known)}')
        for block in self.blocks:
            start = f"{block.name}."
            of_block = {n.removeprefix(start): v for n, v in values.items() if n.startswith(start)}
            part = block.controller if isinstance(block, Control) else block.body
            if of_block and not isinstance(part, AnyBlock):
                diagram = diagram.with_block(block.name, part.with_values(of_block))
        return diagram

    def _repr_html_(self) -> str:
        rows = [(part.name, write_equation(part), list_laws(part)) for part in self.parts]
        note = f"from outside: {', '.join(self.outside)}"
        return html_table(f"Diagram {self.name}", ("part", "equation", "content"), rows, note=note)

    def __repr__(self) -> str:
        lines = [f"Diagram {self.name}"]
        for part in self.parts:
            lines.append(f"  {write_equation(part)}")
        lines.append(f"  from outside: {', '.join(self.outside)}")
        return "\n".join(lines)


def _prune(diagram: Diagram) -> Diagram:
    """The diagram without outside signals that no part uses; forces are kept."""
    used = {s for part in diagram.parts for s in part.inputs} | set(diagram.measured)
    # forces stay: what drives a motion that is prescribed is no input of its body
    outside = {s: q for s, q in diagram.outside.items() if s in used or q == "force"}
    return replace(diagram, outside=outside)


def acts_along_another(diagram: Diagram, part: Control) -> bool:
    """Whether the law uses the velocity of a motion that is not its input.

    Its linear form then has two transfer functions: from the input, and from that motion.
    """
    if not part.motion or part.input == part.motion:
        return False
    if not isinstance(part.controller, Controller) or not part.controller.sees_velocity:
        return False
    if not (diagram.is_position(part.input) and diagram.is_position(part.motion)):
        return True
    apart = diagram.position(part.input) - diagram.position(part.motion)
    return bool(sp.expand(apart) != 0)


def without_motion(where: str) -> ModelError:
    """The error for a law that uses a velocity when no motion is wired to it."""
    return ModelError(
        f'{where}: its law sees a velocity, and no motion is wired: motion="X" says along which'
    )
