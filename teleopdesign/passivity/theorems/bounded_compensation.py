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

from ...base.errors import ModelError
from ..claims.claim import Claim, Evidence, Proof, Refutation, Unknown
from ..identified import IdentifiedDevice
from ..linear.impedance import decimal, exact
from ..rate_independent import Coulomb, Dahl, symmetric_cycle
from . import _dahl_certificates as shown
from ._cycle_simulation import simulate_cycle
from ._hypotheses import POSITIVE, require_hypotheses
from ._theorem import Question, Theorem, TopicClaim


@require_hypotheses(coulomb_level=POSITIVE, bound=POSITIVE)
def bounded_compensation(*, coulomb_level: Any, bound: Any) -> Claim:
    """Is Coulomb friction passive together with any compensator whose force is within a bound?

    The bound is the only condition, so the compensator may be sampled, delayed, quantised or driven
    by noise, with any stiffness.

    coulomb_level: f_C, N;  bound: f_D, N
    returns: proved if and only if f_D <= f_C; else refuted by a Dahl compensator in a cycle
    raises ModelError: an argument that is not > 0
    """
    f_c, f_d = positive_numbers(coulomb_level=coulomb_level, bound=bound)
    statement = (
        f"Coulomb friction {decimal(f_c)} N with any compensator within {decimal(f_d)} N is passive"
    )
    if f_d <= f_c:
        certificate = shown.bounded_compensator({"f_C": f_c, "f_D": f_d})
        return Claim(
            statement, proof_of_level("storage 0, abs(d) <= f_D <= f_C", f_d, f_c, certificate)
        )
    stiffest = Dahl(float(f_d), 1e3 * float(f_d))
    cycle = symmetric_cycle(
        stiffest, [Coulomb(float(f_c))], amplitude_beyond_onset(stiffest, float(f_c))
    )
    return Claim(statement, Refutation("a Dahl compensator of that level in a cycle", cycle))


def amplitude_beyond_onset(helps: Dahl, f_c: float) -> float:
    """An amplitude at which cycles release energy, m: twice the u with 1 - 1/u = f_C/f_D, about.

    u is the amplitude in bristle lengths. Levels that are equal as floats count as one unit in the
    last place apart. The energy of such a cycle is then lost in rounding, and refutes nothing.
    helps: the Dahl compensator;  f_c: Coulomb level, N
    """
    length = helps.level / helps.stiffness
    return length + 2 * length / max(1 - f_c / helps.level, 2.0**-52)


def proof_of_level(
    method: str, f_d: sp.Expr, f_c: sp.Expr, *certificates: Any, also: Sequence[str] = ()
) -> Proof:
    """A proof whose margin is f_C - f_D, N.

    also: further motions in which the inequality holds with equality
    """
    equality = " and ".join([*(["sliding"] if f_d == f_c else []), *also])
    text = f"in {equality}" if equality else ""
    return Proof(method, tuple(certificates), float(f_c - f_d), "N of level", text)


def positive_numbers(**values: Any) -> list[sp.Expr]:
    """The values as exact numbers; raises ModelError for a value that is not > 0."""
    numbers = []
    for name, value in values.items():
        number = exact(value)
        if number <= 0:
            raise ModelError(f"{name}: expected a number > 0, found {number}")
        numbers.append(number)
    return numbers


def _applies(question: Question) -> bool:
    """Whether the question is about a bounded law and ideal friction.

    For friction that deflects before it slides, a bound of the force alone is not sufficient.
    """
    return question.bound is not None and question.device.presliding is None


def _claims(question: Question) -> list[TopicClaim]:
    device, bound = question.device, question.bound
    assert bound is not None
    acting, time = device.acting_force(bound), question.time_of_bound
    claims = [TopicClaim("any law within the level", _compare_level(device, acting), time=time)]
    if question.estimates:
        claims.append(TopicClaim("the same, with damping", _compare_at_every_speed(device, acting)))
    return claims


def _covers(question: Question) -> Sequence[str]:
    """Effects of the actuation, where the bound of the acting force is known."""
    bound = question.bound
    assert bound is not None
    return () if math.isinf(question.device.acting_force(bound)) else question.device.actuation


def _compare_level(device: IdentifiedDevice, acting: float) -> Claim:
    """The claim that the friction level covers any law whose acting force is within `acting`, N."""
    if math.isinf(acting):
        why = "no bound is known of the force that the actuation makes of a command"
        return Claim("no law within the friction level drives a motion", Unknown(why))
    return bounded_compensation(coulomb_level=device.lowest.low, bound=acting)


def _compare_at_every_speed(device: IdentifiedDevice, acting: float) -> Claim:
    """The claim that level and damping together cover a law with a force within `acting`, N."""
    least, unit = device.least_resistance.low, device.force_unit.replace("*", " ")
    margin = least - acting
    statement = (
        f"ideal friction of the device and its viscous damping resist with more than "
        f"{acting:g} {unit} at every speed, so that no law within it drives a motion"
    )
    searched = (
        f"interval arithmetic: the resistance is at least {least:.4g} {unit} in the 95 % interval"
    )
    return Claim(statement, Evidence(margin >= 0, searched, margin, unit))


THEOREM = Theorem(
    mathematics=(bounded_compensation,),
    applies=_applies,
    claims=_claims,
    order=10,
    covers=_covers,
    simulate=simulate_cycle,
)
