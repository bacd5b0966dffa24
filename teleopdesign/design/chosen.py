"""A proposed controller, with a reason for each of its numbers."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.shown import Shown
from ..base.units import unit_after_number
from ..controllers import Controller


@dataclass(frozen=True)
class Reason:
    """The reason for the value (SI) of a parameter "law.parameter" of a proposed controller."""

    parameter: str
    value: float
    unit: str
    why: str

    def __str__(self) -> str:
        unit = unit_after_number(self.unit)
        return f"{self.parameter} = {self.value:.4g}{unit}: {self.why}"


@dataclass(frozen=True)
class ProposedController(Shown):
    """A controller and the reasons for its numbers.

    controller: stages in series, parameters in SI;  reasons: one for each chosen parameter
    """

    controller: Controller
    reasons: tuple[Reason, ...]

    @property
    def law(self) -> str:
        """Name of the first law of the controller."""
        return self.controller.stages[0].law.name
