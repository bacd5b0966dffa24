"""Hands and environments of a diagram: blocks that act at a port, and are no part of the device."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from ..controllers import make_exact
from ..diagrams import Attached, Diagram, Linked, Moving
from ..realise.tips import with_tips
from .shares import shares_of, total_share

#: difference of two weights, or lever arms in m, that is rounding
_ROUNDING = 1e-9


def holders(diagram: Diagram) -> dict[str, tuple[str, ...]]:
    """Hands and environments, each with the forces from outside in whose place it acts.

    A block counts if the diagram states that role, and if each of its forces acts as a force from
    outside does, along the motion that the block resists. Any other block is a part of the device,
    whatever its role or name.
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
            [f for f, loads in entering.items() if _acts_as(whole, force, motion, loads)]
            for force, motion in zip(part.outputs, part.inputs, strict=True)
        ]
        if all(places):
            at[part.name] = tuple(f for place in places for f in place)
    return at


def _loads_of(diagram: Diagram, force: str) -> dict[str, sp.Expr]:
    """Motion of each body on which a force acts -> its share, not 0."""
    shares = shares_of(diagram, force)
    moving = (b for b in diagram.blocks if isinstance(b, Moving))
    loads = {b.motion: total_share(b.loads, shares) for b in moving}
    return {motion: share for motion, share in loads.items() if share != 0}


def _acts_as(diagram: Diagram, force: str, motion: str, loads: Mapping[str, sp.Expr]) -> bool:
    """Whether a force acts on the bodies with these shares, and the motion moves by them."""
    if not diagram.is_position(motion):
        return False
    place = diagram.position(motion)
    slopes = {x.name: sp.diff(place, x) for x in place.free_symbols}
    return all(_is_along(made, loads) for made in (_loads_of(diagram, force), slopes))


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
