"""Friction of a body, and the controller that cancels it: what theorems say of the pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..base.errors import ModelError
from ..blocks import Body, Value
from ..controllers import Controller, Stage
from ..diagrams import Control, Diagram, Moving
from .claims.claim import Claim, Proof, Unknown
from .identified import IdentifiedDevice, identify_device, restate_for_device
from .ports import drives_alone, nonlinear_parts, ports
from .theorems import Question, TopicClaim, settle


@dataclass(frozen=True)
class FrictionPair:
    """A body with friction, and the one controller that cancels this friction.

    cancellation: None where no controller cancels;  device: bounds of the friction
    """

    body: Moving
    cancellation: Control | None
    device: IdentifiedDevice

    @property
    def stage(self) -> Stage | None:
        """The law that cancels friction, with its values; None where no controller does."""
        if self.cancellation is None:
            return None
        assert isinstance(self.cancellation.controller, Controller)
        return self.cancellation.controller.stages[0]

    @property
    def question(self) -> Question:
        """The question for the theorems.

        Values are exact, so estimates and intervals are the same, and only intervals are asked.
        """
        return Question(self.device, self.stage, estimates=False)

    @property
    def is_constant(self) -> bool:
        """Whether the friction level does not depend on the motion."""
        assert isinstance(self.body.body, Body)
        parameters = set(self.body.body.symbols().values())
        return not self.body.body.level().free_symbols - parameters


def friction_pairs(diagram: Diagram) -> list[FrictionPair]:
    """A pair for each body with friction whose cancellation, if any, acts on it alone.

    A cancellation is a controller whose input is the motion of the body, and whose force acts
    unchanged on this body and on nothing else. A body whose friction level may be zero has no pair.
    """
    pairs = []
    for part in diagram.moving:
        if not isinstance(part.body, Body) or part.body.level() == 0:
            continue
        along = [c for c in diagram.controls if c.input == c.motion == part.motion]
        if len(along) > 1 or not all(_acts_alone(c, part, diagram) for c in along):
            continue
        try:
            # exact values have no standard errors
            values = {
                n: replace(v, fixed=True, stderr=0.0) for n, v in part.body.parameters.items()
            }
            device = identify_device(part.body.with_values(dict[str, float | Value](values)))
        except ModelError:
            continue
        pairs.append(FrictionPair(part, along[0] if along else None, device))
    return pairs


def _acts_alone(control: Control, part: Moving, diagram: Diagram) -> bool:
    if len(control.stages) != 1:
        return False
    acts = not any(e.role == "actuation" for e in getattr(part.body, "effects", ()))
    return acts and drives_alone(diagram, control.output, part)


def without_pair(diagram: Diagram, pair: FrictionPair) -> Diagram:
    """The diagram without the friction of a pair and its cancellation."""
    body = pair.body.body
    assert isinstance(body, Body)
    for effect in reversed(body.effects):
        if effect.role.startswith("friction"):
            body = body.without_effect(effect.name)
    gone = [pair.cancellation.name] if pair.cancellation else []
    return diagram.without(*gone).with_block(pair.body.name, body)


def pair_claims(pair: FrictionPair, *, simulated: bool = True) -> list[TopicClaim]:
    """Claims about friction with its cancellation, by the theorems for a diagnosed device.

    simulated: whether simulations replay the motions of refutations
    returns: empty where no controller cancels the friction; one unknown claim where no theorem
        applies
    """
    if pair.stage is None or pair.cancellation is None:
        return []
    topic = f"friction of {pair.body.name} with {pair.cancellation.name}"
    claims = settle(pair.question, simulated=simulated)
    # another law of the same bound may refute what holds for any law, which says nothing of this
    if of_law := [one for one in claims if not one.of_any_law or one.claim.status != "refuted"]:
        return [replace(one, topic=topic) for one in of_law]
    law = f"{pair.cancellation.name} ({pair.stage.law.name})"
    statement = f"friction of {pair.body.name} with {law} is passive"
    why = pair.question.law.missing or (
        "another law of this bound takes energy out, and no theorem is about this one"
        if claims
        else "no limit is known for such a law on a contact that gives before it slides"
    )
    return [TopicClaim(topic, restate_for_device(pair.device, Claim(statement, Unknown(why))))]


def proof_of(claims: Sequence[TopicClaim]) -> TopicClaim | None:
    """The claim that proves a pair passive, one that spends no damping if there is one; or None."""
    shown = [one for one in claims if isinstance(one.claim.verdict, Proof)]
    return min(shown, key=lambda one: one.spends_damping, default=None)


def refuting(diagram: Diagram, pairs: Sequence[FrictionPair]) -> list[Claim]:
    """Claims about pairs whose refuting motions take energy out of the ports of the diagram.

    A port moves slowly, and the others stand still. So every friction must act at a port and have a
    constant level, and the rest must be linear. A law of velocity is refuted at some speed: there
    nothing else may damp.
    """
    rest, moved = diagram, [port.motion for port in ports(diagram)]
    for pair in pairs:
        if pair.body.motion not in moved or not pair.is_constant:
            return []
        rest = without_pair(rest, pair)
    if nonlinear_parts(rest):
        return []
    claims = [one for pair in pairs for one in pair_claims(pair, simulated=False)]
    alone = len(diagram.blocks) <= 2
    return [one.claim for one in claims if one.refutes and (alone or not one.spends_damping)]
