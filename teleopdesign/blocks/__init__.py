"""Blocks of a diagram: equations only."""

from .body import Body, BodyEquation, Value
from .environment import CONTACT
from .matrix_impedance import MatrixImpedance, matrix_impedance

__all__ = ["CONTACT", "Body", "BodyEquation", "MatrixImpedance", "Value", "matrix_impedance"]
