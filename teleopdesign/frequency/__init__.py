"""Frequency responses of a diagram."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from ..derive import transfer_function as transfer_function
    from .confidence import ParameterCovariance as ParameterCovariance
    from .confidence import ResponseBand as ResponseBand
    from .describing_function import describing_function as describing_function
    from .impedance_map import ImpedanceMap as ImpedanceMap
    from .impedance_map import falling_profile as falling_profile
    from .impedance_map import quasi_linear_impedance as quasi_linear_impedance
    from .loop import LoopGain as LoopGain
    from .loop import delay_margin as delay_margin
    from .loop import loop_gain as loop_gain
    from .margins import gain_margin as gain_margin
    from .margins import phase_margin as phase_margin
    from .matrix_response import MatrixResponse as MatrixResponse
    from .matrix_response import matrix_response as matrix_response
    from .measured_response import measured_impedance as measured_impedance
    from .measured_response import measured_response as measured_response
    from .measured_response import recorded_response as recorded_response
    from .measured_response import simulated_response as simulated_response
    from .response import FrequencyResponse as FrequencyResponse
    from .response import bode as bode

__getattr__, __dir__, __all__ = lazy_face(__name__)
