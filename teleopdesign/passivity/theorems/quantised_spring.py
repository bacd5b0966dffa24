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
from typing import Any

import numpy as np
import sympy as sp

from ..claims.certificate import Certificate, Term, storage_certificate
from ..claims.claim import Claim, Proof, Refutation, Unknown
from ..linear.impedance import decimal, exact
from ._hypotheses import NOT_NEGATIVE, POSITIVE, require_hypotheses
from ._theorem import Question, Theorem, TopicClaim


@dataclass(frozen=True)
class Flip:
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

    @property
    def energy(self) -> float:
        """Energy released in two samples, J."""
        return self.replay()

    def replay(self) -> float:
        """Energy released in two samples, J, each with constant speed."""
        edge, a = self.step / 2, self.distance
        high, low = (self._spring_force(edge + side * a) for side in (1, -1))
        lost = 2 * (self.damping / self.sample_time * (2 * a) ** 2 + self.friction * 2 * a)
        return (high - low) * 2 * a - lost

    def _spring_force(self, position: float) -> float:
        """Force of the spring at a sample, N, from the rounded position."""
        if self.step == 0:
            return self.stiffness * position
        return self.stiffness * self.step * math.floor(position / self.step + 0.5)

    def as_dict(self) -> dict[str, object]:
        """Plain data, to be written as JSON."""
        return {"kind": "flip", **vars(self), "energy": self.energy}


@require_hypotheses(
    stiffness=NOT_NEGATIVE,
    damping=NOT_NEGATIVE,
    sample_time=POSITIVE,
    step=NOT_NEGATIVE,
    coulomb_level=NOT_NEGATIVE,
    compensator_level=NOT_NEGATIVE,
)
def quantised_spring(
    *,
    stiffness: Any,
    damping: Any,
    sample_time: Any,
    step: Any,
    coulomb_level: Any,
    compensator_level: Any = 0,
) -> Claim:
    """Is the virtual spring passive: if and only if K <= min(2 b/T, 2 (f_C - f_D)/Delta)?

    stiffness: K, N/m;  damping: b, N s/m;  sample_time: T, s;  step: Delta of the encoder, m
    coulomb_level: f_C, N;  compensator_level: f_D, N, bound of any compensator
    returns: proved, equality included, or refuted by a motion between two positions. With f_D > 0
        the refutation is for a compensator that pushes with f_D along the motion. Unknown where the
        condition fails by too little for the search
    raises ModelError: an argument outside of its hypothesis
    """
    k, b, late = exact(stiffness), exact(damping), exact(sample_time)
    delta, f_c, f_d = exact(step), exact(coulomb_level), exact(compensator_level)
    statement = (
        f"a virtual spring {decimal(k)} N/m at steps of {decimal(delta)} m and {decimal(late)} s, "
        f"damping {decimal(b)} N s/m, "
        f"friction {decimal(f_c)} N of which {decimal(f_d)} N is cancelled, is passive"
    )
    spare = 2 * b / late - k, 2 * (f_c - f_d) - k * delta
    if min(spare) >= 0:
        proof = Proof("V = K x^2/2 at the samples", (_certificate(k, b, late, delta, f_c, f_d),))
        return Claim(statement, proof)
    left = float(f_c - f_d)
    scale = float(delta) or 1e-3
    flips = [
        Flip(float(k), float(delta), float(late), float(b), left, float(a))
        for a in scale * np.geomspace(1e-9, 1e9, 400)
    ]
    giving = [f for f in flips if f.energy > 0]
    if not giving:
        why = "the condition fails, but by less than the search resolves"
        return Claim(statement, Unknown(why))
    # no further apart than a thousand steps, where such a motion is enough
    near = [f for f in giving if f.distance <= 1e3 * scale] or giving[:1]
    best = max(near, key=lambda f: f.energy)
    return Claim(statement, Refutation("two positions in turn", best))


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


def _certificate(
    k: sp.Expr, b: sp.Expr, late: sp.Expr, delta: sp.Expr, f_c: sp.Expr, f_d: sp.Expr
) -> Certificate:
    names = "K b T h f_C f_D x d q c abs_d sign_d"
    stiff, damp, time, h, friction, level, x, d, q, c, abs_d, _ = sp.symbols(names, real=True)
    work = stiff * (x + q) * d + damp / time * d**2 + friction * abs_d - c * d
    rest: list[Term] = [
        (1, {"damped": 1, "T": -1}, d),
        (1, {"rubbed": 1, "abs_d": 1}, 1),
    ]
    return storage_certificate(
        "spring, damping and friction less a compensating force c within f_D take in at least the "
        "change of K x^2/2 over each sample of travel d",
        supply=work - stiff * ((x + d) ** 2 - x**2) / 2,
        positive={"T": time},
        nonnegative={
            "K": stiff,
            "damped": damp - stiff * time / 2,
            "rubbed": friction - level - stiff * h,
            "q_above": h + q,
            "q_below": h - q,
            "c_above": level + c,
            "c_below": level - c,
        },
        signs=["d"],
        proofs={
            "supply": {
                "1": [
                    *rest,
                    (1, {"abs_d": 1, "K": 1, "q_above": 1}, 1),
                    (1, {"abs_d": 1, "c_below": 1}, 1),
                ],
                "-1": [
                    *rest,
                    (1, {"abs_d": 1, "K": 1, "q_below": 1}, 1),
                    (1, {"abs_d": 1, "c_above": 1}, 1),
                ],
            },
            "storage": {"": ()},
        },
        example={
            "K": k,
            "b": b,
            "T": late,
            "h": delta / 2,
            "f_C": f_c,
            "f_D": f_d,
            "x": 0,
            "d": 1,
            "q": 0,
            "c": 0,
        },
    )


def _applies(question: Question) -> bool:
    """Whether the question is about a wall without damping and delay, on encoder steps."""
    wall, computer = question.wall, question.computer
    if wall is None or computer is None:
        return False
    return bool(computer.encoder_step) and not wall.damping and question.late == 0


def _claims(question: Question) -> list[TopicClaim]:
    device, wall, computer = question.device, question.wall, question.computer
    assert wall is not None and computer is not None
    claim = quantised_spring(
        stiffness=wall.stiffness,
        damping=device.damping.low,
        sample_time=computer.period,
        step=computer.encoder_step,
        coulomb_level=device.lowest.low,
        compensator_level=wall.cancelled,
    )
    return [TopicClaim("virtual wall, encoder steps", claim, time="sampled")]


THEOREM = Theorem(mathematics=(quantised_spring,), applies=_applies, claims=_claims, order=60)
