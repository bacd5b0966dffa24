"""Values of a diagram that are sought: for limits, for a trade-off, or for measured signals.

import teleopdesign as td

free = {"C.dahl.level": (0.2, 1.5), "H.force_feedback.gain": (0.5, 20.0)}
tuned = td.tune(diagram, free, "force_error", subject_to=["passive"], duration=2.0)
front = td.trade_off(diagram, free, ("force_error", "tracking_error"), duration=2.0)
fitted = td.fit_simulation(diagram, record, {"Z_M.coulomb.level": (0.05, 2.0)})
"""

from ..base.arguments import check_arguments
from .limits import TuningLimit, limit
from .recheck import CheckedLimit
from .simulation_fit import SimulationFit, fit_simulation
from .trade_off import ParetoFront, trade_off
from .tune import Tuned, tune

__all__ = [
    "CheckedLimit",
    "ParetoFront",
    "SimulationFit",
    "Tuned",
    "TuningLimit",
    "fit_simulation",
    "limit",
    "trade_off",
    "tune",
]

check_arguments(globals(), __all__)
