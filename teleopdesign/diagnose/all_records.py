"""Whether an effect explains more than values that the fit records leave open.

A check record that moves as no fit record does is missed by a complete model too, where the fit
records do not tell its parameters: friction and damping at one speed, say. An effect that moves
these values may seem to explain it. So the model with the effect, and without it, is estimated on
all records together: there no value is open that any record tells, and the effect must still leave
surely less of the check records.
"""

from __future__ import annotations

from dataclasses import replace

from .criteria import CRITERIA, Criteria
from .decision import is_better
from .diagnosis import SetAside
from .fit import Fit, estimate
from .noise_floor import NoiseFloor
from .prepare import Prepared
from .rung import Rung


def estimable_on_all(prepared: Prepared) -> Prepared | None:
    """All records to estimate on, the check records to compare on; None: there are no two uses.

    Nor for an arm's joints: what the links share is taken out of the fit records.
    """
    fit, check = prepared.of("fit"), prepared.of("check")
    if not check or any(s.shared is not None or s.motion.links is not None for s in fit):
        return None
    both = tuple(replace(s, use="fit") for s in (*fit, *check))
    return Prepared(prepared.experiment, prepared.bandwidth, (*both, *check))


def explained_by_values(
    base: Fit,
    rung: Rung,
    prepared: Prepared,
    floor: NoiseFloor,
    *,
    criteria: Criteria = CRITERIA,
) -> SetAside | None:
    """The effect of a rung, and why it is none: the base explains as much by other values.

    base: the fit without the rung;  returns: None where the effect explains more
    """
    together = estimable_on_all(prepared)
    if together is None or rung.added is None:
        return None
    without, with_it = (estimate(fit.model, together) for fit in (base, rung.fit))
    if is_better(without, with_it, floor, criteria=criteria):
        return None
    reason = (
        "estimated on all records the model leaves "
        f"{100 * without.check_error:.3g} % of the check records without it, "
        f"{100 * with_it.check_error:.3g} % with it: the fit records leave its values open"
    )
    return SetAside(rung.added, rung.fit.check_error, reason)
