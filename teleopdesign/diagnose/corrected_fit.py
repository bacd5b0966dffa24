"""A fit corrected for the errors that sensor readings cause in its parameters."""

from __future__ import annotations

from ..measurement.prepare import Prepared
from .adequacy import is_adequate, limit_noise_floor
from .clock import with_paying_shift
from .effort import EFFORTS
from .evidence import check_squares
from .fit import Fit, estimate, fit_squares
from .ladder_state import LadderSearch
from .noise_floor import NoiseFloor, noise_floor
from .ranking import Ranking
from .reading_error import with_reading_error
from .search_plan import PLAN
from .stated_fit import estimate_stated


def corrected_fit(search: LadderSearch) -> Fit:
    """The corrected fit of the stated model, as a diagnosis that adds no effect reports it."""
    fit = estimate_stated(search.stated, search.prepared)
    fit = with_paying_shift(fit, search.prepared)
    drawn = noise_floor(fit.model, search.prepared, search.generator())
    return correct_fit(search, fit, limit_noise_floor(drawn, fit, Ranking(fit, ())))


def correct_fit(search: LadderSearch, fit: Fit, floor: NoiseFloor) -> Fit:
    """A fit without its reading error if it leaves only noise; else with wider standard errors.

    The standard errors are widened too where the corrected fit leaves clearly more
    (`Criteria.of_floor`). Then the simulated readings do not describe the recorded ones.
    """
    criteria = search.criteria
    fit = _with_parts_in_order(fit, search.prepared)
    most = (1.0 + criteria.of_floor) * check_squares(fit)

    def leaves_noise(other: Fit) -> bool:
        return is_adequate(other, floor, criteria=criteria) and check_squares(other) <= most

    return with_reading_error(fit, search.prepared, search.generator(), adequate=leaves_noise)


def _with_parts_in_order(fit: Fit, prepared: Prepared) -> Fit:
    """The fit with interchangeable parts of its effects in order, if it leaves no more.

    Beside friction that varies with the speed the parts are not quite the same: one of them varies.
    """
    model = fit.model.in_order()
    if model is fit.model:
        return fit
    ordered = estimate(model, prepared, effort=EFFORTS.stay)
    alike = fit_squares(ordered) <= (1.0 + PLAN.elsewhere) * fit_squares(fit)
    return ordered if alike else fit
