"""Claims about the ports of linear diagrams: exact, or with dead times numerical.

They start from all states of the diagram: a mode that no port shows from rest has to decay. A
refuted claim is also refuted at four nearby sets of values, so that it does not rest on rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from ..base.errors import ModelError
from ..derive.all_states import all_states
from ..derive.effort import bounded_effort
from ..diagrams import Diagram
from ..realise.lti import linear_blocks
from ..realise.tips import linear_tips
from .claims.claim import Claim, Unknown, use_units_of
from .declarations import falsely_linear
from .growing_mode import GrowingMode
from .linear.family import Family, family_at, family_of_states
from .linear.impedance import Impedance
from .linear.judge import NEARBY, passive_claim, stable_claim
from .ports import Port, nonlinear_parts, ports, without_holders
from .search.growing_wave import GrowingWave, wave_of
from .theorems import TopicClaim

#: topics of claims that are about all ports at once
WHOLE = ("all ports, any motion", "the port, any motion", "both ports, any motion")
_HELD = "both ports, whatever passive holds them"


def linear_claims(diagram: Diagram, all_ports: Sequence[Port]) -> list[TopicClaim]:
    """Claims of passivity of a linear diagram, and of absolute stability where it has two ports.

    A diagram that is not linear has one claim, which is unknown.

    diagram: with values;  all_ports: its ports, see `ports`
    """
    if bent := nonlinear_parts(diagram):
        return _open(diagram, f"not linear: {', '.join(bent)}")
    with bounded_effort():
        return _judge(diagram, all_ports)


def _judge(diagram: Diagram, all_ports: Sequence[Port]) -> list[TopicClaim]:
    try:
        family = family_at(diagram, all_ports)
    except ModelError as problem:
        return _open(diagram, str(problem))
    judges = {WHOLE[1 if family.size == 1 else 2 if family.size == 2 else 0]: passive_claim}
    judges |= {_HELD: stable_claim} if family.size == 2 else {}
    claims = [TopicClaim(topic, judge(family)) for topic, judge in judges.items()]
    if any(one.claim.status == "refuted" for one in claims):
        others = [_family_if_any(other, all_ports) for other in _nearby(diagram)]
        claims = [replace(c, claim=_confirm(c.claim, others, judges[c.topic])) for c in claims]
    motions = {motion.removesuffix("_tip") for port in all_ports for motion in port.weights}
    axes = {getattr(b.body, "axis", "") for b in diagram.bodies if b.motion in motions}
    axis = axes.pop() if len(axes) == 1 else "prismatic"  # which all bodies at the ports share
    return [replace(one, claim=use_units_of(axis, one.claim)) for one in claims]


def _open(diagram: Diagram, why: str) -> list[TopicClaim]:
    return [TopicClaim(WHOLE[0], Claim(f"{diagram.name}: its ports are passive", Unknown(why)))]


def _family_if_any(diagram: Diagram, all_ports: Sequence[Port]) -> Family | None:
    try:
        return family_at(diagram, all_ports)
    except ModelError:
        return None


def _confirm(
    claim: Claim, others: Sequence[Family | None], judge: Callable[[Family], Claim]
) -> Claim:
    """The claim; unknown where it is refuted, and not by all of the other forms."""
    if claim.status != "refuted" or all(
        other and (_moves(claim, other) or judge(other).status == "refuted") for other in others
    ):
        return claim
    why = f"it fails, but a relative change of its values by {NEARBY:.1g} decides: rounding"
    return Claim(claim.statement, Unknown(why))


def _moves(claim: Claim, family: Family) -> bool:
    """Whether the motion that refutes a claim also refutes it for another impedance."""
    record = claim.record
    if isinstance(record, GrowingWave) and len(record.velocity) == family.size:
        wave = wave_of(family.z, record.rate, record.frequency)
        return wave is not None and wave.energy > 0
    return isinstance(record, GrowingMode) and replace(record, impedance=family.z).is_confirmed()


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


def hand_port(diagram: Diagram, *, speed: float = 0.0) -> tuple[Impedance, tuple[str, ...]]:
    """Impedance at the hand (N s/m), and the names of parts without a linear form.

    With R_D = 0 the force of the hand on the device is Zhat_M L; with a compliant transmission the
    motion is that of the tip. Modes that the hand does not feel are its `unseen`.

    The names include parts that are declared linear and are not; their form in Z has no meaning.

    diagram: a haptic interface without position loop
    speed: m/s, at which smoothed friction and schedules are linearised. A claim about the impedance
        is then about this linear system only
    raises ModelError: a block without values, or with a dead time
    """
    alone = without_holders(diagram)
    family = family_of_states(all_states(alone, speed=speed), ports(alone))
    if family.size > 1 or family.times:
        raise ModelError(f"{diagram.name}: expected one port without dead times")
    z = replace(family.impedance, unseen=family.undecayed if family.hides else ())
    apart = linear_tips(diagram)
    return z, (*linear_blocks(apart, speed=speed).left_out, *falsely_linear(apart))
