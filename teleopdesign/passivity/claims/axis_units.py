"""Texts of claims in the units of a revolute axis; theorems write them for a prismatic axis.

The numbers are the same on both axes: 0.5 N becomes 0.5 N m on a revolute axis.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from ...base.units import unit_of
from .claim import Claim, Evidence, Proof, Refutation, Unknown

_QUANTITIES = ("damping", "stiffness", "force", "velocity", "inertia", "position")
#: unit on a prismatic axis -> unit on a revolute axis, as claims write them
_ROTARY = {
    unit_of(q, "prismatic").replace("*", " "): unit_of(q, "revolute").replace("*", " ")
    for q in _QUANTITIES
}
_UNIT = "|".join(sorted(map(re.escape, _ROTARY), key=len, reverse=True))
#: a unit that follows a number and is not a part of a longer unit
_MEASURE = re.compile(rf"(?<=\d )({_UNIT})(?![\w/^*]| m\b| s/)")


def use_units_of(axis: str, claim: Claim) -> Claim:
    """The claim with its statement and verdict in the units of an axis.

    axis: "prismatic" or "revolute"
    """
    if axis != "revolute":
        return claim
    verdict: Any = claim.verdict
    texts: dict[type, tuple[str, ...]] = {
        Proof: ("method",),
        Refutation: ("method",),
        Evidence: ("searched",),
        Unknown: ("why",),
    }
    changed = {name: use_rotary_units(getattr(verdict, name)) for name in texts[type(verdict)]}
    if isinstance(verdict, Proof | Evidence):
        first, _, rest = verdict.unit.partition(" of ")
        unit = _ROTARY.get(first, first)
        changed["unit"] = f"{unit} of {rest}" if rest else unit
    return Claim(use_rotary_units(claim.statement), replace(verdict, **changed))


def use_rotary_units(text: str) -> str:
    """The text with the units after numbers changed to those of a revolute axis."""
    return _MEASURE.sub(lambda match: _ROTARY[match.group(1)], text)
