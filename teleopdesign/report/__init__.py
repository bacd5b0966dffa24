"""The report of a diagnosis: one HTML page that needs nothing else; computes no physics."""

from .page import Page, page_of
from .write import write_report

__all__ = ["Page", "page_of", "write_report"]
