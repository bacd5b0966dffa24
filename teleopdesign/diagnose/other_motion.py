"""The motion of another joint that may act on a joint: a channel of its records for `coupling`.

By geared wrists, differentials and cables that pass a joint, one motor can push another's joint.
The kinematics do not say which one. So `other_position` of a joint is the motion of that joint
whose coupling promises the largest gain by one linear step. A joint whose log has such a channel
keeps this channel.

A coupling that acts alike in both directions may be a part of the links' inertia. Then a force at
one joint by the motion of another leaves the same as the opposite force at that other joint: the
base parameters of the links describe the rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..base.sentences import percent
from ..effects import Effect
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate
from .criteria import CRITERIA
from .fit import Fit
from .linear_start import linear_starts
from .parts import PreparedParts
from .parts_fit import PartsFit, PartsRung, estimate_parts
from .statements import Undetermined


def follows_another(effect: Effect) -> bool:
    """Whether the laws of an effect need the motion of another joint."""
    return "other_position" in effect.channels()


def with_other_motions(prepared: PreparedParts, others: Mapping[str, str]) -> PreparedParts:
    """The arm's records, where some joints have the motion of another joint as a channel.

    others: joint -> the other joint
    """
    joints = {
        j: with_other_motion(records, prepared.parts[others[j]]) if j in others else records
        for j, records in prepared.parts.items()
    }
    return replace(prepared, parts=joints, others={**prepared.others, **others})


def with_other_motion(records: Prepared, other: Prepared) -> Prepared:
    """A joint's records with the motion of another joint at the same rows as a channel."""
    stretches = []
    for mine, its in zip(records.stretches, other.stretches, strict=True):
        there = {
            f"other_{name}": getattr(its.motion, name)
            for name in ("position", "velocity", "acceleration")
        }
        motion = replace(mine.motion, further={**mine.motion.further, **there})
        stretches.append(replace(mine, motion=motion))
    return replace(records, stretches=tuple(stretches))


def most_coupled(joint: str, records: Prepared, fit: Fit, prepared: PreparedParts) -> str | None:
    """The other joint with the largest predicted gain of a coupling at a joint.

    records, fit: of the joint, with the information of the other joints on the links
    returns: None where the log has the motion of another joint, or no effect needs one
    """
    if any("other_position" in s.motion.further for s in prepared.parts[joint].stretches):
        return None
    effects = [e for e in fit.model.known.values() if _asks(e, fit.model, joint)]
    kinds, promised = prepared.experiment.bodies, dict[str, float]()
    for name, other in prepared.parts.items():
        if name == joint or kinds[name].axis != kinds[joint].axis:
            continue
        beside = with_other_motion(records, other)
        for effect in effects:
            model = fit.model.with_effect(effect, at=joint)
            ((left, _),) = linear_starts([model], effect, joint, beside, fit)
            promised[name] = min(left, promised.get(name, left))
    return min(promised, key=lambda name: promised[name], default=None)


def _asks(effect: Effect, model: Model, joint: str) -> bool:
    """Whether an effect that a joint lacks is linear in its strength and needs another motion."""
    return (
        follows_another(effect)
        and effect.strength is not None
        and not model.body(joint).has(effect.name)
    )


def undetermined_coupling(
    rung: PartsRung, last: PartsFit, prepared: PreparedParts
) -> Undetermined | None:
    """A statement where the records do not determine the direction of an added coupling; else None.

    last: the fit with all added effects
    """
    added, other = rung.added, rung.follows
    if added is None or other is None:
        return None
    models = {j: fit.model for j, fit in last.fits.items()}
    if any(follows_another(e) for e in models[other].body(other).effects):
        return None
    models[added.at] = models[added.at].without_effect(added.effect.name, at=added.at)
    models[other] = models[other].with_effect(added.effect, at=other)
    turned = estimate_parts(models, with_other_motions(prepared, {other: added.at}))
    if turned.check_error**2 > (1.0 + CRITERIA.relative_improvement) * last.check_error**2:
        return None
    there = Candidate(added.effect, other)
    return Undetermined(
        added,
        f"{there} by the motion of {added.at} leaves {percent(turned.check_error, '.3g')} of the "
        f"arm's forces instead of {percent(last.check_error, '.3g')}: parameters of the links can "
        "imitate a coupling that acts both ways",
    )
