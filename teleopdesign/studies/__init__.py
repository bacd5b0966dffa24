"""Parameter studies: measures of a model at every point of named axes, on one machine or a cluster.

import teleopdesign as td

result = td.study(
    diagram,
    {"C.dahl.level": [0.5, 1.0, 1.5], "computer.delay": [0, 1e-3, 2e-3]},
    measures=["force_error", td.measure("peak", signal="R_M")],
    duration=2.0,
    motion={"L": td.sine(amplitude=0.01, frequency=2.0)},
)
result["force_error"]                       # a labelled array over both axes
result.plot.map("force_error")
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .case import SimulatedCase as SimulatedCase
    from .chosen_measures import Measure as Measure
    from .chosen_measures import measure as measure
    from .from_toml import diagnose_recording as diagnose_recording
    from .from_toml import read_study_file as read_study_file
    from .measures import MEASURES as MEASURES
    from .measures import find_onset as find_onset
    from .measures import growth as growth
    from .outcomes import PointOutcome as PointOutcome
    from .outcomes import Progress as Progress
    from .point import Amount as Amount
    from .point import Point as Point
    from .result import Study as Study
    from .result import read_study as read_study
    from .run import study as study
    from .samples import Samples as Samples
    from .samples import latin_hypercube as latin_hypercube
    from .samples import random_samples as random_samples
    from .samples import sensitivity_samples as sensitivity_samples
    from .samples import sobol as sobol
    from .sensitivity import sensitivities as sensitivities
    from .sensitivity import sensitivity as sensitivity

__getattr__, __dir__, __all__ = lazy_face(__name__)
