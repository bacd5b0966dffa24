"""From measurement to design: compensation for a device that a diagnosis identified.

from teleopdesign.design import design

design(find_missing(experiment))     # C, H, what they do, whether that is passive
"""

from typing import TYPE_CHECKING

from ..base.faces import lazy_face

if TYPE_CHECKING:
    from .assumptions import Assumptions as Assumptions
    from .chosen import ProposedController as ProposedController
    from .chosen import Reason as Reason
    from .force_feedback import FeedbackLoop as FeedbackLoop
    from .outcome import Design as Design
    from .prediction import CasePrediction as CasePrediction
    from .prediction import Prediction as Prediction
    from .propose import design as design
    from .refine import TunedControllers as TunedControllers
    from .refine import refine as refine
    from .residual_friction import ResidualFriction as ResidualFriction
    from .residual_friction import residual_friction as residual_friction

__getattr__, __dir__, __all__ = lazy_face(__name__)
