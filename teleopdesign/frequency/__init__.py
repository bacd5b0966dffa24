"""Frequency responses of a diagram."""

from ..base.arguments import check_arguments
from ..derive import transfer_function
from .describing_function import describing_function
from .grid import falling_profile
from .impedance_map import ImpedanceMap
from .loop import LoopGain, delay_margin, loop_gain
from .margins import gain_margin, phase_margin
from .matrix_response import MatrixResponse, matrix_response
from .measured_impedance import measured_impedance
from .measured_response import measured_response, simulated_response
from .quasi_linear import quasi_linear_impedance
from .response import FrequencyResponse, bode

__all__ = [
    "FrequencyResponse",
    "ImpedanceMap",
    "LoopGain",
    "MatrixResponse",
    "bode",
    "delay_margin",
    "describing_function",
    "falling_profile",
    "gain_margin",
    "loop_gain",
    "matrix_response",
    "measured_impedance",
    "measured_response",
    "phase_margin",
    "quasi_linear_impedance",
    "simulated_response",
    "transfer_function",
]

check_arguments(globals(), __all__)
