"""Frequency responses of a diagram."""

from .impedance_map import ImpedanceMap
from .measured_impedance import falling, measured_impedance
from .measured_response import measured_response, simulated_response
from .response import FrequencyResponse, bode, transfer_function

__all__ = [
    "FrequencyResponse",
    "ImpedanceMap",
    "bode",
    "falling",
    "measured_impedance",
    "measured_response",
    "simulated_response",
    "transfer_function",
]
