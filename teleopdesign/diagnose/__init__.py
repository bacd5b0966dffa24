"""Compare a model with an experiment, see where it fails, and find the effect that is missing."""

from __future__ import annotations

from ..arguments import check_arguments
from ..measurement.experiment import Experiment
from ..model import Model
from .arms import ArmDiagnosis, find_missing_in_arm
from .by_simulation import HorizonError, RecordedLoop, SimulationComparison
from .comparison import Comparison, compare
from .corrected_fit import corrected_fit
from .diagnosis import Diagnosis
from .fit import Fit
from .ladder import find_missing
from .ladder_state import search_for
from .prepare import prepare
from .rank import rank_candidates
from .ranking import Ranked, Ranking
from .rung import Rung
from .stated_fit import estimate_stated

__all__ = [
    "ArmDiagnosis",
    "Comparison",
    "Diagnosis",
    "Fit",
    "HorizonError",
    "Ranked",
    "Ranking",
    "RecordedLoop",
    "Rung",
    "SimulationComparison",
    "compare",
    "find_missing",
    "find_missing_in_arm",
    "fit",
    "rank",
]


def fit(model: Model, experiment: Experiment, *, seed: int = 0) -> Model:
    """The model with its free parameters re-estimated on the fit records, with standard errors.

    Effects that are still absent (as `with_effect` leaves them) start from values of the record's
    scale. As in `find_missing`, what reading the motion by sensors does to the estimates is
    taken off them where the model leaves only noise, and widens their standard errors where it
    leaves more; of long records, windows are fitted.

    seed: of the draws for the noise floor and for the simulated readings
    raises ExperimentError: the experiment lacks what the comparison needs
    """
    return corrected_fit(search_for(experiment, model, seed=seed)).model


def rank(model: Model, experiment: Experiment) -> Ranking:
    """Effects that the model may lack, best first.

    Each candidate is added to the model and all free parameters are estimated again.
    returns: candidates with their fits and errors on fit and check records
    """
    prepared = prepare(experiment)
    return rank_candidates(estimate_stated(model, prepared), prepared)


check_arguments(globals(), __all__)
