"""Where measurements that do not ship with the package are looked for."""

import os
from pathlib import Path

import pytest


def shared_folder(part):
    """A part of the shared folder: TELEOPDESIGN_SHARED, or `shared` beside the repository.

    Skips the test that asks where it is not there.
    """
    default = Path(__file__).parents[2] / "shared"
    folder = Path(os.environ.get("TELEOPDESIGN_SHARED", default)) / part
    if not folder.exists():
        pytest.skip(f"no {part} among the shared measurements: set TELEOPDESIGN_SHARED")
    return folder
