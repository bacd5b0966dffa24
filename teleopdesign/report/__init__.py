"""The report of a diagnosis: one HTML page that needs nothing else; computes no physics."""

from ..arguments import check_arguments
from .page import Page, page_of
from .write import write_report

__all__ = ["Page", "page_of", "write_report"]

check_arguments(globals(), __all__)
