"""A home folder that does not exist: no library that a command imports creates it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

#: where matplotlib keeps its settings and fonts
PLACE = "MPLCONFIGDIR"


@contextmanager
def keep_home_absent() -> Iterator[None]:
    """Let matplotlib keep its files in a temporary folder if the user has no home folder.

    Otherwise matplotlib would create the home folder. A user without one wants no files to be kept
    there.
    """
    if PLACE in os.environ or Path(os.path.expanduser("~")).is_dir():
        yield
        return
    try:
        folder = tempfile.TemporaryDirectory(
            prefix="teleopdesign-matplotlib-", ignore_cleanup_errors=True
        )
    except OSError:  # nothing can be written anywhere
        yield
        return
    with folder as path:
        os.environ[PLACE] = path
        try:
            yield
        finally:
            os.environ.pop(PLACE, None)
