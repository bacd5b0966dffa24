"""Frequency responses of a diagram."""

from .response import FrequencyResponse, bode, transfer_function

__all__ = ["FrequencyResponse", "bode", "transfer_function"]
