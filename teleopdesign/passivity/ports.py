"""Ports of a diagram, where forces from outside act on its bodies, and the impedance there.

Force times velocity at a port is the power that flows in. So the velocity at a port is that of the
body on which its force acts, or a weighted sum of the velocities of several bodies on which the
force acts through lever arms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import Controller
from ..diagrams import Diagram, Kinematics, Moving, position_symbol
from ..effects import is_linear
from ..realise.lti import S, linear_blocks
from ..realise.simulated import without_absent
from ..realise.tips import with_tips
from .declarations import falsely_linear
from .shares import shares_of, total_share


@dataclass(frozen=True)
class Port:
    """A port: a force from outside, and the motion along which the force acts.

    The motion is the sum of weight * motion of a body.

    force: name of the force
    weights: motion of a body -> weight; an expression for a lever arm that changes with position
    """

    force: str
    weights: Mapping[str, float | sp.Expr]

    @property
    def is_fixed(self) -> bool:
        """Whether no weight changes with position."""
        return not any(isinstance(w, sp.Expr) for w in self.weights.values())

    @property
    def motion(self) -> str | None:
        """Motion of the body if the port has one body with weight 1; else None.

        Only such a motion can be prescribed in a simulation.
        """
        (first, weight), *others = self.weights.items()
        return first if not others and weight == 1 else None

    def __str__(self) -> str:
        parts = [m if w == 1 else f"{_weight_text(w)} {m}" for m, w in self.weights.items()]
        return f"({self.force}, {' + '.join(parts).replace('+ -', '- ')})"


def _weight_text(weight: float | sp.Expr) -> str:
    return f"({weight})" if isinstance(weight, sp.Expr) else f"{weight:.4g}"


def drop_absent_effects(diagram: Diagram) -> Diagram:
    """The diagram without the effects whose values make them absent.

    raises ModelError: a block without values, or a remaining value that is infinite
    """
    for part in diagram.bodies:
        if isinstance(part.body, Body):
            diagram = diagram.with_block(part.name, without_absent(part.body))
    for name, value in diagram.values.items():
        if not math.isfinite(value):
            raise ModelError(f"{diagram.name}: {name} is {value}: a claim needs finite numbers")
    linear_blocks(diagram)
    return diagram


def ports(diagram: Diagram) -> tuple[Port, ...]:
    """The ports of a diagram, one for each force from outside that drives a body.

    returns: in the order of the bodies
    raises ModelError: no force from outside drives a body
    """
    diagram = with_tips(diagram)
    moving = [b for b in diagram.blocks if isinstance(b, Moving)]
    at_forces = []
    for force in dict.fromkeys(b.driver for b in moving if b.driver in diagram.outside):
        shares = shares_of(diagram, force)
        loads = {b.motion: total_share(b.loads, shares) for b in moving}
        if weights := {m: _plain_number(w) for m, w in loads.items() if w != 0}:
            at_forces.append(Port(force, weights))
    if not at_forces:
        raise ModelError(f"{diagram.name}: no force from outside drives a body: it has no port")
    return tuple(at_forces)


def _is_fixed(part: Kinematics) -> bool:
    """Whether a position is a weighted sum of others, so that the Jacobian does not change."""
    return is_linear([sp.sympify(part.expression)], [position_symbol(n) for n in part.inputs])


def _plain_number(weight: sp.Expr) -> float | sp.Expr:
    return weight if weight.free_symbols else float(weight)


def nonlinear_parts(diagram: Diagram) -> tuple[str, ...]:
    """Names of the parts of a diagram that are not linear."""
    diagram, speed = with_tips(diagram), sp.Symbol("speed", positive=True)
    names = list(linear_blocks(diagram).left_out)
    for part in diagram.controls:
        assert isinstance(part.controller, Controller)
        form = part.controller.linear_form(part.name, S, speed)
        if form is not None and form.has(speed):
            names.append(part.name)
    names += falsely_linear(diagram)
    names += [k.name for k in diagram.kinematics if not _is_fixed(k)]
    return (*names, *(j.name for j in diagram.junctions if j.arms))


def is_spanned(motion: str, standing: Sequence[Port]) -> bool:
    """Whether a motion of a body is certainly zero whenever the ports stand still.

    False also where a lever arm of a port changes with position.
    """
    if not all(port.is_fixed for port in standing):
        return False
    known = sorted({motion, *(m for port in standing for m in port.weights)})
    weights = np.array([[port.weights.get(m, 0.0) for m in known] for port in standing])
    row = np.array([float(m == motion) for m in known])
    rank = np.linalg.matrix_rank
    return bool(rank(np.vstack([weights, row])) == rank(weights))


def without_friction(diagram: Diagram, motion: str, *controllers: str) -> Diagram:
    """The diagram without these controllers, and with no friction on the body of that motion.

    raises ModelError: no body has that motion
    """
    diagram = diagram.without(*controllers)
    for part in diagram.blocks:
        if isinstance(part, Moving) and part.motion == motion and isinstance(part.body, Body):
            body = part.body
            for effect in reversed(body.effects):
                if effect.role.startswith("friction"):
                    body = body.without_effect(effect.name)
            moved = replace(part, body=body)
            blocks = tuple(moved if b is part else b for b in diagram.blocks)
            return replace(diagram, blocks=blocks)
    raise ModelError(f'{diagram.name}: no body moves by "{motion}"')
