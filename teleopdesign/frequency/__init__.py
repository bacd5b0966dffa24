"""Frequency responses of a diagram."""

from .describing_function import describing_function
from .impedance_map import ImpedanceMap
from .measured_impedance import falling, measured_impedance
from .measured_response import measured_response, simulated_response
from .quasi_linear import quasi_linear_impedance
from .response import FrequencyResponse, bode, transfer_function

__all__ = [
    "FrequencyResponse",
    "ImpedanceMap",
    "bode",
    "describing_function",
    "falling",
    "measured_impedance",
    "measured_response",
    "quasi_linear_impedance",
    "simulated_response",
    "transfer_function",
]
