"""Claims about every port of a diagram.

If the diagram is linear, the claims are exact. If only friction and its cancellation are nonlinear,
they follow from theorems. All other claims come from a search for motions that release energy.

Proofs hold for controllers in continuous time. The search uses the sampling that `computer` states.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown
from ..blocks import Body
from ..diagrams import Diagram
from ..effects import SIGNALS
from .claims.claim import Claim, Proof, Unknown
from .declarations import is_shipped
from .friction_pairs import FrictionPair, friction_pairs, pair_claims, proof_of, without_pair
from .linear_diagrams import WHOLE, linear_claims
from .ports import (
    Port,
    drop_absent_effects,
    is_spanned,
    nonlinear_parts,
    ports,
    without_holders,
)
from .search.by_simulation import Computer
from .theorems import Question, TopicClaim, settle
from .theorems.channels import wave_claim

#: last words of the topic of a claim that a search decides
SEARCHED = "search by simulation"


@check_types
@dataclass(frozen=True)
class Search:
    """Settings of the search for motions that release energy.

    stroke: largest position, m or rad;  speed: largest speed, m/s or rad/s
    tries: number of motions;  computer: sampling of the controllers, see `simulate`
    """

    stroke: float = 0.01
    speed: float = 0.1
    tries: int = 15
    computer: Computer = "continuous"


@dataclass(frozen=True, eq=False)
class DiagramClaims(Shown, ByValue):
    """Claims about the ports of a diagram, with their verdicts.

    ports: all ports;  nonlinear: names of the nonlinear parts
    """

    diagram: Diagram
    ports: tuple[Port, ...]
    nonlinear: tuple[str, ...]
    claims: tuple[TopicClaim, ...]


def diagram_claims(
    diagram: Diagram, *, rng: np.random.Generator | int = 0, search: Search | None = None
) -> DiagramClaims:
    """Claims about the ports of a diagram, with all other outside signals zero.

    Hands and environments that act at a port (their `role`) are left out of the judged diagram. The
    search moves one port and keeps the hand or environment at the other ports. It runs where no
    claim decides about all ports, and where `search` states a sampling for controllers.

    rng: draws the motions of the search, or the seed of the generator that draws them
    search: its settings
    raises ModelError: a block without values, or no port

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> loop = td.controller("gain", {"gain": 4.0})
        >>> claims = td.diagram_claims(td.haptic_interface(device, force_feedback=loop))
        >>> claims.claims[0].claim.status
        'proved'
    """
    search, rng = search or Search(), np.random.default_rng(rng)
    whole = drop_absent_effects(diagram)
    alone = without_holders(whole)
    all_ports, bent = ports(alone), nonlinear_parts(alone)
    claims: list[TopicClaim] = []
    sampled = search.computer != "continuous" and any(not c.analog for c in alone.controls)
    waves = wave_claims(alone)
    if waves:
        claims += waves
    elif not bent:
        claims += linear_claims(alone, all_ports)
    else:
        pairs = friction_pairs(alone)
        for pair in pairs:
            topic = f"friction of {pair.body.name}"
            claims += [replace(s, topic=topic) for s in settle(Question(pair.device))]
            claims += pair_claims(pair)
        if (composed := composed_claim(alone, all_ports, pairs)) is not None:
            claims.append(composed)
    if not any(not c.analog for c in alone.controls):  # nothing that a computer could sample
        claims = [replace(one, time="any") for one in claims]
    if sampled or not any(s.topic in WHOLE and s.claim.status != "unknown" for s in claims):
        claims += [_search_claim(whole, port, rng, search) for port in all_ports]
    return DiagramClaims(diagram, all_ports, bent, tuple(claims))


def wave_claims(diagram: Diagram) -> list[TopicClaim]:
    """The claim by the theorem about wave variables, if the diagram is wired by `wave_variables`.

    returns: the claim if it is proved; else empty
    """
    if not any(part.dead_time is not None for part in diagram.controls):
        return []  # without delays the linear tests decide either way
    try:
        claim = wave_claim(diagram)
    except ModelError:  # another wiring
        return []
    return [TopicClaim(WHOLE[2], claim)] if isinstance(claim.verdict, Proof) else []


def composed_claim(
    diagram: Diagram, all_ports: Sequence[Port], pairs: Sequence[FrictionPair]
) -> TopicClaim | None:
    """A proof from the parts of a diagram: its linear rest, and friction with its cancellation.

    Friction acts on a motion that the ports determine, in parallel with the forces of the ports. So
    the energies of the parts add, and passive parts make a passive diagram.

    pairs: of `friction_pairs`
    returns: None where the diagram has other parts, or where some part is not proved
    """
    rest, proofs = diagram, []
    for pair in pairs:
        proof = proof_of(pair_claims(pair, simulated=False))
        # no theorem about friction alone is called here
        is_open = proof is None if pair.cancellation else pair.device.presliding is not None
        if is_open or pair.device.set_aside or not pair.is_constant:
            return None
        if not is_spanned(pair.body.motion, all_ports):
            return None
        proofs += [proof.claim] if proof else []
        rest = without_pair(rest, pair)
        if proof is not None and proof.spends_damping:  # it leaves none to the linear rest
            if (spent := _without_damping(rest, pair.body.name)) is None:
                return None
            rest = spent
    if not pairs or nonlinear_parts(rest):
        return None
    if not all(rest.is_position(c.input) for c in rest.controls):
        return None  # what a controller makes of a force is no sum of parts
    linear = linear_claims(rest, all_ports)[0].claim
    if not isinstance(linear.verdict, Proof):
        return None
    parts = [linear, *proofs]
    names = ", ".join(map(str, all_ports))
    statement = f"{diagram.name}: no motion of {names} takes energy out"
    method = (
        "the energies of its parts, which add: its linear rest, and friction that takes at least "
        "what its cancellation gives"
    )
    certificates = tuple(c for claim in parts for c in claim.certificates)
    return TopicClaim(WHOLE[0], Claim(statement, Proof(method, certificates)))


def _without_damping(diagram: Diagram, name: str) -> Diagram | None:
    """The diagram with all damping of a body taken away; None where it has other than `viscous`."""
    (body,) = (part.body for part in diagram.moving if part.name == name)
    assert isinstance(body, Body)
    damping = [e for e in body.effects if e.expression().has(SIGNALS["velocity"])]
    if any(e.name != "viscous" or not is_shipped(e) for e in damping):
        return None
    for effect in damping:
        body = body.without_effect(effect.name)
    return diagram.with_block(name, body)


def _search_claim(
    whole: Diagram, port: Port, rng: np.random.Generator, search: Search
) -> TopicClaim:
    topic = f"port {port}, {SEARCHED}"
    statement = f"{whole.name}: the port {port} releases no energy"
    if port.motion is None:
        why = "its motion is no single body's, so that a simulation cannot prescribe it"
        return TopicClaim(topic, Claim(statement, Unknown(why)))
    free = without_holders(whole, port.force)
    if code := [c.name for c in free.controls if c.is_code]:
        why = f"{', '.join(code)} is known as code only, which a search would call a million times"
        return TopicClaim(topic, Claim(statement, Unknown(why)))
    if measured := [c.name for c in free.controls if c.is_measured]:
        why = (
            f"{', '.join(measured)} is a measured frequency response, known at some frequencies of "
            "the axis: a proof asks for all of them and for the right half plane, a search for time"
        )
        return TopicClaim(topic, Claim(statement, Unknown(why)))
    lengths = [x for pair in friction_pairs(free) for x in pair.question.lengths]
    shortest = min([search.stroke / 1000, *lengths])
    return TopicClaim.from_search(
        topic,
        statement,
        free,
        stroke=search.stroke,
        speed=search.speed,
        rng=rng,
        port=(port.motion, port.force),
        computer=search.computer,
        give=shortest / 100,
        tries=search.tries,
    )
