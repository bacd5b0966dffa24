"""Claims over a box for friction with its cancellation: the vertices of the box decide.

A Dahl or bounded cancellation (f_D, sigma_D) of Coulomb or Dahl friction (f_C, sigma_p) is passive
if f_D <= f_C and sigma_D^2 f_C <= sigma_p^2 f_D (`theorems/dahl_compensation.py`). Written as
f_C - f_D >= 0 and sigma_p^2 f_D - sigma_D^2 f_C >= 0, each left side is monotone in each of the
four positive values alone, so its least value over a box is at a vertex. The linear part of the
diagram is judged over the whole box. Any other friction is judged only at the vertices and in the
middle.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...blocks import Body
from ...controllers import laws_that_declare
from ...diagrams import Diagram
from ..claims.claim import Claim
from ..diagram_claims import FrictionPair, composed_claim, friction_pairs, pair_claims
from ..linear.conditions import is_shown
from ..linear.family import family_of_states
from ..linear.signs import Signs
from ..ports import drop_absent_effects, nonlinear_parts, ports, without_friction
from .box import IntervalClaim, ValueBox
from .linear import states_over
from .worst import Worst, interval_claim

#: effects that the two conditions cover completely, with their values
_FRICTION: dict[str, tuple[str, ...]] = {"coulomb": ("level",), "presliding": ("stiffness",)}


def judge_friction(middle: Diagram, box: ValueBox, claim: str) -> IntervalClaim:
    """Judge the passivity (or absolute stability) of a diagram with friction over a box.

    claim: "passive" or "absolutely stable"
    """
    points = [*box.vertices(), box.centre]
    answers = [(point, *_claims_at(middle.with_values(box.named(point)))) for point in points]
    worst = Worst(box.centre, float("nan"), len(points))
    statement = f"its ports are {'together ' * (claim == 'passive')}{claim}"
    for point, whole, others in answers:
        # what takes energy out of friction at one port need not make any termination unstable
        against = [c for c in others if c.status == "refuted" and claim == "passive"]
        if whole is None and against:
            how = f"{against[0].statement}: {against[0].verdict}"
            there = replace(worst, point=point)
            return interval_claim(statement, "refuted", there, box, "", how, at_worst=against[0])
    if any(whole is None for _, whole, _ in answers):
        why = "at some vertex neither a theorem nor a motion settles friction with its cancellation"
        return interval_claim(statement, "unknown", worst, box, "", why)
    if _vertices_decide(middle, box) and _rest_is_passive(middle, box):
        how = (
            "each condition on friction and cancellation is monotone in each value, so that the "
            f"{len(points) - 1} vertices decide; the linear rest by Bernstein coefficients"
        )
        return interval_claim(statement, "proved", worst, box, "", how, at_worst=answers[-1][1])
    how = "proved at each of these points alone"
    return interval_claim(statement, "evidence", worst, box, "", how, at_worst=answers[-1][1])


def _claims_at(diagram: Diagram) -> tuple[Claim | None, list[Claim]]:
    """The proof from the parts of a diagram (None: no such proof), and claims on its friction."""
    there = drop_absent_effects(diagram)
    pairs = friction_pairs(there)
    composed = composed_claim(there, ports(there), pairs)
    others = [one.claim for pair in pairs for one in pair_claims(pair, simulated=False)]
    return (composed.claim if composed else None), others


def _vertices_decide(middle: Diagram, box: ValueBox) -> bool:
    """Whether the two conditions, and so the vertices, decide for all values of friction."""
    for pair in friction_pairs(drop_absent_effects(middle)):
        body, law = pair.body.body, pair.cancellation
        assert isinstance(body, Body)
        effects = {e.name for e in body.effects if e.role.startswith("friction")}
        if not effects <= set(_FRICTION) or body.parameters.get("presliding.bristle_damping"):
            return False
        if law is None:
            continue
        # a law of one's own keeps its bound at the values that were looked at, no more is known
        if pair.stage is None or pair.stage.law not in laws_that_declare("bound"):
            return False
        known = {pair.stage.name: (pair.stage.law.bound, pair.stage.law.bristle_stiffness)}
        for name in box.names:
            block, _, rest = name.partition(".")
            if block == law.name and not _is_of(rest, known):
                return False
    return bool(len(box.vertices()) == 2 ** len(box.names))


def _is_of(name: str, known: Mapping[str, tuple[str, ...]]) -> bool:
    part, _, value = name.rpartition(".")
    return value in known.get(part, ())


def _belongs_to_friction(name: str, pairs: list[FrictionPair]) -> bool:
    """Whether a value belongs to friction or its cancellation, and not to the linear rest."""
    block, _, rest = name.partition(".")
    laws = [pair.cancellation.name for pair in pairs if pair.cancellation is not None]
    bodies = [pair.body.name for pair in pairs]
    return block in laws or (block in bodies and _is_of(rest, _FRICTION))


def _rest_is_passive(middle: Diagram, box: ValueBox) -> bool:
    """Whether the diagram without friction and cancellation is passive over the whole box."""
    rest = drop_absent_effects(middle)
    pairs = friction_pairs(rest)
    for pair in pairs:
        gone = [pair.cancellation.name] if pair.cancellation else []
        rest = without_friction(rest, pair.body.motion, *gone)
    other_values = tuple(n for n in box.names if not _belongs_to_friction(n, pairs))
    if nonlinear_parts(rest):
        return False
    if not other_values:
        return True  # it is proved in the composed claim
    within = box.select(other_values)
    states = states_over(rest, within)
    if states is None or states.times:
        return False
    family = family_of_states(states, ports(rest), within.names, within.exact)
    return is_shown(Signs(within.exact), family, "passive")
