"""Effects that are one and the same at a cut of several blocks, whatever the records hold.

Where the command is not recorded, what acts on it in the computer and what acts on it in the
actuator are the same. Where the force of the hand is not recorded, device and hand move together,
so their forces only show as a sum.
"""

from __future__ import annotations

from ..diagrams import Control, Diagram, Junction, Moving
from ..effects import Effect
from .cuts import COMPUTER, Cut

#: effect of a body's actuation -> the effect of the computer that does the same to the command
_OF_COMMAND = {
    "actuator_gain": "gain",
    "actuation_delay": "delay",
    "actuator_lag": "lag",
    "actuator_saturation": "saturation",
    "actuator_dead_zone": "dead_zone",
    "bias": "bias",
}
#: roles of effects that a hand may have as well: those of a force between body and surroundings
OF_A_HAND = ("force", "friction_level", "friction_shape", "friction_factor")


def same_effects(diagram: Diagram, cut: Cut, effect: Effect) -> tuple[tuple[str, str], ...]:
    """(name, place) of effects at other places of a body's cut that no record tells from this one.

    effect: of the body that gives the cut its name
    """
    same = []
    if COMPUTER in cut.blocks and effect.name in _OF_COMMAND:
        name = _OF_COMMAND[effect.name]
        places = [COMPUTER]
        if name == "bias":
            places += [b for b in feeding(diagram, cut) if b in cut.blocks]
        same += [(name, at) for at in places]
    if effect.role in OF_A_HAND:
        others = [n for n in cut.blocks if n != cut.name and diagram.has(n)]
        bodies = [n for n in others if not isinstance(diagram.block(n), Control)]
        same += [(effect.name, at) for at in bodies]
    return tuple(same)


def feeding(diagram: Diagram, cut: Cut) -> list[str]:
    """Controllers whose outputs are terms of the command of a cut."""
    block = diagram.block(cut.name)
    assert isinstance(block, Moving)
    makers = {s: part for part in diagram.parts for s in part.outputs}
    command = makers.get(block.command)
    terms = command.terms if isinstance(command, Junction) else {}
    return [makers[s].name for s in terms if isinstance(makers.get(s), Control)]
