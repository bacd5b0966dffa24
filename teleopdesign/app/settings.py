"""The folder of the page: from the command that serves it, or from a notebook's arguments."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

#: set by `teleopdesign app` for the page that it serves
FOLDER = "TELEOPDESIGN_APP_FOLDER"


def folder(arguments: Mapping[str, object] | None = None) -> Path:
    """The folder that the page may read; the present one where none is told."""
    stated = (arguments or {}).get("folder") or os.environ.get(FOLDER) or "."
    return Path(str(stated)).resolve()
