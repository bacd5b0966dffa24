"""Ports of a diagram, where forces from outside act on its bodies, and who holds them.

Force times velocity at a port is the power that flows in. So the velocity at a port is that of the
body on which its force acts, or a weighted sum of the velocities of several bodies on which the
force acts through lever arms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from graphlib import CycleError, TopologicalSorter

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix
from sympy.polys.matrices.exceptions import DMNonInvertibleMatrixError

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import Stage, exact_decimal, make_exact, parameter_symbol
from ..derive.linear_rows import SPEED, OfLaw, rows_of_law
from ..diagrams import Attached, Diagram, Linked, Moving, position_symbol
from ..effects import is_linear
from ..realise.lti import linear_blocks
from ..realise.simulated import without_absent
from ..realise.tips import with_tips
from .declarations import falsely_linear
from .linear.impedance import exact


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
    def motion(self) -> str | None:
        """Motion of the body if the port has one body with weight 1; else None.

        Only such a motion can be prescribed in a simulation.
        """
        (first, weight), *others = self.weights.items()
        return first if not others and weight == 1 else None

    def __str__(self) -> str:
        factors = {
            m: f"({w}) " if isinstance(w, sp.Expr) else "" if w == 1 else f"{w:.4g} "
            for m, w in self.weights.items()
        }
        parts = [f"{factor}{m}" for m, factor in factors.items()]
        return f"({self.force}, {' + '.join(parts).replace('+ -', '- ')})"


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
    moving = diagram.moving
    at_forces = []
    for force in dict.fromkeys(b.driver for b in moving if b.driver in diagram.outside):
        loads = _loads_of(diagram, force).items()
        if weights := {m: w if w.free_symbols else float(w) for m, w in loads}:
            at_forces.append(Port(force, weights))
    if not at_forces:
        raise ModelError(f"{diagram.name}: no force from outside drives a body: it has no port")
    return tuple(at_forces)


def nonlinear_parts(diagram: Diagram) -> tuple[str, ...]:
    """Names of the parts of a diagram that are not linear."""
    diagram = with_tips(diagram)
    names = list(linear_blocks(diagram).left_out)
    names += [c.name for c in diagram.controls if any(map(_varies_with_speed, c.stages))]
    names += falsely_linear(diagram)
    # a position that is a weighted sum of others has a Jacobian that does not change
    names += [
        k.name
        for k in diagram.kinematics
        if not is_linear([sp.sympify(k.expression)], [position_symbol(n) for n in k.inputs])
    ]
    return (*names, *(j.name for j in diagram.junctions if j.arms))


@lru_cache(maxsize=256)
def _varies_with_speed(stage: Stage) -> bool:
    """Whether a coefficient of a linear law is another one at another speed, at these values.

    In a transfer function at one constant speed such coefficients may cancel.
    """
    if not stage.law.linear:
        return False
    _, rates, output = rows_of_law(OfLaw(stage.law, stage))
    numbers = {
        parameter_symbol("law", f"law.{n}"): exact_decimal(x) for n, x in stage.values.items()
    }
    return any(c.xreplace(numbers).has(SPEED) for row in (*rates, output) for c in row)


def is_spanned(motion: str, standing: Sequence[Port]) -> bool:
    """Whether a motion of a body is certainly zero whenever the ports stand still.

    False also where a lever arm of a port changes with position.
    """
    if any(isinstance(w, sp.Expr) for port in standing for w in port.weights.values()):
        return False
    known = sorted({motion, *(m for port in standing for m in port.weights)})
    weights = np.array([[port.weights.get(m, 0.0) for m in known] for port in standing])
    row = np.array([float(m == motion) for m in known])
    rank = np.linalg.matrix_rank
    return bool(rank(np.vstack([weights, row])) == rank(weights))


Shares = Mapping[str, sp.Expr]


def shares_of(diagram: Diagram, signal: str) -> Shares:
    """Shares of `signal` in the other signals, through junctions; loops of sums are solved.

    returns: name of a signal -> its share, not 0. A share is an expression of positions where a
        lever arm is on the way
    raises ModelError: a loop of sums without a solution
    """
    sums = {
        j.output: {n: _weight(w) for n, w in j.terms.items()}
        for j in diagram.junctions
        if j.output != signal
    }
    try:
        order = TopologicalSorter({n: terms.keys() for n, terms in sums.items()}).static_order()
        shares = {signal: sp.S(1)}
        for name in order:
            if name in sums:
                shares[name] = total_share(sums[name], shares)
    except CycleError:
        shares = _solve_sums(diagram, sums, signal)
    return {name: share for name, share in shares.items() if share != 0}


def total_share(terms: Mapping[str, sp.Expr | float], shares: Shares) -> sp.Expr:
    """Share of one signal in a sum of weight * signal.

    terms: signal -> weight;  shares: of the one signal, from `shares_of`
    """
    return sp.expand(sp.Add(*(_weight(w) * shares.get(n, sp.S(0)) for n, w in terms.items())))


def drives_alone(diagram: Diagram, signal: str, body: Moving) -> bool:
    """Whether a force acts unchanged on that body, and on nothing else.

    An actuator of the body is not considered; the caller has to exclude one.
    """
    shares = shares_of(diagram, signal)
    forces = {name: sp.S(0) for name in (body.command, *body.loads)}
    forces |= {name: _weight(w) for name, w in body.loads.items()}
    forces[body.command] += 1
    return total_share(forces, shares) == 1 and not any(
        part is not body and any(name in shares for name in part.inputs)
        for part in (*diagram.blocks, *diagram.kinematics)
    )


def _weight(weight: sp.Expr | float) -> sp.Expr:
    expression = sp.sympify(weight, strict=True)
    return expression if expression.free_symbols else exact(weight)


def _solve_sums(
    diagram: Diagram, sums: Mapping[str, Mapping[str, sp.Expr]], signal: str
) -> dict[str, sp.Expr]:
    names = list(sums)
    system = sp.Matrix(
        [[int(row == n) - sums[row].get(n, sp.S(0)) for n in names] for row in names]
    )
    right = sp.Matrix([sums[row].get(signal, sp.S(0)) for row in names])
    whole = DomainMatrix.from_Matrix(system.row_join(right)).to_field()
    size = len(names)
    try:
        answers = whole[:, :size].lu_solve(whole[:, size:]).to_Matrix()
    except DMNonInvertibleMatrixError:
        raise ModelError(f"{diagram.name}: a loop of sums has no solution") from None
    return {signal: sp.S(1), **dict(zip(names, answers, strict=True))}


#: difference of two weights, or lever arms in m, that is rounding
_ROUNDING = 1e-9


def holders(diagram: Diagram) -> dict[str, tuple[str, ...]]:
    """Hands and environments, each with the forces from outside in whose place it acts.

    A block counts if the diagram states that role, and if each of its forces acts as a force from
    outside does, along the motion that the block resists, and is read as that force is. Any other
    block is a part of the device, whatever its role or name.
    """
    whole = with_tips(diagram)
    entering = {
        force: loads
        for force, quantity in whole.outside.items()
        if quantity == "force" and (loads := _loads_of(whole, force))
    }
    at: dict[str, tuple[str, ...]] = {}
    for part in whole.blocks:
        if not isinstance(part, Attached | Linked) or part.role == "part":
            continue
        places = [
            [f for f, loads in entering.items() if _acts_as(whole, force, motion, f, loads)]
            for force, motion in zip(part.outputs, part.inputs, strict=True)
        ]
        if all(places):
            at[part.name] = tuple(f for place in places for f in place)
    return at


def _loads_of(diagram: Diagram, force: str) -> dict[str, sp.Expr]:
    """Motion of each body on which a force acts -> its share, not 0."""
    shares = shares_of(diagram, force)
    moving = diagram.moving
    loads = {b.motion: total_share(b.loads, shares) for b in moving}
    return {motion: share for motion, share in loads.items() if share != 0}


def _acts_as(diagram: Diagram, force: str, motion: str, other: str, loads: Shares) -> bool:
    """Whether a force acts everywhere as the other does, and the motion moves by its loads."""
    if not diagram.is_position(motion):
        return False
    place = diagram.position(motion)
    slopes = {x.name: sp.diff(place, x) for x in place.free_symbols}
    one, like = (_loads_of(diagram, f) | _reads_of(diagram, f) for f in (force, other))
    return _is_along(slopes, loads) and _is_along(one, like)


def _reads_of(diagram: Diagram, force: str) -> dict[str, sp.Expr]:
    """Command of a body, or signal that a law reads -> its share of a force, not 0."""
    heard = {*(c.input for c in diagram.controls), *(b.command for b in diagram.moving)}
    return {name: x for name, x in shares_of(diagram, force).items() if name in heard}


def _is_along(made: Mapping[str, sp.Expr], loads: Mapping[str, sp.Expr]) -> bool:
    """Whether all shares are equal, or all are opposite, within rounding of their numbers."""

    def apart(sign: int, motion: str) -> bool:
        one, other = (share.get(motion, sp.S(0)) for share in (made, loads))
        rest = sp.expand(make_exact(one - sign * other))
        return bool(rest.free_symbols) or abs(float(rest)) > _ROUNDING

    return any(not any(apart(sign, m) for m in {*made, *loads}) for sign in (1, -1))


def without_holders(diagram: Diagram, force: str = "") -> Diagram:
    """The diagram without hands and environments; with `force`, without those at that port."""
    return diagram.without(*(n for n, at in holders(diagram).items() if not force or force in at))
