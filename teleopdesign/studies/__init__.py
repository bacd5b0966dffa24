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

from ..base.arguments import check_arguments
from .case import SimulatedCase
from .chosen_measures import Measure, measure
from .diagnosed import diagnose_recording
from .from_toml import read_study_file
from .measures import MEASURES
from .onset import find_onset, growth
from .outcomes import PointOutcome
from .point import Amount, Point
from .progress import Progress
from .result import Study, read_study
from .run import study
from .samples import Samples, latin_hypercube, random_samples, sensitivity_samples, sobol
from .sensitivities import sensitivities
from .sensitivity import sensitivity

__all__ = [
    "MEASURES",
    "Amount",
    "SimulatedCase",
    "Measure",
    "PointOutcome",
    "Point",
    "Progress",
    "Samples",
    "Study",
    "diagnose_recording",
    "growth",
    "latin_hypercube",
    "find_onset",
    "measure",
    "random_samples",
    "read_study",
    "read_study_file",
    "sensitivities",
    "sensitivity",
    "sensitivity_samples",
    "sobol",
    "study",
]

check_arguments(globals(), __all__)
