"""Blocks of a diagram: equations only."""

from .body import Body, BodyEquation, Value

__all__ = ["Body", "BodyEquation", "Value"]
