"""Friction of the bodies of a diagram beside the controllers that cancel it, with exact values."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..blocks import Body, Value
from ..controllers import Controller, Stage
from ..diagrams import Control, Diagram, Moving
from ..errors import ModelError
from .claims.claim import Claim, Unknown
from .device_claims import about_device, dahl_claim
from .identified import IdentifiedDevice, identified
from .theorems.friction_compensation import bounded_compensation

#: laws whose force is never more than their `level`, whatever the motion
BOUNDED = ("coulomb", "dahl", "smoothed_coulomb")


@dataclass(frozen=True)
class FrictionPair:
    """A body with friction, and the one controller that cancels it (None: none does)."""

    body: Moving
    cancellation: Control | None
    device: IdentifiedDevice

    @property
    def law(self) -> str:
        """Name of the law that cancels; "" where none does."""
        return self._stage.law.name if self.cancellation else ""

    @property
    def values(self) -> dict[str, float]:
        """Parameters of that law (SI)."""
        return dict(self._stage.values) if self.cancellation else {}

    @property
    def _stage(self) -> Stage:
        assert self.cancellation and isinstance(self.cancellation.controller, Controller)
        return self.cancellation.controller.stages[0]

    @property
    def is_constant(self) -> bool:
        """Whether the friction level is one number, whatever the motion."""
        assert isinstance(self.body.body, Body)
        parameters = set(self.body.body.symbols().values())
        return not self.body.body.level().free_symbols - parameters

    @property
    def lengths(self) -> list[float]:
        """Travels over which friction and its cancellation build up, m or rad."""
        found = []
        if self.device.presliding is not None:
            found.append(self.device.lowest.estimate / self.device.presliding.estimate)
        if "stiffness" in self.values:
            found.append(self.values["level"] / self.values["stiffness"])
        return found


def friction_pairs(diagram: Diagram) -> list[FrictionPair]:
    """One for each body with friction whose cancellation, if any, is a law with a known bound.

    A cancellation takes the body's own motion and adds to its command alone. A level that reaches
    down to nothing leaves nothing to cancel.
    """
    found = []
    for part in diagram.blocks:
        if not isinstance(part, Moving) or not isinstance(part.body, Body):
            continue
        if part.body.level() == 0:
            continue
        along = [c for c in diagram.controls if c.input == c.motion == part.motion]
        if len(along) > 1 or not all(_is_bounded(c, part, diagram) for c in along):
            continue
        try:
            device = identified(_exact(part.body))
        except ModelError:
            continue
        found.append(FrictionPair(part, along[0] if along else None, device))
    return found


def _is_bounded(control: Control, part: Moving, diagram: Diagram) -> bool:
    law = control.controller
    if not isinstance(law, Controller) or len(law.stages) != 1:
        return False
    made = {j.output: j.terms for j in diagram.junctions}
    adds = control.output == part.command or made.get(part.command, {}).get(control.output) == 1
    users = [p.name for p in diagram.parts if control.output in p.inputs]
    known = law.stages[0].law.name in BOUNDED
    acts = not any(e.role == "actuation" for e in getattr(part.body, "effects", ()))
    return known and adds and len(users) == 1 and acts


def _exact(body: Body) -> Body:
    """The body with values that are known exactly."""
    values = {n: replace(v, fixed=True, stderr=0.0) for n, v in body.parameters.items()}
    return body.with_values(dict[str, float | Value](values))


def pair_claims(pair: FrictionPair) -> list[Claim]:
    """Claims about friction with its cancellation, the same as for a diagnosed device."""
    device, values = pair.device, pair.values
    if pair.cancellation is None:
        return []
    found = []
    ideal = device.presliding is None
    if ideal:
        found.append(bounded_compensation(coulomb_level=device.lowest.low, bound=values["level"]))
    if pair.law == "dahl":
        found.append(dahl_claim(device, values["level"], values["stiffness"]))
    elif not ideal:
        statement = (
            f"friction of {pair.body.name} with {pair.cancellation.name} ({pair.law}) is passive"
        )
        why = "no limit is known for such a law on a contact that gives before it slides"
        found.append(Claim(statement, Unknown(why)))
    return [about_device(device, claim) for claim in found]
