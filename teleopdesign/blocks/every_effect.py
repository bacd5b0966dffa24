"""Every effect that the package has: the catalogue, and those that belong to a block.

The latter are wanted on a hand or an environment and are no candidates of a diagnosis.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..effects import EFFECTS, Effect
from ..frozen import Catalogue
from ..recipes import remember
from .arm import ARM
from .contact_hysteresis import CONTACT_HYSTERESIS
from .environment import CONTACT
from .impact_damping import IMPACT_DAMPING

#: name -> effect of a block
BLOCK_EFFECTS: Mapping[str, Effect] = Catalogue(
    {e.name: e for e in (ARM, CONTACT, CONTACT_HYSTERESIS, IMPACT_DAMPING)}, "effect of a block"
)


def with_block_effects(effects: Mapping[str, Effect] = EFFECTS) -> Mapping[str, Effect]:
    """Those effects and the ones of blocks, by name; one given wins."""
    return Catalogue({**BLOCK_EFFECTS, **effects}, "effect")


def _block_effect(name: str) -> Effect:
    return BLOCK_EFFECTS[name]


for _effect in BLOCK_EFFECTS.values():
    remember(_effect, _block_effect, _effect.name)
