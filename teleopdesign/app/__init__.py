"""The workbench in a browser: a record, what a model leaves of it, and what explains the rest.

`teleopdesign app FOLDER` opens it. The page is a marimo notebook (`notebook.py`); what it does is
in `workbench.py`, without a page, so that a script can do the same.
"""

from .workbench import Workbench

__all__ = ["Workbench"]
