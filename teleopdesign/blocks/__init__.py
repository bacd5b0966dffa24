"""Blocks of a diagram: equations only."""

from .body import Body, BodyEquation, Value
from .environment import CONTACT

__all__ = ["CONTACT", "Body", "BodyEquation", "Value"]
