"""A sampled virtual spring on an encoder with steps, and its limit with friction compensation.

Each sample time T the position is rounded to steps Delta (error q within h = Delta/2), and the
force -K (x + q) is held. The body has damping b and Coulomb friction f_C, of which up to f_D is
cancelled. Over a sample of travel d the energy put in, less the change of K x^2/2, is at least

    (b/T - K/2) d^2 + (f_C - f_D - K h) abs(d)

So K <= min(2 b/T, 2 (f_C - f_D)/Delta) is passive. Above this limit a motion that alternates
between two positions, close to the edge of a step or far apart, releases energy. Without
compensation these are the limits of Abbott and Okamura, IEEE Trans. Robotics 21 (2005) 952.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..claims.claim import Claim, Proof, Unknown
from ..linear.impedance import decimal
from ..rate_independent import AbstractMotion, strongest
from ._hypotheses import NonNegative, Positive, certificate, require_hypotheses
from ._theorem import Question, TopicClaim, decide

ORDER = 60


@dataclass(frozen=True)
class Flip(AbstractMotion):
    """A motion that alternates between the positions step/2 + distance and step/2 - distance.

    stiffness: K, N/m;  step: Delta, m;  sample_time: T, s;  damping: b, N s/m
    friction: Coulomb friction that is not cancelled, f_C - f_D, N; negative if over-compensated
    distance: of both positions from the edge of a step, m
    """

    stiffness: float
    step: float
    sample_time: float
    damping: float
    friction: float
    distance: float
    kind = "flip"

    def replay(self) -> float:
        """Energy released in two samples, J, each with constant speed."""
        k, step, a = self.stiffness, self.step, self.distance
        positions = [step / 2 + side * a for side in (1, -1)]
        high, low = (k * step * math.floor(x / step + 0.5) if step else k * x for x in positions)
        lost = 2 * (self.damping / self.sample_time * (2 * a) ** 2 + self.friction * 2 * a)
        return (high - low) * 2 * a - lost


@require_hypotheses
def quantised_spring(
    *,
    stiffness: NonNegative,
    damping: NonNegative,
    sample_time: Positive,
    step: NonNegative,
    coulomb_level: NonNegative,
    compensator_level: NonNegative = 0,
) -> Claim:
    """Is the virtual spring passive: if and only if K <= min(2 b/T, 2 (f_C - f_D)/Delta)?

    stiffness: K, N/m;  damping: b, N s/m;  sample_time: T, s;  step: Delta of the encoder, m
    coulomb_level: f_C, N;  compensator_level: f_D, N, bound of any compensator
    returns: proved, equality included, or refuted by a motion between two positions. With f_D > 0
        the refutation is for a compensator that pushes with f_D along the motion. Unknown where the
        condition fails by too little for the search
    """
    k, b, late, delta = stiffness, damping, sample_time, step
    f_c, f_d = coulomb_level, compensator_level
    values = {"K": k, "b": b, "T": late, "h": delta / 2, "f_C": f_c, "f_D": f_d}
    made = [float(x) for x in (k, delta, late, b, f_c - f_d)]
    return decide(
        f"a virtual spring {decimal(k)} N/m at steps of {decimal(delta)} m and {decimal(late)} s, "
        f"damping {decimal(b)} N s/m, "
        f"friction {decimal(f_c)} N of which {decimal(f_d)} N is cancelled, is passive",
        min(2 * b / late - k, 2 * (f_c - f_d) - k * delta) >= 0,
        proof=lambda: Proof(
            "V = K x^2/2 at the samples", (certificate("quantised_spring", **values),)
        ),
        motion=lambda: _flip(made, float(delta) or 1e-3),
        how="two positions in turn",
        why_open="the condition fails, but by less than the search resolves",
    )


def _flip(values: list[float], scale: float) -> Flip | None:
    """The motion that releases most, no further apart than a thousand steps where that is enough.

    values: those of `Flip` but for the distance;  scale: of the distances, m
    """
    k, delta, late, b, left = values
    flips = [Flip(k, delta, late, b, left, float(a)) for a in scale * np.geomspace(1e-9, 1e9, 400)]
    giving = [f for f in flips if f.energy > 0]
    near = [f for f in giving if f.distance <= 1e3 * scale] or giving[:1]
    return strongest(near)


def stiffest_spring(
    *,
    damping: float,
    sample_time: float,
    step: float,
    coulomb_level: float,
    compensator_level: float = 0.0,
) -> float:
    """Stiffness of the stiffest passive spring, N/m: min(2 b/T, 2 (f_C - f_D)/Delta), or 0.

    Arguments as in `quantised_spring`, which proves or refutes a single stiffness.
    """
    by_steps = 2 * (coulomb_level - compensator_level) / step if step else math.inf
    return max(min(2 * damping / sample_time, by_steps), 0.0)


def claims(question: Question) -> list[TopicClaim]:
    """The claim about a wall without damping and delay, on encoder steps."""
    device, wall, computer = question.device, question.wall, question.computer
    if wall is None or computer is None or question.late != 0:
        return []
    if wall.damping or not computer.encoder_step:
        return []
    claim = quantised_spring(
        stiffness=wall.stiffness,
        damping=device.damping.low,
        sample_time=computer.period,
        step=computer.encoder_step,
        coulomb_level=device.lowest.low,
        compensator_level=wall.cancelled,
    )
    # friction that gives first takes at most as much: a refutation holds for it, too
    if device.presliding is not None and claim.holds:
        why = (
            "the theorem takes friction that slides at once: friction that gives first takes less "
            "from the small motion between two steps"
        )
        claim = Claim(claim.statement, Unknown(why))
    return [TopicClaim("virtual wall, encoder steps", claim, time="sampled")]
