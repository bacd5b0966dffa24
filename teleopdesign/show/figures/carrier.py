"""The variable that carries an effect: a residual drawn over it shows the effect."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...base.finding import Array
from ...base.units import unit_of
from ...blocks import Body
from ...diagnose import Diagnosis
from ...effects import SIGNALS, Effect, depends_on_position, period

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
        turns = f", {2 * np.pi / self.period:.1f} a turn" if axis == "revolute" else ""
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
    return carrier_of_effect(added[0].effect, diagnosis.model.body(body))


def carrier_of_change(before: Body, after: Body) -> CarryingVariable:
    """Of the first effect that only one of two bodies has; the velocity where there is none."""
    for one, other in ((after, before), (before, after)):
        for effect in one.effects:
            if not other.has(effect.name):
                return carrier_of_effect(effect, one)
    return CarryingVariable()


def carrier_of_effect(effect: Effect, body: Body) -> CarryingVariable:
    """The variable that the law of an effect of a body depends on."""
    if depends_on_position(effect):
        length = period(effect)
        if isinstance(length, str):
            length = body.parameters[f"{effect.name}.{length}"].value
        return CarryingVariable("position", abs(length or 0.0))
    law = effect.expression()
    gains = effect.role == "actuation"
    return CarryingVariable(
        "command" if gains or any(law.has(SIGNALS[n]) for n in _LOADS) else "velocity"
    )


def with_carrier(data: Any, carrier: CarryingVariable, axis: str) -> Any:
    """Residual data with the variable "carrier", labelled with its unit."""
    attributes = {"units": data[carrier.name].attrs["units"], "label": carrier.label(axis)}
    return data.assign(carrier=("sample", carrier.values(data), attributes))
