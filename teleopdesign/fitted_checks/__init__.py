"""Findings about a recording that need a fit: do forces, motion and model agree, what is visible?

A check is one file of this folder, of the same kind as those of `check`: `CHECK` with its order and
a function from a recording to findings. `check_experiment` asks first the list that needs no fit,
then this one, as far as the records can be compared and nothing before contradicts a fit.
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from ._list import check_experiment as check_experiment

__getattr__, __dir__, __all__ = lazy_face(__name__)
