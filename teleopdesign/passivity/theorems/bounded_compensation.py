"""Ideal friction is passive with any compensator whose force is within the friction level.

At any speed friction opposes the motion with at least f_C, and the compensator helps with at most
f_D. So f_D <= f_C is sufficient. Above this bound a Dahl compensator of level f_D releases energy.
For a device the theorem is applied to its friction level, and to the level together with its
viscous damping.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import sympy as sp

from ..claims.claim import Claim, Evidence, Proof, Unknown
from ..linear.impedance import decimal, exact
from ..rate_independent import Coulomb, Cycle, Dahl, symmetric_cycle
from ._hypotheses import Positive, certificate, require_hypotheses
from ._theorem import Question, TopicClaim, decide

ORDER = 10

#: N/m for each N of level: a bristle so stiff that its length does not matter to a hand
_STIFFEST = 1e3


@require_hypotheses
def bounded_compensation(*, coulomb_level: Positive, bound: Positive) -> Claim:
    """Is Coulomb friction passive together with any compensator whose force is within a bound?

    The bound is the only condition, so the compensator may be sampled, delayed, quantised or driven
    by noise, with any stiffness.

    coulomb_level: f_C, N;  bound: f_D, N
    returns: proved if and only if f_D <= f_C; else refuted by a Dahl compensator in a cycle
    """
    f_c, f_d = coulomb_level, bound
    return decide(
        f"Coulomb friction {decimal(f_c)} N with any compensator within {decimal(f_d)} N is "
        "passive",
        f_d <= f_c,
        proof=lambda: proof_of_level(
            "storage 0, abs(d) <= f_D <= f_C",
            f_d,
            f_c,
            certificate("bounded_compensator", f_C=f_c, f_D=f_d),
        ),
        motion=lambda: cycle_beyond_onset(Dahl(float(f_d), _STIFFEST * float(f_d)), float(f_c)),
        how="a Dahl compensator of that level in a cycle",
    )


def cycle_beyond_onset(helps: Dahl, f_c: float) -> Cycle:
    """A cycle that releases energy: of twice the amplitude u with 1 - 1/u = f_C/f_D, about.

    u is in bristle lengths. Levels that are equal as floats count as one unit in the last place
    apart. The energy of such a cycle is then lost in rounding, and refutes nothing.
    helps: the Dahl compensator;  f_c: Coulomb level, N
    """
    length = helps.level / helps.stiffness
    amplitude = length + 2 * length / max(1 - f_c / helps.level, 2.0**-52)
    return symmetric_cycle(helps, [Coulomb(f_c)], amplitude)


def proof_of_level(
    method: str, f_d: sp.Expr, f_c: sp.Expr, *certificates: Any, also: Sequence[str] = ()
) -> Proof:
    """A proof whose margin is f_C - f_D, N.

    also: further motions in which the inequality holds with equality
    """
    equality = " and ".join([*(["sliding"] if f_d == f_c else []), *also])
    text = f"in {equality}" if equality else ""
    return Proof(method, tuple(certificates), float(f_c - f_d), "N of level", text)


def claims(question: Question) -> list[TopicClaim]:
    """The claim about any law within the bound of the law, and the same with viscous damping."""
    device, bound = question.device, question.law.bound
    # for friction that deflects before it slides, a bound of the force alone is not sufficient
    if bound is None or device.presliding is not None:
        return []
    acting, time = device.acting_force(bound), question.time_of_bound
    topic = "any law within the level"
    if math.isinf(acting):
        why = "no bound is known of the force that the actuation makes of a command"
        claim = Claim("no law within the friction level drives a motion", Unknown(why))
        return [TopicClaim(topic, claim, time=time, of_any_law=True)]
    covers = device.actuation  # the bound of the acting force is known
    claim = bounded_compensation(coulomb_level=device.lowest.low, bound=acting)
    first = TopicClaim(topic, claim, time=time, of_any_law=True, covers=covers)
    if not question.estimates:
        return [first]
    least, unit = device.least_resistance.low, device.unit("force").replace("*", " ")
    statement = (
        f"ideal friction of the device and its viscous damping resist with more than "
        f"{decimal(exact(acting))} {unit} at every speed, so that no law within it drives a motion"
    )
    searched = (
        f"interval arithmetic: the resistance is at least {least:.4g} {unit} in the 95 % interval"
    )
    damped = Claim(statement, Evidence(least >= acting, searched, least - acting, unit))
    return [first, TopicClaim("the same, with damping", damped, of_any_law=True, covers=covers)]
