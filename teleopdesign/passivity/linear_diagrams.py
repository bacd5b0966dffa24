"""Claims about the ports of linear diagrams: exact, or with dead times numerical.

A refuted claim is also refuted at four nearby sets of values, so that the refutation does not rest
on the rounding of a number. A proof includes that no internal mode grows by itself, not even a mode
that no port shows from rest. Evidence includes this as far as it can be checked with dead times.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from ..base.errors import ModelError
from ..diagrams import Diagram
from .claims.axis_units import use_units_of
from .claims.claim import Claim, Unknown
from .linear.family import explain_unseen, family_at
from .linear.positive_real import NEARBY, positive_real
from .ports import Port, impedance_matrix, nonlinear_parts
from .search.growing_wave import GrowingWave, wave_of
from .theorems import TopicClaim
from .two_port.claims import absolutely_stable, is_shown_unstable, passive
from .two_port.late_one_port import late_one_port
from .two_port.several_ports import passive_together
from .two_port.two_port import two_port

#: topics of claims that are about all ports at once
WHOLE = ("all ports, any motion", "the port, any motion", "both ports, any motion")


def linear_claims(diagram: Diagram, all_ports: Sequence[Port]) -> list[TopicClaim]:
    """Claims of passivity of a linear diagram, and of absolute stability where it has two ports.

    A refuted claim is also refuted at four nearby sets of values, so it does not rest on rounding.
    A proof includes that no internal mode grows by itself. A diagram that is not linear has one
    claim, which is unknown.

    diagram: with values;  all_ports: its ports, see `ports`
    """
    if bent := nonlinear_parts(diagram):
        statement = f"{diagram.name}: its ports are passive"
        return [TopicClaim(WHOLE[0], Claim(statement, Unknown(f"not linear: {', '.join(bent)}")))]
    claims = _linear_claims(diagram, all_ports)
    if any(one.claim.holds for one in claims):
        claims = _restate_beside_modes(claims, diagram, all_ports)
    if not any(one.claim.status == "refuted" for one in claims):
        return claims
    for other in _nearby(diagram):
        claims = _refuted_there_too(claims, other, all_ports)
    return claims


def _refuted_there_too(
    claims: list[TopicClaim], other: Diagram, all_ports: Sequence[Port]
) -> list[TopicClaim]:
    """The claims, with each refutation dropped that does not also hold at the values of `other`."""
    if not any(one.claim.status == "refuted" for one in claims):
        return claims
    try:
        z = impedance_matrix(other, all_ports)
    except ModelError:
        return [_restate_on_rounding(one) for one in claims]
    return [one if _fails(one, z) else _restate_on_rounding(one) for one in claims]


def _fails(one: TopicClaim, z: sp.Matrix) -> bool:
    if one.claim.status != "refuted":
        return True
    record = one.claim.record
    if isinstance(record, GrowingWave) and record.impedance.shape == z.shape:
        wave = wave_of(sp.ImmutableMatrix(z), record.rate, record.frequency)
        if wave is not None and wave.energy > 0:
            return True
        if z.rows == 2:
            return passive(two_port(z.tolist())).status == "refuted"
    if z.rows > 2:
        return passive_together(z).status == "refuted"
    if z.rows == 1:
        judge = late_one_port if z.has(sp.exp) else positive_real
        return judge(z[0, 0]).status == "refuted"
    return is_shown_unstable(two_port(z.tolist()))


def _restate_beside_modes(
    claims: list[TopicClaim], diagram: Diagram, all_ports: Sequence[Port]
) -> list[TopicClaim]:
    """The claims that hold become unknown where a mode that no port shows is not shown to decay."""
    try:
        modes = family_at(diagram, all_ports).undecayed()
    except ModelError as problem:
        why = str(problem)
    else:
        if not modes:
            return claims
        why = explain_unseen(modes)
    return [
        replace(one, claim=Claim(one.claim.statement, Unknown(why))) if one.claim.holds else one
        for one in claims
    ]


def _nearby(diagram: Diagram) -> list[Diagram]:
    """Four copies of the diagram, each value changed up or down by the relative amount NEARBY."""
    values = diagram.values
    return [
        diagram.with_values(
            {
                name: value * (1 + side * (-1) ** (k >> bit) * NEARBY)
                for k, (name, value) in enumerate(values.items())
            }
        )
        for bit in range(2)
        for side in (1, -1)
    ]


def _restate_on_rounding(one: TopicClaim) -> TopicClaim:
    if one.claim.status != "refuted":
        return one
    why = f"it fails, but a relative change of its values by {NEARBY:.1g} decides: rounding"
    return replace(one, claim=Claim(one.claim.statement, Unknown(why)))


def _linear_claims(diagram: Diagram, all_ports: Sequence[Port]) -> list[TopicClaim]:
    try:
        z = impedance_matrix(diagram, all_ports)
        if len(all_ports) == 1:
            judge = late_one_port if z.has(sp.exp) else positive_real
            claim = use_units_of(_axis(diagram, all_ports), judge(z[0, 0]))
            return [TopicClaim(WHOLE[1], claim)]
    except ModelError as problem:
        claim = Claim(f"{diagram.name}: its ports are passive", Unknown(str(problem)))
        return [TopicClaim(WHOLE[0], claim)]
    axis = _axis(diagram, all_ports)
    if len(all_ports) > 2:
        return [TopicClaim(WHOLE[0], use_units_of(axis, passive_together(z)))]
    system = two_port(z.tolist())
    return [
        TopicClaim(WHOLE[2], use_units_of(axis, passive(system))),
        TopicClaim(
            "both ports, whatever passive holds them",
            use_units_of(axis, absolutely_stable(system)),
        ),
    ]


def _axis(diagram: Diagram, all_ports: Sequence[Port]) -> str:
    """The axis that all bodies at the ports share; "prismatic" where they differ."""
    motions = {motion.removesuffix("_tip") for port in all_ports for motion in port.weights}
    axes = {getattr(b.body, "axis", "") for b in diagram.bodies if b.motion in motions}
    return axes.pop() if len(axes) == 1 else "prismatic"
