"""Passivity of a body driven by a sampled controller through a zero-order hold.

The position is sampled with period T. The force -H(z) times this position is held until the next
sample. Over a sample of travel d the held force takes f d, and the damping b takes at least b d^2/T
(least at constant speed). A spring K_0 of the body adds K_0 (x d + d^2/2). So the body is passive
if and only if the operator

    G(z) = (H(z) + K_0)/(z - 1) + K_0/2 + b/T      from travel to force

is positive real in the discrete sense, for any b >= 0 and inertia. On the unit circle that reads

    b >= T/2 / (1 - cos wT)  Re[(1 - e^(-j w T)) H(e^(j w T))],    and at z = 1: H(1) + K_0 >= 0

(Colgate and Schenkel, J. Robotic Systems 14 (1997) 37). With z = (1 + s)/(1 - s) it becomes the
positive-real test of a rational function, which is exact; equality is passive too.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...controllers import from_control
from ...realise.lti import S
from ..claims.claim import Claim, Proof, Unknown
from ..linear.excess import damping_excess
from ..linear.family import family_of_impedance
from ..linear.impedance import Impedance, decimal, exact, impedance, read_expression, readable
from ..linear.judge import NO_WAVE, prove
from ..rate_independent import strongest
from ..search.growing_wave import Z, sampled_wave
from ..search.points import waves_out_of
from ._hypotheses import Free, NonNegative, Positive, Real, require_hypotheses
from ._theorem import Question, TopicClaim, refute

ORDER = 30

#: most waves of which the motion at the samples is made
_MOST = 2
#: relative difference of two periods that counts as rounding of decimals
_ROUNDING = 1e-9


@require_hypotheses
def sampled_passivity(
    controller: Free, *, damping: NonNegative, sample_time: Positive, stiffness: Real = 0
) -> Claim:
    """Is the body with this sampled controller passive at the hand?

    controller: H(z), rational in z: held force against the motion (N) over position (m); delays
        are factors z^-1; or a discrete system of python-control
    damping: b of the body, N s/m, >= 0: no controller can stop a negative damper between samples
    sample_time: T, s;  stiffness: spring K_0 of the body, N/m
    returns: proved, refuted by a motion at the samples, or unknown
    raises ModelError: not rational in z, or an argument outside of its hypothesis
    """
    late, b, k = sample_time, damping, stiffness
    law = law_in_z(controller, sample_time=float(late))
    operator = travel_operator(law, b, late, k)
    spring = f", a spring {decimal(k)} N/m" if k else ""
    statement = (
        f"a body with damping {decimal(b)} N s/m{spring} and the sampled force -({readable(law)}) "
        f"x, held for {decimal(late)} s, is passive"
    )
    family = family_of_impedance(operator)
    verdict = prove(family, "passive", f"{statement}: G((1 + s)/(1 - s)) is positive real")
    if verdict is not None:
        margin = float(late) * verdict.margin
        if isinstance(verdict, Proof):
            method = "the discrete positive-real test, by bilinear transformation"
            equality = "" if margin > 0 else "in the damping"
            verdict = replace(verdict, method=method, equality=equality)
        return Claim(statement, replace(verdict, margin=margin))
    made = (
        sampled_wave(law, b, late, k, wave.rate, wave.frequency)
        for wave in islice(waves_out_of(family), _MOST)
    )
    first = next(made, None)
    motion = first if first is None or first.energy > 0 else strongest(made) or first
    return refute(
        statement,
        motion,
        lambda motion: (
            f"travel that grows by {abs(motion.factor):.6g} a sample and turns by "
            f"{np.angle(motion.factor):.4g} rad"
        ),
        NO_WAVE,
    )


def required_damping(controller: Any, *, sample_time: Any, stiffness: Any = 0) -> float:
    """Least damping (N s/m, >= 0) with which the body is passive; inf where none is sufficient.

    Arguments as in `sampled_passivity`.
    """
    late = exact(sample_time, "sample_time: ")
    if late <= 0:
        raise ModelError(f"sample_time: expected a time > 0 s, found {late}")
    law = law_in_z(controller, sample_time=float(late))
    held = exact(stiffness, "required_damping: stiffness: ")
    operator = travel_operator(law, sp.S(0), late, held)
    return max(-float(late) * float(damping_excess(operator)), 0.0)


@require_hypotheses
def sampled_coupling(
    coupling: Free,
    *,
    master_damping: NonNegative,
    slave_damping: NonNegative,
    sample_time: Positive,
) -> Claim:
    """Is a teleoperator passive whose equal and opposite forces -H(z) (x_m - x_s) are sampled?

    The least loss over a travel of x_m - x_s is that of a damping b_m b_s/(b_m + b_s).

    coupling: H(z), N/m, as in `sampled_passivity`
    master_damping, slave_damping: b_m, b_s, N s/m;  sample_time: s
    """
    b_m, b_s = master_damping, slave_damping
    both = b_m * b_s / (b_m + b_s) if b_m + b_s else sp.S(0)
    return sampled_passivity(coupling, damping=both, sample_time=sample_time)


def travel_operator(law: sp.Expr, b: sp.Expr, late: sp.Expr, k: sp.Expr) -> Impedance:
    """G(z) from travel over a sample to force (N/m), at z = (1 + s)/(1 - s)."""
    g = (law + k) / (Z - 1) + k / 2 + b / late
    return impedance(g.subs(Z, (1 + S) / (1 - S)))


def law_in_z(controller: Any, *, sample_time: float) -> sp.Expr:
    """H(z) with exact numbers: of an expression, or of a discrete system of python-control.

    sample_time: period that the system must have, s
    raises ModelError: not rational, or ahead of its samples; a system in continuous time, or of
        another period, several inputs or outputs, or a mode that the transfer function hides
    """
    if hasattr(controller, "dt") and hasattr(controller, "nstates"):
        controller = _transfer_function(controller, sample_time)
    e = read_expression(controller, Z, "controller")
    above, below = sp.fraction(sp.together(e))
    if not (above.is_polynomial(Z) and below.is_polynomial(Z)) or below == 0:
        raise ModelError(f"controller: expected a rational function of z, found {e}")
    e = sp.cancel(e)
    above, below = (sp.Poly(part, Z) for part in sp.fraction(e))
    if above.degree() > below.degree():
        raise ModelError(f"controller: needs samples of the future: {e}")
    return e


def _transfer_function(system: Any, sample_time: float) -> sp.Expr:
    if not system.isdtime(strict=True):
        raise ModelError(
            "controller: found a system in continuous time, expected one in discrete time: "
            "`control.sample_system` makes one"
        )
    if system.dt is not True and abs(system.dt - sample_time) > _ROUNDING * sample_time:
        raise ModelError(
            f"controller: is sampled every {system.dt * 1e3:g} ms, the body every "
            f"{sample_time * 1e3:g} ms: sample both alike"
        )
    (stage,) = from_control(system, name="controller").stages
    if stage.law.shift is None:
        raise ModelError("controller: expected a transfer function or a state space")
    law = sp.cancel(stage.law.shift(stage.values, Z))
    if sp.degree(sp.fraction(law)[1], Z) < len(stage.law.states):
        raise ModelError(
            "controller: has a mode that its transfer function does not show, and which may grow: "
            "give its least form (`control.minreal`)"
        )
    return law


def claims(question: Question) -> list[TopicClaim]:
    """Claims about a virtual wall with damping alone, and about a Dahl bristle in small motion.

    In small motion the bristle is a negative spring.
    """
    device, computer, wall = question.device, question.computer, question.wall
    if computer is None or question.late is None:
        return []
    period, answers = computer.period, []
    if wall is not None:
        law = sp.Float(wall.stiffness) + sp.Float(wall.damping) * (Z - 1) / (period * Z)
        law = law * Z**-question.late
        claim = sampled_passivity(law, damping=device.damping.low, sample_time=period)
        if wall.damping and not computer.takes_differences:
            why = "the theorem takes the velocity of the wall from the difference of two readings"
            claim = Claim(claim.statement, Unknown(why))
        answers.append(TopicClaim("virtual wall, damping alone", claim, time="sampled"))
    if question.bristle is not None and device.presliding is not None:
        claim = sampled_passivity(
            -sp.Float(question.bristle[1]) * Z**-question.late,
            damping=device.damping.low,
            sample_time=period,
            stiffness=device.presliding.low,
        )
        answers.append(TopicClaim("small motion, sampled", claim, time="sampled"))
    if not computer.encoder_step:
        return answers
    exactly = "with readings that have no steps"
    return [
        replace(one, claim=replace(one.claim, statement=f"{one.claim.statement}, {exactly}"))
        for one in answers
    ]
