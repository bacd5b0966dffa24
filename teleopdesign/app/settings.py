"""Settings of the page: from the command that serves it, or from a notebook's arguments."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

#: set by `teleopdesign app` for the page that it serves
FOLDER = "TELEOPDESIGN_APP_FOLDER"
#: names of the candidate effects, with commas; all where it is not set
EFFECTS = "TELEOPDESIGN_APP_EFFECTS"


def folder(arguments: Mapping[str, object] | None = None) -> Path:
    """The folder that the page may read; the current one if none is set."""
    stated = (arguments or {}).get("folder") or os.environ.get(FOLDER) or "."
    return Path(str(stated)).resolve()


def effects(arguments: Mapping[str, object] | None = None) -> tuple[str, ...] | None:
    """Names of the candidate effects; None: all."""
    stated = (arguments or {}).get("effects") or os.environ.get(EFFECTS) or ""
    names = tuple(name.strip() for name in str(stated).split(",") if name.strip())
    return names or None
