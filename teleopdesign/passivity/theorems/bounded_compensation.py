"""Any compensator whose force is bounded by the level of ideal friction is passive with it.

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

from ...errors import ModelError
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
    """Is Coulomb friction passive beside any compensator whose force stays within `bound`?

    It needs nothing but the bound: so it also holds for a compensator that is sampled, delayed,
    quantised or driven by noise, whatever its stiffness. N.
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
    """An amplitude at which cycles release energy, m: 1 - 1/u = f_C/f_D, doubled.

    Levels that floats do not tell from each other count as one unit in the last place apart: what
    such a cycle releases is then lost in rounding, and refutes nothing.
    """
    length = helps.level / helps.stiffness
    return length + 2 * length / max(1 - f_c / helps.level, 2.0**-52)


def proof_of_level(
    method: str, f_d: sp.Expr, f_c: sp.Expr, *certificates: Any, also: Sequence[str] = ()
) -> Proof:
    """The margin is that of the level; equality also where small motion just stores."""
    equality = " and ".join([*(["sliding"] if f_d == f_c else []), *also])
    text = f"in {equality}" if equality else ""
    return Proof(method, tuple(certificates), float(f_c - f_d), "N of level", text)


def positive_numbers(**values: Any) -> list[sp.Expr]:
    """The values as exact numbers; ModelError for one that is not > 0."""
    numbers = []
    for name, value in values.items():
        number = exact(value)
        if number <= 0:
            raise ModelError(f"{name}: expected a number > 0, found {number}")
        numbers.append(number)
    return numbers


def _applies(question: Question) -> bool:
    """To a bounded law beside ideal friction; no bound on the force alone covers presliding."""
    return question.bound is not None and question.device.presliding is None


def _claims(question: Question) -> list[TopicClaim]:
    device, bound = question.device, question.bound
    assert bound is not None
    acting = device.acting_force(bound)
    claims = [TopicClaim("any law within the level", _compare_level(device, acting), time="any")]
    if question.estimates:
        claims.append(
            TopicClaim("the same, damping counted", _compare_at_every_speed(device, acting))
        )
    return claims


def _covers(question: Question) -> Sequence[str]:
    """What makes a force of the command, where its bound is known."""
    bound = question.bound
    assert bound is not None
    return () if math.isinf(question.device.acting_force(bound)) else question.device.actuation


def _compare_level(device: IdentifiedDevice, acting: float) -> Claim:
    """Whether the friction level covers any law that acts with no more than that, N."""
    if math.isinf(acting):
        why = "no bound is known of the force that the actuation makes of a command"
        return Claim("no law within the friction level drives a motion", Unknown(why))
    return bounded_compensation(coulomb_level=device.lowest.low, bound=acting)


def _compare_at_every_speed(device: IdentifiedDevice, acting: float) -> Claim:
    """Whether level and damping together cover a law that acts with no more than that, N."""
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
