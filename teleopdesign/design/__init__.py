"""From measurement to design: compensation for a device that a diagnosis identified.

from teleopdesign.design import design

design(find_missing(experiment))     # C, H, what they do, whether that is passive
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .assumptions import Assumptions as Assumptions
    from .cancellation import ProposedController as ProposedController
    from .cancellation import Reason as Reason
    from .force_feedback import FeedbackLoop as FeedbackLoop
    from .outcome import Design as Design
    from .prediction import CasePrediction as CasePrediction
    from .prediction import Prediction as Prediction
    from .propose import design as design
    from .quasi_static import ResidualFriction as ResidualFriction
    from .quasi_static import residual_friction as residual_friction
    from .refine import TunedControllers as TunedControllers
    from .refine import refine as refine
    from .verify import Verification as Verification
    from .verify import verify as verify

__getattr__, __dir__, __all__ = lazy_face(__name__)
