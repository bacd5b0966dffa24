"""download a public recording of a real device"""

from __future__ import annotations

import argparse
from pathlib import Path

EXAMPLES = """
  teleopdesign fetch emps
  teleopdesign fetch emps --folder recordings
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "name", help="name of the recording: emps, psm_insertion, mtm_wrist or hsm150"
    )
    parser.add_argument(
        "--folder", type=Path, help="folder for the recording (default: the cache of the user)"
    )


def run(options: argparse.Namespace) -> int:
    """Download the recording if necessary; print the folder of its experiment."""
    from ..measurement.recordings import fetch

    print(fetch(options.name, options.folder))
    return 0
