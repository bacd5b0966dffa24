"""The report of a diagnosis: one self-contained HTML page; this folder computes no physics."""

from ..base.arguments import check_arguments
from .arm import ArmPage, arm_page_of, write_arm_report
from .page import Page, page_of
from .write import write_report

__all__ = ["ArmPage", "Page", "arm_page_of", "page_of", "write_arm_report", "write_report"]

check_arguments(globals(), __all__)
