"""Claims in the units of an axis: theorems are written for a prismatic one.

The numbers are the same on both; a force of 0.5 N reads 0.5 N m where the axis turns.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from ...quantity import unit_of
from .claim import Claim, Evidence, Proof, Refutation, Unknown

_QUANTITIES = ("damping", "stiffness", "force", "velocity", "inertia", "position")
#: unit on a prismatic axis -> on a revolute one, as claims write them, longest first
_ROTARY = {
    unit_of(q, "prismatic").replace("*", " "): unit_of(q, "revolute").replace("*", " ")
    for q in _QUANTITIES
}
_UNIT = "|".join(sorted(map(re.escape, _ROTARY), key=len, reverse=True))
#: a unit behind a number, and behind no other unit
_MEASURE = re.compile(rf"(?<=\d )({_UNIT})(?![\w/^*]| m\b| s/)")


def use_units_of(axis: str, claim: Claim) -> Claim:
    """The claim with all its texts in the units of that axis."""
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
    """The text with units behind numbers as on a revolute axis."""
    return _MEASURE.sub(lambda match: _ROTARY[match.group(1)], text)
