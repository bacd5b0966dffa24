"""Frequency responses of a diagram."""

from .matrix_response import MatrixResponse, matrix_response
from .response import FrequencyResponse, bode, transfer_function

__all__ = ["FrequencyResponse", "MatrixResponse", "bode", "matrix_response", "transfer_function"]
