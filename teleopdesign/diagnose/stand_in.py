"""Effects that lower the error without explaining it: they imitate something else.

Values that the fit records do not determine (for example friction and damping, at one speed): if a
check record moves as no fit record does, a complete model has an error there too. An effect that
changes these values may seem to explain the error. So the model is estimated on all records
together, with the effect and without it. The effect must still leave less of the check records, and
surely less of all records, for all were fitted.

Errors of the readings: a structure transmits less of the noise in an acceleration. The error may
    then be smaller, and yet be more noise floors of the new model. In a record with few events (a
    motor that sticks and slips under a coarse encoder) a lag may follow the errors themselves.
"""

from __future__ import annotations

from dataclasses import replace

from ..base.sentences import percent
from ..measurement.prepare import Prepared
from .criteria import CRITERIA
from .decision import is_better
from .error import force_error
from .fit import Fit, estimate
from .noise_floor import NoiseFloor, say_floors
from .rung import Rung
from .statements import SetAside


def estimable_on_all(prepared: Prepared) -> Prepared | None:
    """All records, each as a fit record and for comparison; None: no check records.

    None for an arm's joints too: their shared link parameters belong to the fit records.
    """
    if not prepared.of("check") or prepared.is_linked:
        return None
    records = (*prepared.of("fit"), *prepared.of("check"))
    both = (replace(s, use=use) for use in ("fit", "check") for s in records)
    return Prepared(prepared.experiment, prepared.bandwidth, tuple(both))


def check_error_on_all(fit: Fit, prepared: Prepared) -> float | None:
    """Check error of a model estimated on all records; None as in `estimable_on_all`."""
    together = estimable_on_all(prepared)
    if together is None:
        return None
    return force_error(estimate(fit.model, together).model, prepared.of("check"))


def stands_in_for_values(
    base: Fit, rung: Rung, prepared: Prepared, floor: NoiseFloor
) -> SetAside | None:
    """The effect of a rung that other values of the base explain as well, with the reason.

    base: the fit without the rung;  returns: None where the effect explains more
    """
    together = estimable_on_all(prepared)
    if together is None or rung.added is None:
        return None
    without, with_it = (estimate(fit.model, together) for fit in (base, rung.fit))
    before, after = (force_error(f.model, prepared.of("check")) for f in (without, with_it))
    falls = after**2 < (1.0 - CRITERIA.relative_improvement) * before**2
    if falls and is_better(without, with_it, floor):
        return None
    reason = (
        f"a fit to all records leaves {percent(before, '.3g')} of the check records without it, "
        f"{percent(after, '.3g')} with it: the fit records do not determine its values"
    )
    return SetAside(rung.added, rung.fit.check_error, reason)


def stands_in_for_readings(
    base: Fit, before: NoiseFloor, rung: Rung, after: NoiseFloor
) -> SetAside | None:
    """The effect of a rung that only weakens the error of sensor readings, with the reason.

    before, after: the noise floors of the two models, as drawn
    Where the readings alone explain the error of the base, an effect that weakens their error must
    leave surely fewer noise floors.
    returns: None where the effect leaves fewer noise floors too, or the base more than noise
    """
    if rung.added is None or not (before.drawn and after.drawn):
        return None
    left, leaves = base.check_error / before.drawn, rung.fit.check_error / after.drawn
    if not is_of_readings(left):
        return None
    if after.drawn < CRITERIA.weakened * before.drawn:
        explains = leaves <= CRITERIA.weakened * left
    else:
        explains = leaves <= CRITERIA.adequate or CRITERIA.weakened * leaves <= left
    if explains:
        return None
    floors, without = say_floors(leaves, ".2g"), say_floors(left, ".2g")
    reason = (
        f"lowers the error from the readings of the sensors, from {100 * before.drawn:.2g} to "
        f"{percent(after.drawn, '.2g')} of the force, but leaves {floors} noise floors, "
        f"{without} without it"
    )
    return SetAside(rung.added, rung.fit.check_error, reason, of_readings=True)


def is_of_readings(floors: float) -> bool:
    """Whether the readings alone explain an error of so many noise floors.

    A floor is known to a fifth. Where even less is left, the values of the model make more of the
    readings' errors than these can contain, and say nothing.
    """
    return CRITERIA.weakened <= floors <= CRITERIA.adequate
