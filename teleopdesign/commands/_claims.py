"""Claims with their verdicts on the terminal and as plain data.

Passivity at the ports of a diagram from a file, or of a shipped diagram.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.sentences import wrap
from ._options import write_requested
from .derive import diagram_of

if TYPE_CHECKING:
    from ..passivity.diagram_claims import DiagramClaims
    from ..passivity.theorems import TopicClaim
    from ..simulate import Sampling


#: before the texts of a claim
SPACE = " " * 10


def claim_lines(claims: Sequence[TopicClaim]) -> list[str]:
    """Lines with status and topic of each claim, its statement and its verdict."""
    lines = []
    for one in claims:
        lines += ["", f"{one.heading:<9} {one.topic}"]
        texts = [one.claim.statement, str(one.claim.verdict)]
        if one.motion is not None:
            texts.append(f"replayed in simulation: releases {one.replayed:.4g} J")
        lines += [wrap(text, first=SPACE, rest=SPACE) for text in texts]
    return lines


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


def is_diagram(source: Path) -> bool:
    """Whether a source is a diagram: a TOML file other than experiment.toml, or a shipped name."""
    from ..diagrams import SHIPPED

    if source.suffix == ".toml":
        return source.name != "experiment.toml"
    return str(source) in SHIPPED and not source.exists()


def settle_diagram(options: argparse.Namespace, computer: Sampling | None) -> int:
    """Print the claims about a diagram's ports and write the requested file; returns 0."""
    import numpy as np

    from ..passivity.diagram_claims import Search, diagram_claims

    search = Search(options.stroke, options.speed, computer=computer or "continuous")
    diagram = diagram_of(str(options.source), options.effect, options.law)
    claims = diagram_claims(diagram, rng=np.random.default_rng(1), search=search)
    print(_text(claims))
    content = {
        "diagram": repr(claims.diagram),
        "ports": [str(port) for port in claims.ports],
        "nonlinear": list(claims.nonlinear),
        "claims": [claim_data(s) for s in claims.claims],
    }
    write_requested(options, json=lambda: content)
    return 0


def _text(claims: DiagramClaims) -> str:
    lines = [f"{claims.diagram.name}: ports (force, motion) {', '.join(map(str, claims.ports))}"]
    lines.append(f"not linear: {', '.join(claims.nonlinear) or 'nothing'}")
    if claims.diagram.controls:
        lines.append("what is proved holds for controllers in continuous time")
    return "\n".join([*lines, *claim_lines(claims.claims)])
