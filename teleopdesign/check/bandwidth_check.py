"""The bandwidth of the comparison: whether the position still tells a motion there.

The wider the band, the more of the readings' error is left in the velocity. Where a velocity is not
told from rest, friction takes up whatever force acts: no model fails there, and none is tested.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..diagnose.prepare import Prepared, prepare
from ..finding import Finding

#: share of the rows in motion, over that two octaves lower, below which a bandwidth is doubted. A
#: half: of what could be tested, most is lost
LEAST_SHARE = 0.5
#: part of that share at which a lower bandwidth is proposed
ENOUGH = 0.9
#: Hz: none below is proposed
LOWEST = 1.0


def check_bandwidth(prepared: Prepared) -> Iterator[Finding]:
    """A bandwidth at which far fewer rows tell a motion than at a lower one."""
    for body in prepared.experiment.bodies:
        moving = share_in_motion(prepared, body)
        octaves = [prepared.bandwidth / 2**k for k in (1, 2)]
        if octaves[-1] < LOWEST:
            return
        lower = {
            b: share_in_motion(prepare(prepared.experiment, bandwidth=b), body) for b in octaves
        }
        could = lower[octaves[-1]]
        if moving >= LEAST_SHARE * could:
            continue
        proposed = max(b for b in octaves if lower[b] >= ENOUGH * could)
        yield Finding(
            "bandwidth",
            "warning",
            f"below {prepared.bandwidth:.3g} Hz, the bandwidth of the comparison, the position "
            f"tells a motion in {100 * moving:.0f} % of the rows, below {proposed:.2g} Hz in "
            f"{100 * lower[proposed]:.0f} %. In the others friction at rest takes up any force, "
            f"and no model is tested: write bandwidth = {{ value = {proposed:.2g}, "
            'unit = "Hz" } at comparison.',
            {"bandwidth": prepared.bandwidth, "proposed": proposed, "seen": moving, "could": could},
            body,
        )


def share_in_motion(prepared: Prepared, body: str) -> float:
    """Share of the rows that count in which the position of a body tells a direction of motion."""
    of_body = [s for s in prepared.of("fit") if s.motion.body == body]
    if not of_body:
        return 0.0
    return float(np.mean(np.concatenate([s.motion.direction[s.keep] != 0 for s in of_body])))
