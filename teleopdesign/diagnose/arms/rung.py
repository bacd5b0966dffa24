"""One step of an arm's ladder in the search."""

from __future__ import annotations

from dataclasses import dataclass

from ...base.by_value import ByValue
from ..candidates import Candidate
from .fit import ArmFit


@dataclass(frozen=True, eq=False)
class ArmRung(ByValue):
    """One step of an arm's ladder: the added effect with its joint, and the fit of the arm.

    added: None: the rung of the user's model
    instead_of: the effect of the user's model that the added one replaced
    other: the joint whose motion is the channel `other_position` at the effect's joint
    """

    added: Candidate | None
    fit: ArmFit
    instead_of: Candidate | None = None
    other: str | None = None

    @property
    def follows(self) -> str | None:
        """The joint whose motion the added effect depends on; None: on no other joint's."""
        if self.added is None or "other_position" not in self.added.effect.channels():
            return None
        return self.other
