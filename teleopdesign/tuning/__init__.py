"""Values of a diagram that are sought: for limits, for a trade-off, or for measured signals.

import teleopdesign as td

free = {"C.dahl.level": (0.2, 1.5), "H.force_feedback.gain": (0.5, 20.0)}
tuned = td.tune(diagram, free, "force_error", subject_to=["passive"], duration=2.0)
front = td.trade_off(diagram, free, ("force_error", "tracking_error"), duration=2.0)
fitted = td.fit_simulation(diagram, record, {"Z_M.coulomb.level": (0.05, 2.0)})
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .limits import TuningLimit as TuningLimit
    from .limits import limit as limit
    from .recheck import CheckedLimit as CheckedLimit
    from .simulation_fit import SimulationFit as SimulationFit
    from .simulation_fit import fit_simulation as fit_simulation
    from .trade_off import ParetoFront as ParetoFront
    from .trade_off import trade_off as trade_off
    from .tune import Tuned as Tuned
    from .tune import tune as tune

__getattr__, __dir__, __all__ = lazy_face(__name__)
