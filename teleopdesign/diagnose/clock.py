"""Whether a shift of the records' clock pays: it counts only where it explains unseen records.

Estimated on the fit records beside a model that lacks much, a shift may take up a part of what is
missing, as a wrong effect would. Like an effect it must not raise the error on the check records.
"""

from __future__ import annotations

from ..blocks import Value
from .fit import Fit, estimate
from .prepare import Prepared


def with_paying_shift(fit: Fit, prepared: Prepared) -> Fit:
    """The fit with each body's shift estimated, or held at none, whichever leaves less unseen.

    fit: with shifts of either kind;  returns: the fit itself where the other kind leaves no less
    """
    for place, late in fit.model.record_shift.items():
        other = Value(0.0) if late.fixed else Value(0.0, fixed=True)
        shifts = {**fit.model.record_shift, place: other}
        again = estimate(fit.model.with_record_shift(shifts), prepared)
        if again.check_error < fit.check_error:
            fit = again
    return fit
