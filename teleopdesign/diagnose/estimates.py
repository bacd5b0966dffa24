"""A user's model, re-estimated and corrected for errors of the readings; and what it may lack."""

from __future__ import annotations

from ..measurement.experiment import Experiment
from ..measurement.prepare import prepare
from ..model import Model
from .candidates import restrict_to_curve
from .criteria import CRITERIA
from .evidence import check_squares, is_adequate, limit_noise_floor
from .fit import Fit
from .ladder_state import LadderSearch, search_for
from .noise_floor import NoiseFloor, noise_floor
from .rank import rank_candidates
from .ranking import Ranking
from .reading_error import with_reading_error
from .stated_fit import estimate_stated


def fit(model: Model, experiment: Experiment, *, seed: int = 0) -> Model:
    """The model with its free parameters re-estimated on the fit records, with standard errors.

    Effects that `with_effect` added without values start from values of the size that the records
    show.
    As in `find_missing`, errors of the sensor readings are corrected: where the model leaves only
    noise, their effect on the estimates is subtracted; where it leaves more, they widen the
    standard errors. Of long records, only windows are fitted.

    seed: of the random numbers for the noise floor and for the simulated readings
    raises ExperimentError: the experiment lacks what the comparison needs

        >>> experiment = td.load_experiment(td.example("rod"))
        >>> td.fit(td.Model.from_experiment(experiment), experiment)
        Model
          device.inertia = 0.1978 +- 0.0012 kg
          device.coulomb.level = 0.6464 +- 0.0082 N
          device.viscous.damping = 1.223 +- 0.092 N*s/m
    """
    search = search_for(experiment, model, seed=seed)
    fit = estimate_stated(search.stated, search.prepared)
    if not search.is_of_body_in_time:
        return fit.model
    drawn = noise_floor(fit.model, search.prepared, search.generator())
    return correct_fit(search, fit, limit_noise_floor(drawn, fit, Ranking(fit, ()))).model


def rank(model: Model, experiment: Experiment) -> Ranking:
    """Effects that the model may lack, best first.

    Each candidate is added to the model, and all free parameters are estimated again.
    returns: candidates with their fits and errors on fit and check records
    """
    prepared = prepare(experiment)
    model = restrict_to_curve(model) if prepared.is_curve else model
    return rank_candidates(estimate_stated(model, prepared), prepared)


def correct_fit(search: LadderSearch, fit: Fit, floor: NoiseFloor) -> Fit:
    """A fit without its reading error if it leaves only noise; else with wider standard errors.

    The standard errors are widened too where the corrected fit leaves clearly more
    (`Criteria.of_floor`). Then the simulated readings do not describe the recorded ones.
    """
    most = (1.0 + CRITERIA.of_floor) * check_squares(fit)

    def leaves_noise(other: Fit) -> bool:
        return is_adequate(other, floor) and check_squares(other) <= most

    return with_reading_error(fit, search.prepared, search.generator(), adequate=leaves_noise)
