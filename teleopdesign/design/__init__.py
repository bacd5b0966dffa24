"""From measurement to design: compensation for a device that a diagnosis identified.

from teleopdesign.design import design, diagnosed

design(diagnosed(find_missing(experiment)))     # C, H, what they do, whether that is passive
"""

from ..arguments import check_arguments
from .assumptions import Assumptions
from .chosen import Chosen, Reason
from .force_feedback import Loop
from .from_answer import Diagnosed, diagnosed, read_answer
from .outcome import Design
from .prediction import CasePrediction, Prediction
from .propose import design
from .residual_friction import ResidualFriction, residual_friction
from .tune import Tuned, tune

__all__ = [
    "Assumptions",
    "CasePrediction",
    "Chosen",
    "Design",
    "Diagnosed",
    "Loop",
    "Prediction",
    "Reason",
    "ResidualFriction",
    "Tuned",
    "design",
    "diagnosed",
    "read_answer",
    "residual_friction",
    "tune",
]

check_arguments(globals(), __all__)
