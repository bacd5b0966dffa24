"""Identification as in the papers: by special experiments, one parameter at a time.

    from teleopdesign.identify import coulomb_level, largest_stiffness_without_oscillation

The diagnosis estimates all parameters at once from any motion; these are the classical ways, for a
second opinion on the same data.
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .coulomb_level import CoulombLevel as CoulombLevel
    from .coulomb_level import LevelAtSpeed as LevelAtSpeed
    from .coulomb_level import Line as Line
    from .coulomb_level import coulomb_level as coulomb_level
    from .largest_stiffness import LargestStiffness as LargestStiffness
    from .largest_stiffness import (
        largest_stiffness_without_oscillation as largest_stiffness_without_oscillation,
    )
    from .steady_runs import SteadyRun as SteadyRun
    from .steady_runs import mean_error as mean_error
    from .steady_runs import steady_runs as steady_runs

__getattr__, __dir__, __all__ = lazy_face(__name__)
