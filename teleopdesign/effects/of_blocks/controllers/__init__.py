"""Effects of a controller block and of the whole computer: one file each.

They act on the output of a block in the computer's own time, not on a body: `bias` of a block is a
constant that is added to its output. `CONTROL_EFFECTS` is the catalogue, keyed by the file's name.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType

from ....base.folders import Shelf
from ._control_effect import ORDER, ControlEffect

__all__ = ["CONTROL_EFFECTS", "ORDER", "ControlEffect"]


def _shipped_effect(module: ModuleType) -> ControlEffect:
    name = module.__name__.rpartition(".")[2]
    effect: ControlEffect = module.EFFECT
    return replace(effect, name=name, text=module.__doc__ or "")


#: effects that may act behind (or, for the velocity, in front of) a control law
CONTROL_EFFECTS: Mapping[str, ControlEffect] = Shelf(
    __name__, Path(__file__).parent, _shipped_effect, "effect of a controller block"
)
