"""Bodies as they are simulated: absent effects left out, ideal friction given a small give."""

from __future__ import annotations

from ..blocks import Body
from ..controllers import Controller
from ..diagrams import Control, Diagram
from ..effects import EFFECTS, SIGNALS
from ..errors import ModelError


def without_absent(body: Body) -> Body:
    """The body without the effects that are absent at their values, and what needs those."""
    values = body.parameters
    gone = {
        e.name
        for e in body.effects
        if e.absent and all(values[f"{e.name}.{n}"].value == v for n, v in e.absent.items())
    }
    levels = {e.name for e in body.effects if e.role == "friction_level"}
    if levels <= gone:
        gone |= {e.name for e in body.effects if e.role == "friction_shape"}
    needed = {n for e in body.effects if e.name not in gone for n in e.needs}
    for name in gone - needed:
        body = body.without_effect(name)
    return body


def with_give(body: Body, give: float) -> Body:
    """Ideal Coulomb friction realised by a bristle that gives by `give` before it slides."""
    roles = {e.role for e in body.effects}
    if "friction_level" not in roles or "friction_shape" in roles:
        return body
    at_rest = dict.fromkeys(SIGNALS.values(), 0) | dict.fromkeys(body.equation().rates, 0)
    level = float(body.equation().level.subs(at_rest).subs(body.numbers()))
    return body.with_effect(EFFECTS["presliding"], {"stiffness": level / give})


def simulated(diagram: Diagram, give: float) -> Diagram:
    """The diagram with bodies as they are simulated: absent effects out, ideal friction given."""
    for part in diagram.blocks:
        found = part.controller if isinstance(part, Control) else part.body
        if not isinstance(found, Body | Controller):
            raise ModelError(f"{diagram.name}: {part.name} is known by its name only, no equations")
        if isinstance(found, Body):
            diagram = diagram.with_block(part.name, with_give(without_absent(found), give))
    return diagram
