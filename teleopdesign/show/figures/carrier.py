"""The variable that carries an effect: a residual drawn over it shows the effect."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...base.finding import Array
from ...base.units import unit_of
from ...diagnose import Diagnosis
from ...effects import SIGNALS, depends_on_position, period

#: signals of a law that are the load of a transmission
_LOADS = ("command", "acting_force", "carried_force")


@dataclass(frozen=True)
class CarryingVariable:
    """A variable of residual data: "velocity", "position" or "command".

    period: m or rad, into which the position is folded; 0: it is not
    """

    name: str = "velocity"
    period: float = 0.0

    @property
    def words(self) -> str:
        """The variable in words."""
        return "position within a period" if self.period else self.name

    def label(self, axis: str) -> str:
        """The variable and its period, without its unit."""
        if not self.period:
            return self.name
        turns = f", {2 * np.pi / self.period:.3g} a turn" if axis == "revolute" else ""
        return f"position in a period of {self.period:.4g} {unit_of('position', axis)}{turns}"

    def values(self, data: Any) -> Array:
        """The variable of residual data (or of a mapping with its names), (n,)."""
        values = np.asarray(data[self.name])
        return np.mod(values, self.period) if self.period else values


def carrier_of(diagnosis: Diagnosis, body: str) -> CarryingVariable:
    """Of the first effect that the diagnosis added at a body; the velocity where it added none."""
    added = [r.added for r in diagnosis.rungs[1:] if r.added is not None and r.added.at == body]
    if not added:
        return CarryingVariable()
    effect = added[0].effect
    if depends_on_position(effect):
        length = period(effect)
        if isinstance(length, str):
            length = diagnosis.model.body(body).parameters[f"{effect.name}.{length}"].value
        return CarryingVariable("position", abs(length or 0.0))
    law = effect.expression()
    gains = effect.role == "actuation"
    return CarryingVariable(
        "command" if gains or any(law.has(SIGNALS[n]) for n in _LOADS) else "velocity"
    )
