"""A user's model, re-estimated; and the effects that it may lack, ranked."""

from __future__ import annotations

from ..measurement.experiment import Experiment
from ..measurement.prepare import prepare
from ..model import Model
from .corrected_fit import corrected_fit
from .ladder_state import search_for
from .rank import rank_candidates
from .ranking import Ranking
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
    """
    return corrected_fit(search_for(experiment, model, seed=seed)).model


def rank(model: Model, experiment: Experiment) -> Ranking:
    """Effects that the model may lack, best first.

    Each candidate is added to the model, and all free parameters are estimated again.
    returns: candidates with their fits and errors on fit and check records
    """
    prepared = prepare(experiment)
    return rank_candidates(estimate_stated(model, prepared), prepared)
