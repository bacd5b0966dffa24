"""Direction of a coupling between two joints: do the records distinguish it from the reverse one?

A coupling that acts alike in both directions may be a part of the links' inertia. Then a force at
one joint by the motion of another leaves the same as the opposite force at that other joint: the
base parameters of the links describe the rest.
"""

from __future__ import annotations

from .candidates import Candidate
from .other_motion import follows_another, with_other_motions
from .parts import PreparedParts
from .parts_fit import PartsFit, PartsRung, estimate_parts
from .statements import Undetermined


def undetermined_coupling(
    rung: PartsRung, last: PartsFit, prepared: PreparedParts, *, relevant: float
) -> Undetermined | None:
    """A statement where the records do not determine the direction of an added coupling; else None.

    last: the fit with all added effects;  relevant: part of the squares that counts as a difference
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
    if turned.check_error**2 > (1.0 + relevant) * last.check_error**2:
        return None
    there = Candidate(added.effect, other)
    return Undetermined(
        added,
        f"{there} by the motion of {added.at} leaves {100 * turned.check_error:.3g} % of the arm's "
        f"forces instead of {100 * last.check_error:.3g} %: parameters of the links can imitate a "
        "coupling that acts both ways",
    )
