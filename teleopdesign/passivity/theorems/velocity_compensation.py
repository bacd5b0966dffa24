"""Friction cancelled by a law of velocity: how much may be cancelled before energy comes out.

With the cancelling force

    c(v) = f_D v/(a + abs(v)),    a = 0: f_D sgn(v)

and viscous damping B, friction and cancellation together are passive if and only if

    sqrt(f_D) <= sqrt(f_0) + sqrt(a B)

Here f_0 = f_C for ideal Coulomb friction, whose contact is rigid, and f_0 = 0 for friction that
deflects before it slides. In small motion such friction is a spring, and it loses less energy than
any negative damper adds, whatever the levels.

The condition says abs(c(w)) <= f_0 + B abs(w) at every speed w. So it also covers a sampled law:
over a sample of travel d, with the command of an earlier travel e,

    f_0 abs(d) + B d^2/T - c d >= B (d^2 - e^2)/(2 T)

by 2 abs(d e) <= d^2 + e^2, and the sum over all samples is not negative. The velocity of a sampled
law is the difference of readings, without a filter, and its delay is a whole number of samples.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import sympy as sp

from ...controllers import SIGNALS, equation_of, laws_that_declare, symbols_of
from ..claims.claim import Claim, Proof
from ..linear.impedance import decimal
from ..rate_independent import AbstractMotion, Coulomb, Dahl
from ._hypotheses import (
    NonNegative,
    Positive,
    PositiveOrNone,
    Whole,
    certificate,
    require_hypotheses,
)
from ._theorem import Question, Time, TopicClaim, decide

ORDER = 15

_LAW = laws_that_declare("smoothing")[0]
_EQUATION, _VELOCITY = equation_of(_LAW, sp.S(0)), SIGNALS["velocity"]
assert _EQUATION is not None
#: force (N) of the catalogue's smoothed law, a function of velocity, level and smoothing velocity
_COMMAND = sp.lambdify(
    [_VELOCITY, *(symbols_of(_LAW)[n] for n in (_LAW.bound, _LAW.smoothing))],
    _EQUATION.output.subs(SIGNALS["speed"], sp.Abs(_VELOCITY)),
    "math",
)


@dataclass(frozen=True)
class SteadyStrokes(AbstractMotion):
    """Strokes back and forth at one speed, from rest, over which a law of velocity releases energy.

    level, smoothing: f_D, N, and a, m/s, of the law (a = 0: f_D sgn v);  damping: B, N s/m
    friction: the element that resists;  speed: m/s;  travel: of each stroke, m
    sample_time: s, 0 in continuous time;  late: delay of the force in samples
    strokes: number of strokes
    """

    level: float
    smoothing: float
    friction: Coulomb | Dahl
    damping: float
    speed: float
    travel: float
    sample_time: float = 0.0
    late: int = 0
    strokes: int = 8
    kind = "steady strokes"

    def replay(self) -> float:
        """Energy released, J, from rest without preload, with an exact formula for each stroke.

        With a sampled law, the velocity of the stroke before still drives the first samples.
        """
        command = _COMMAND(self.speed, self.level, self.smoothing)
        behind = min((1 + self.late) * self.sample_time * self.speed, self.travel)
        force, out, way = 0.0, 0.0, 1.0
        for k in range(self.strokes):
            force, work = self.friction.leg(force, way * self.travel)
            helped = self.travel - behind * (2 if k else 1)
            out += command * helped - work - self.damping * self.speed * self.travel
            way = -way
        return out


@require_hypotheses
def velocity_compensation(
    *,
    coulomb_level: Positive,
    compensator_level: Positive,
    smoothing_velocity: NonNegative = 0,
    viscous_damping: NonNegative = 0,
    presliding_stiffness: PositiveOrNone = None,
    sample_time: PositiveOrNone = None,
    late: Whole = 0,
) -> Claim:
    """Is friction passive together with a law of velocity that cancels it?

    coulomb_level: f_C, N, the lowest level that can occur;  compensator_level: f_D, N
    smoothing_velocity: a of the law `smoothed_coulomb`, m/s; 0: the law `coulomb`
    viscous_damping: B, N s/m
    presliding_stiffness: of friction that deflects before it slides (Dahl friction), N/m; None:
        ideal Coulomb friction
    sample_time: of a computer that takes differences of readings, s; None: continuous time
    late: delay of the force in whole samples
    returns: proved if and only if sqrt(f_D) <= sqrt(f_0) + sqrt(a B), with f_0 = f_C, or 0 with
        presliding; decided in exact numbers, equality included. Else refuted by strokes at one
        speed; unknown where the condition fails by too little for double precision
    """
    f_c, f_d, presliding = coulomb_level, compensator_level, presliding_stiffness
    a, b, period = smoothing_velocity, viscous_damping, sample_time or sp.S(0)
    contact = "ideal" if presliding is None else f"presliding ({decimal(presliding)} N/m)"
    computer = f", sampled every {decimal(period)} s, {late} late," if period else ""
    least = f_c if presliding is None else sp.S(0)
    gap = f_d - least - a * b
    friction = Coulomb(float(f_c)) if presliding is None else Dahl(float(f_c), float(presliding))
    law = float(f_d), float(a)
    return decide(
        f"{contact} friction {decimal(f_c)} N and damping {decimal(b)} N s/m with a compensator of "
        f"velocity ({decimal(f_d)} N, a = {decimal(a)} m/s){computer} is passive",
        gap <= 0 or gap**2 <= 4 * least * a * b,
        proof=lambda: _proof(least, f_d, a, b, presliding, sampled=period > 0),
        motion=lambda: _strokes(law, friction, float(b), float(period), late),
        how=lambda strokes: f"strokes at {strokes.speed:.4g} m/s",
        why_open="the condition fails, but by so little that no stroke shows it in double "
        "precision",
    )


def _proof(
    least: sp.Expr,
    f_d: sp.Expr,
    a: sp.Expr,
    b: sp.Expr,
    presliding: sp.Expr | None,
    *,
    sampled: bool,
) -> Proof:
    values = {"f_D": f_d, "a": a, "B": b}
    if presliding is not None:
        certificates = [certificate("yielding_contact", **values, sigma_p=presliding)]
    elif a == 0:  # then c = f_D sgn v, and f_D <= f_C
        certificates = [certificate("ideal_contact_unsmoothed", f_C=least, f_D=f_d, B=b)]
    else:
        beyond = "" if f_d <= least + a * b else "_beyond"
        certificates = [certificate(f"ideal_contact{beyond}", f_C=least, **values)]
    if sampled:
        certificates.append(certificate("held_command", f_0=least, B=b))
    tight = (f_d - least - a * b) ** 2 == 4 * least * a * b and f_d >= least + a * b
    margin = 0.0 if tight else (math.sqrt(least) + math.sqrt(a * b)) ** 2 - float(f_d)
    equality = "at one speed" if tight else ""
    method = "abs(c(w)) <= f_0 + B abs(w) at every speed w"
    return Proof(method, tuple(certificates), margin, "N of level", equality)


def _strokes(
    law: tuple[float, float], friction: Coulomb | Dahl, b: float, period: float, late: int
) -> SteadyStrokes | None:
    """Strokes that release energy; None where double precision does not resolve any.

    law: f_D, N, and a, m/s. For a contact that deflects the speed is halved until strokes are short
    enough.
    """
    f_d, a = law
    least = friction.level if isinstance(friction, Coulomb) else 0.0
    speed = _fastest_gain(f_d, a, least, b)
    for _ in range(200 if isinstance(friction, Dahl) else 1):
        command = _COMMAND(speed, f_d, a)
        if command <= 0:  # a gain within rounding of its limit has no speed in double precision
            return None
        share = (command - least - b * speed) / command
        if share <= 0:
            return None
        # behind a reversal the late force opposes: over an eighth of the gain, at most
        one = period * speed
        travel = math.ceil(8 * (1 + late) / share) * one
        if isinstance(friction, Dahl):
            length = friction.level / friction.stiffness
            small = math.sqrt(min(share * command / friction.level, 1.0)) * length
            if travel > small:
                speed /= 2
                continue
            travel = math.floor(small / one) * one if one else small
        made = SteadyStrokes(f_d, a, friction, b, speed, travel or 1e-3, period, late)
        return made if made.energy > 1e-12 * command * made.travel else None
    return None


def _fastest_gain(f_d: float, a: float, least: float, b: float) -> float:
    """The speed at which c(v) - f_0 - B v is largest, m/s.

    Where c(v) - f_0 - B v has no maximum: a speed at which it is half of its upper bound.
    """
    if a and b:
        return math.sqrt(a * f_d / b) - a
    if a:
        return a * (f_d + least) / (f_d - least)
    return (f_d - least) / (2 * b) if b else 0.01


def claims(question: Question) -> list[TopicClaim]:
    """The claim for all values within the intervals, with the damping present at every speed.

    In a computer the velocity must be the plain difference of readings without steps.
    """
    device, law, computer = question.device, question.law, question.computer
    if law.smoothing is None or question.late is None:
        return []
    if computer is not None and (computer.encoder_step or not computer.takes_differences):
        return []
    if device.bristle_damping.high > 0:
        return []  # no theorem covers it beside a law of velocity
    claim = velocity_compensation(
        coulomb_level=device.lowest.low,
        compensator_level=law.bound,
        smoothing_velocity=law.smoothing,
        viscous_damping=device.damping.low,
        presliding_stiffness=device.presliding and device.presliding.low,
        sample_time=computer and computer.period,
        late=question.late,
    )
    time: Time = "sampled" if computer else "continuous"
    return [TopicClaim("law of velocity, with damping", claim, spends_damping=True, time=time)]
