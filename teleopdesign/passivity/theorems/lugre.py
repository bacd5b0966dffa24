"""LuGre friction alone: passive if and only if s2 >= s1 (F_S/F_C - 1).

    y = sigma_0 z,   z' = v - abs(v) y/g,   F = y + s1 z' + s2 v
    g = F_C + (F_S - F_C) e^-(v/v_S)^2

s1 is the damping of the bristle and s2 the viscous damping. The condition is sufficient, with the
storage V = y^2/(2 sigma_0). It is also necessary: slow motion loads the bristle to F_S, and after a
jump to high speed the bristle recoils. Barabanov and Ortega, IEEE TAC 45 (2000) 830.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...base.sentences import round_near
from ...effects import EFFECTS, SIGNALS
from ..claims.claim import Claim, Proof, Unknown
from ..identified import DIGITS
from ..linear.impedance import decimal, exact
from ..rate_independent import AbstractMotion, Dahl, strongest
from ._hypotheses import NonNegative, Positive, certificate, require_hypotheses
from ._theorem import Question, TopicClaim, decide

ORDER = 50

_STRIBECK = EFFECTS["stribeck"]
#: extra friction level (N) of the effect `stribeck`, a function of velocity, F_S - F_C, v_S
_EXTRA = sp.lambdify(
    [
        SIGNALS["velocity"],
        *(_STRIBECK.symbols()[n] for n in ("extra_static_level", "stribeck_velocity")),
    ],
    _STRIBECK.expression(),
    "math",
)


@dataclass(frozen=True)
class Jumps(AbstractMotion):
    """A closed path in legs of constant speed that takes energy out of LuGre friction.

    levels: F_C, F_S, N;  stiffness: sigma_0, N/m;  dampings: s1, s2, N s/m
    stribeck_velocity: v_S, m/s
    legs: (velocity, m/s; travel, m, > 0) of one round;  rounds: number; the last one counts
    """

    levels: tuple[float, float]
    stiffness: float
    dampings: tuple[float, float]
    stribeck_velocity: float
    legs: tuple[tuple[float, float], ...]
    rounds: int = 4
    kind = "jumps"

    def level(self, velocity: float) -> float:
        """Friction level g at a constant velocity (m/s), N."""
        low, high = self.levels
        return low + float(_EXTRA(velocity, high - low, self.stribeck_velocity))

    def replay(self) -> float:
        """Energy released in the last round, J, with an exact solution for each leg."""
        y, out = 0.0, 0.0
        s1, s2 = self.dampings
        for _ in range(self.rounds):
            out = 0.0
            for velocity, travel in self.legs:
                bristle = Dahl(self.level(velocity), self.stiffness)
                after, work = bristle.leg(y, math.copysign(travel, velocity))
                work += s1 * velocity * (after - y) / self.stiffness + s2 * abs(velocity) * travel
                y, out = after, out - work
        return out


@require_hypotheses
def lugre_passivity(
    *,
    coulomb_level: Positive,
    static_level: Positive,
    stiffness: Positive,
    bristle_damping: NonNegative,
    viscous_damping: NonNegative,
    stribeck_velocity: Positive,
) -> Claim:
    """Is LuGre friction passive: if and only if s2 >= s1 (F_S/F_C - 1)?

    coulomb_level, static_level: F_C, F_S, N;  stiffness: sigma_0, N/m
    bristle_damping, viscous_damping: s1, s2, N s/m;  stribeck_velocity: v_S, m/s
    returns: proved, equality included; else refuted by jumps of velocity, or unknown
    raises ModelError: F_S below F_C, or an argument outside of its hypothesis
    """
    f_c, f_s, sigma = coulomb_level, static_level, stiffness
    s1, s2, v_s = bristle_damping, viscous_damping, stribeck_velocity
    if f_c > f_s:
        raise ModelError(
            f"lugre_passivity: expected F_C <= F_S, found {decimal(f_c)} and {decimal(f_s)}"
        )
    margin = s2 - s1 * (f_s / f_c - 1)
    values = {"sigma_0": sigma, "s1": s1, "s2": s2, "F_C": f_c, "F_S": f_s}
    return decide(
        f"LuGre friction (F_C {decimal(f_c)}, F_S {decimal(f_s)} N, "
        f"s1 {decimal(s1)}, s2 {decimal(s2)} N s/m) is passive",
        margin >= 0,
        proof=lambda: Proof(
            "V = y^2/(2 sigma_0)", (certificate("lugre", **values),), float(margin), "N s/m"
        ),
        motion=lambda: _recoil(
            (float(f_c), float(f_s)), float(sigma), (float(s1), float(s2)), float(v_s)
        ),
        how="slow motion, then a jump to high speed, to and fro",
        why_open="the condition fails, but no motion on the grid shows it",
    )


def add_bristle_damping(
    pair: Claim,
    *,
    coulomb_level: Any,
    highest_level: Any,
    stiffness: Any,
    bristle_damping: Any,
    viscous_damping: Any,
) -> Claim:
    """A claim about Dahl friction and its compensator, with bristle and viscous damping added.

    Energies add. Both dampings together take energy at every instant where s2 F_min >= s1 (F_max -
    F_min), and then a proof without them holds with them. Otherwise nothing is known: the bristle
    may recoil after a jump of speed at a lower level. A refuting motion of the pair can be as slow
    as one likes, so that the dampings take nothing, and the refutation stays.

    coulomb_level, highest_level: F_min and F_max, N;  stiffness: sigma_0, N/m
    bristle_damping, viscous_damping: s1, s2, N s/m
    """
    low, high, sigma = exact(coulomb_level), exact(highest_level), exact(stiffness)
    s1, s2 = exact(bristle_damping), exact(viscous_damping)
    if s1 == 0 or not isinstance(pair.verdict, Proof):
        return pair
    statement = (
        f"{pair.statement}, bristle damping {decimal(s1)} and viscous damping {decimal(s2)} N s/m "
        "counted"
    )
    if s2 * low < s1 * (high - low):
        why = (
            f"bristle damping may release energy where the level falls from {decimal(high)} to "
            f"{decimal(low)} N, unless viscous damping is {float(s1 * (high / low - 1)):.4g} N s/m "
            "or more; the pair without both is proved"
        )
        return Claim(statement, Unknown(why))
    values = {"sigma_0": sigma, "s1": s1, "s2": s2, "F_C": low, "F_S": high}
    certificates = (*pair.verdict.certificates, certificate("bristle_damping", **values))
    return Claim(statement, replace(pair.verdict, certificates=certificates))


def _recoil(
    levels: tuple[float, float], stiffness: float, dampings: tuple[float, float], v_s: float
) -> Jumps | None:
    """Slow motion and jumps to a high speed that release energy, at the least such high speed."""
    length = levels[1] / stiffness

    def at(fast: float, travel: float) -> Jumps:
        half = ((1e-3 * v_s, 30 * length), (fast, travel))
        legs = (*half, *((-v, x) for v, x in half))
        return Jumps(levels, stiffness, dampings, v_s, legs)

    travels = (length * np.geomspace(1e-6, 3.0, 60)).tolist()
    speeds = (v_s * np.geomspace(1.0, 1e9, 91)).tolist()
    best = (strongest(at(fast, travel) for travel in travels) for fast in speeds)
    return next((jumps for jumps in best if jumps is not None), None)


def claims(question: Question) -> list[TopicClaim]:
    """The claim about a device alone with all parts of LuGre friction identified."""
    device = question.device
    alone = question.cancellation is None and question.wall is None
    has_stribeck = "stribeck.extra_static_level" in device.body.parameters
    if not (alone and has_stribeck and device.presliding is not None):
        return []
    values = {
        # estimates with the digits of all claims; what has no error is as it was stated
        n: round_near(v.value, digits=DIGITS) if v.stderr > 0 else v.value
        for n, v in device.body.parameters.items()
    }
    low, high = device.lowest.estimate, device.highest.estimate
    plain = sum((EFFECTS[n].expression() for n in ("coulomb", "stribeck")), sp.S(0))
    if device.body.level() == plain:
        low = values["coulomb.level"]
        # of decimals, a decimal
        high = float(f"{low + values['stribeck.extra_static_level']:.12g}")
    claim = lugre_passivity(
        coulomb_level=low,
        static_level=high,
        stiffness=device.presliding.estimate,
        bristle_damping=device.bristle_damping.estimate,
        viscous_damping=device.damping.estimate,
        stribeck_velocity=values["stribeck.stribeck_velocity"],
    )
    if device.body.level() != plain and not claim.holds:
        why = (
            "the condition fails, and no motion is searched where the level is not Stribeck's alone"
        )
        claim = Claim(claim.statement, Unknown(why))
    # what acts on commands is no part of it
    return [TopicClaim("the device's own friction", claim, time="any", covers=device.actuation)]
