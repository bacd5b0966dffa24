"""Checks before a diagnosis: is a recording sound, do its columns agree, what can it show?"""

from ..base.arguments import check_arguments
from .soundness_check import check_experiment

__all__ = ["check_experiment"]

check_arguments(globals(), __all__)
