"""From measurement to design: compensation for a device that a diagnosis identified.

from teleopdesign.design import design

design(find_missing(experiment))     # C, H, what they do, whether that is passive
"""

from ..base.arguments import check_arguments
from .assumptions import Assumptions
from .chosen import ProposedController, Reason
from .force_feedback import FeedbackLoop
from .from_answer import DiagnosedModel, diagnosed_model, read_answer
from .outcome import Design
from .prediction import CasePrediction, Prediction
from .propose import design
from .refine import TunedControllers, refine
from .residual_friction import ResidualFriction, residual_friction

__all__ = [
    "Assumptions",
    "CasePrediction",
    "ProposedController",
    "Design",
    "DiagnosedModel",
    "FeedbackLoop",
    "Prediction",
    "Reason",
    "ResidualFriction",
    "TunedControllers",
    "design",
    "diagnosed_model",
    "read_answer",
    "residual_friction",
    "refine",
]

check_arguments(globals(), __all__)
