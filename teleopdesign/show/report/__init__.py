"""The report of a diagnosis: one self-contained HTML page; this folder computes no physics."""

from typing import TYPE_CHECKING

from ...base.folders import lazy_face

if TYPE_CHECKING:
    from .page import page_of as page_of
    from .page import write_report as write_report

__getattr__, __dir__, __all__ = lazy_face(__name__)
