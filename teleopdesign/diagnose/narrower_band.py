"""A bandwidth up to which a model does far better: beyond it positions ask for forces that nothing
shows.

Steps that a filter rounded off, or steps coarser than stated, look like a motion to every test of
their scatter. Differentiated twice they ask for forces that no actuator gave: of a trolley with a
filtered potentiometer 80 % were left up to 9.4 Hz, 18 % up to 2.3 Hz, with the documented mass and
friction. An effect that acts at high frequencies alone, such as a tip that rings, looks the same.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import ExperimentError
from ..measurement.bandwidth import LOWEST
from ..model import Model
from .criteria import CRITERIA, Criteria
from .fit import Fit, estimate
from .prepare import Prepared, prepare


@dataclass(frozen=True)
class NarrowerBand:
    """A bandwidth (Hz) and what a model leaves there, beside the chosen one and what it leaves."""

    bandwidth: float
    error: float
    chosen: float
    error_at_chosen: float

    def __str__(self) -> str:
        return (
            f"up to {self.bandwidth:.3g} Hz this model leaves {100 * self.error:.2g} % of the "
            f"force, up to {self.chosen:.3g} Hz {100 * self.error_at_chosen:.2g} %: beyond, "
            "positions ask for forces that nothing shows. A sensor that is filtered or coarser "
            "than stated does so, or an effect that acts so fast alone: try bandwidth = "
            f'{{ value = {self.bandwidth:.3g}, unit = "Hz" }} at comparison'
        )


def narrower_band(
    model: Model, prepared: Prepared, *, criteria: Criteria = CRITERIA
) -> NarrowerBand | None:
    """Where a model, estimated anew, leaves far less than at the bandwidth of the comparison.

    None: nowhere, or the experiment states its bandwidth
    """
    experiment, chosen = prepared.experiment, prepared.bandwidth
    if experiment.bandwidth is not None or 0.25 * chosen < LOWEST:
        return None
    here, best = _error(estimate(model, prepared)), None
    for part in (0.25, 0.5):  # a quarter tells, then the widest is taken
        try:
            narrower = prepare(experiment, bandwidth=part * chosen)
        except ExperimentError:
            return best
        there = _error(estimate(model, narrower))
        if not criteria.falls * there < here:
            break
        best = NarrowerBand(part * chosen, there, chosen, here)
    return best


def _error(fit: Fit) -> float:
    """Error on the check records, or on the fit records where there are no others."""
    return fit.check_error if fit.check_error == fit.check_error else fit.fit_error
