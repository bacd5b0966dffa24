"""The workbench in a browser: a record, the residual of a model, and effects that explain it.

`teleopdesign app FOLDER` opens it. The page is a marimo notebook (`notebook.py`); its work is done
in `workbench.py`, without a page, so that a script can do the same.
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .workbench import Workbench as Workbench

__getattr__, __dir__, __all__ = lazy_face(__name__)
