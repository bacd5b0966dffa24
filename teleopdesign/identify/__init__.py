"""Identification as in the papers: by special experiments, one parameter at a time.

    from teleopdesign.identify import coulomb_level, largest_stiffness_without_oscillation

The diagnosis estimates all parameters at once from any motion; these are the classical ways, for a
second opinion on the same data.
"""

from ..base.arguments import check_arguments
from .coulomb_level import CoulombLevel, LevelAtSpeed, Line, coulomb_level
from .largest_stiffness import LargestStiffness, largest_stiffness_without_oscillation
from .mean_error import mean_error
from .steady_runs import SteadyRun, steady_runs

__all__ = [
    "CoulombLevel",
    "LargestStiffness",
    "LevelAtSpeed",
    "Line",
    "SteadyRun",
    "coulomb_level",
    "largest_stiffness_without_oscillation",
    "mean_error",
    "steady_runs",
]

check_arguments(globals(), __all__)
