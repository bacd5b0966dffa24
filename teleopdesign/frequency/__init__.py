"""Frequency responses of a diagram."""

from .impedance_map import ImpedanceMap
from .measured_impedance import falling, measured_impedance
from .response import FrequencyResponse, bode, transfer_function

__all__ = [
    "FrequencyResponse",
    "ImpedanceMap",
    "bode",
    "falling",
    "measured_impedance",
    "transfer_function",
]
