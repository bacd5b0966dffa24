"""Checks before a diagnosis: is a recording sound, do its columns agree, what can it show?"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .soundness_check import check_experiment as check_experiment

__getattr__, __dir__, __all__ = lazy_face(__name__)
