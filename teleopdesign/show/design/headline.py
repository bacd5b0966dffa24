"""The first lines of a design: what to build, the force error to expect, whether it is passive."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...base.units import unit_of
from ...design.verdict import CONTINUOUS
from ...diagnose.criteria import CRITERIA
from ...diagnose.noise_floor import say_floors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...design import Design
    from ...passivity import Claim


def headline(design: Design) -> list[str]:
    """What to build and with which sensors; the expected force error; passivity and its basis."""
    return [_what_to_build(design), _error_to_expect(design), *_passive(design)]


def _what_to_build(design: Design) -> str:
    case = design.expected.case
    parts = []
    if design.cancellation is not None:
        parts.append(f"C = {design.cancellation.words}, from the position sensor")
    if case == "hybrid":
        parts.append("H, with the force sensor between hand and device")
    what = f"build {' and '.join(parts)}" if parts else "build no compensation"
    left = ", ".join(f"{name} ({why})" for name, why in design.not_cancelled.items())
    return f"{what}; found and not compensated: {left or 'nothing'}"


def _error_to_expect(design: Design) -> str:
    e, unit = design.expected, unit_of("force", design.body.axis)
    size = f"from {e.low:.3g} to {e.high:.3g} {unit} rms (95 %)"
    if math.isnan(e.low):
        size = f"{e.simulated:.3g} {unit} rms, in an interval that is not known"
    line = f"expected force error: {size}, without "
    line += f"compensation {e.without:.3g}"
    if e.simulated > e.without:
        line += ": more than without, in this motion"
    if e.unexplained > 0 and not math.isnan(e.low):
        line += f"; in the upper end {e.unexplained:.2g} {unit} that no effect explains"
    return line


def _passive(design: Design) -> list[str]:
    """Verdicts on the case that will be built, after what they rest on."""
    rests = []
    if design.verdict == "undecided":
        rests.append("an undecided answer")
    if design.left > CRITERIA.adequate:
        rests.append(f"unexplained force ({say_floors(design.left)} noise floors)")
    if not design.reach.measures_force:
        rests.append("records without a force sensor")
    basis = f"resting on {', '.join(rests)}, " if rests else ""
    cases = [c for c in ("MBC", "hybrid") if c == design.expected.case or design.cancellation]
    if design.expected.case != "hybrid":
        cases = cases[:1] if design.cancellation else ["none"]
    lines = []
    for case in cases:
        what = {"MBC": "with C alone", "hybrid": "with C and H", "none": "as it is"}[case]
        lines.append(f"passive {what}: {basis}{_verdict(design.claims[case])}")
    return lines


def _verdict(claims: Sequence[Claim]) -> str:
    """One word for a case: what is refuted first, then what is not proved."""
    against = [c for c in claims if c.status == "refuted" or c.holds is False]
    if against:
        return f"no: {against[0].heading}: {against[0].statement}"
    proofs = [c for c in claims if c.status == "proved"]
    for_it = any(c.status == "evidence" and c.holds for c in claims)
    known = "not known, simulated motions release no energy" if for_it else "not known"
    if not proofs:
        return known
    margin = getattr(proofs[0].verdict, "margin", math.nan)
    unit = getattr(proofs[0].verdict, "unit", "")
    where = CONTINUOUS if CONTINUOUS in proofs[0].statement else ""
    words = f"proved{where} for friction and its cancellation (margin {margin:.3g} {unit})"
    return f"{words}; the whole device: {known}"
