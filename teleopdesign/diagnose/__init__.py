"""Compare a model with an experiment, see where it fails, and find the effect that is missing."""

from __future__ import annotations

from ..arguments import check_arguments
from ..measurement.experiment import Experiment
from ..model import Model
from .comparison import Comparison, compare
from .diagnosis import Diagnosis
from .fit import Fit
from .ladder import find_missing
from .prepare import prepare
from .rank import rank_candidates
from .ranking import Ranked, Ranking
from .rung import Rung
from .search import estimate_from_starts

__all__ = [
    "Comparison",
    "Diagnosis",
    "Fit",
    "Ranked",
    "Ranking",
    "Rung",
    "compare",
    "find_missing",
    "fit",
    "rank",
]


def fit(model: Model, experiment: Experiment) -> Model:
    """The model with its free parameters re-estimated on the fit records, with standard errors.

    Effects that are still absent (as `with_effect` leaves them) start from values of the record's
    own scale.
    """
    return estimate_from_starts(model, prepare(experiment)).model


def rank(model: Model, experiment: Experiment) -> Ranking:
    """Effects that may be missing, best first; each is added and everything is re-estimated."""
    prepared = prepare(experiment)
    return rank_candidates(estimate_from_starts(model, prepared), prepared)


check_arguments(globals(), __all__)
