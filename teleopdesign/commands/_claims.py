"""Claims with their verdicts on the terminal and as plain data."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..passivity.theorems import TopicClaim

#: columns of the terminal
WIDTH = 100


def claim_lines(claims: Sequence[TopicClaim]) -> list[str]:
    """Lines with status and topic of each claim, its statement and its verdict."""
    lines = []
    for one in claims:
        lines += ["", f"{one.heading:<9} {one.topic}"]
        lines += _wrap_text(one.claim.statement) + _wrap_text(str(one.claim.verdict))
        if one.motion is not None:
            lines += _wrap_text(f"replayed in simulation: releases {one.replayed:.4g} J")
    return lines


def _wrap_text(text: str) -> list[str]:
    space = " " * 10
    return textwrap.wrap(
        text, WIDTH, initial_indent=space, subsequent_indent=space, break_on_hyphens=False
    )


def claim_data(entry: TopicClaim) -> dict[str, Any]:
    """A claim as plain data: verdict, certificates, and the motions that refute the claim."""
    claim = entry.claim
    return {
        "topic": entry.topic,
        "statement": claim.statement,
        "status": claim.status,
        "time": entry.time,
        "holds": claim.holds,
        "verdict": str(claim.verdict),
        "certificates": [dict(c.content) for c in claim.certificates],
        "motion": claim.record.as_dict() if claim.status == "refuted" else None,
        "replayed": None if entry.motion is None else entry.motion.as_dict(),
    }
