"""A home that is not there: nothing that a command imports may make it."""

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
    """Within: matplotlib keeps its files in a folder that is removed, where there is no home.

    It would make the home otherwise. Whoever names none wants nothing to be kept there.
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
