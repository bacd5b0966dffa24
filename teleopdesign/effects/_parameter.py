"""A parameter of an effect: quantity, meaning, bounds, and how a fit searches it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..base.arguments import check_types
from ..base.errors import ModelError, unknown
from ..base.units import QUANTITIES


def positive_amplitude(values: Mapping[str, float]) -> dict[str, float]:
    """The same sinusoid with an amplitude >= 0 and a phase in [0, 2 pi)."""
    turned = values["phase"] + (math.pi if values["amplitude"] < 0 else 0.0)
    return {
        **values,
        "amplitude": abs(values["amplitude"]),
        "phase": turned % (2 * math.pi),
    }


@check_types
@dataclass(frozen=True)
class FitSearch:
    """How a fit searches a parameter whose value is not stated.

    starts: start values, as multiples of the record's scale
    scale: "": the scale of the parameter's quantity; "duration": of the record; "travel": the whole
        travel; "largest_force": measured, actuator and interaction together; "resonance_stiffness"
        and the like: of a resonance within the bandwidth
    of_a_turn: on a revolute axis, starts at whole fractions of a turn too, down to one over this
        number, where they are shorter than all `starts`
    of: another parameter, before this one in the effect: `starts` are multiples of each of its
        values, so that both start together; "": of the record's scale
    within: upper bound in that scale, above which the parameter would have another meaning
    limit: upper bound in that scale for a search only: no larger value can have acted. A parameter
        at it keeps its meaning, and does not count as at a bound
    chosen: fixed at the first start, not estimated: other parameters are relative to this one
    held: fixed where a model states it, too: the other parameters belong to its value
    essential: must surely exceed zero, because at zero the effect is another one; and other values
        of it must leave more, with all other parameters fitted again
    """

    starts: tuple[float, ...] = (0.01, 0.1)
    scale: str = ""
    of_a_turn: int = 0
    of: str = ""
    within: float = float("inf")
    limit: float = float("inf")
    chosen: bool = False
    held: bool = False
    essential: bool = False


@check_types
@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect: its quantity (a key of `quantity`), meaning and bounds (SI).

    optional: whether it may be zero, which is its default
    search: how a fit searches it
    """

    quantity: str
    meaning: str
    lower: float = 0.0
    upper: float = float("inf")
    optional: bool = False
    search: FitSearch = FitSearch()

    def __post_init__(self) -> None:
        if self.quantity not in QUANTITIES:
            raise ModelError(f"Parameter: {unknown('quantity', self.quantity, QUANTITIES)}")

    @property
    def scale(self) -> str:
        """Unit of the search: a scale of the record, by default the scale of the quantity."""
        return self.search.scale or self.quantity


#: period of a pattern that repeats along the travel. Starts of a search are even in 1/period, at a
#: distance of three quarters of a cycle over the whole travel: at a distance of a whole cycle, a
#: period between two starts would be orthogonal to both for a motion that stays at its ends. A
#: period of two travels or more is not seen to repeat: such a force is a bias, or a spring. Over
#: many turns these starts end at long periods. Slots, poles and teeth repeat a whole number of
#: times a turn, so such periods are starts too, as short as those over one turn
PERIOD = Parameter(
    "position",
    "p: travel of one period",
    search=FitSearch(
        starts=tuple(4.0 / 3.0 / k for k in range(1, 151)),
        scale="travel",
        of_a_turn=112,
        within=2.0,
    ),
)
