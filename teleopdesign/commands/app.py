"""open a page in the browser: see which force a model does not explain, add and remove effects"""

from __future__ import annotations

import argparse
import os
import secrets
import sys
from pathlib import Path
from typing import NoReturn

from ..base.errors import ExperimentError
from . import STOPPED
from ._diagnosis import candidate_effects
from ._options import add_candidate_options

#: the machine itself: the page runs code, nobody else may reach it
LOOPBACK = "127.0.0.1"


EXAMPLES = """
  teleopdesign app
  teleopdesign app recordings --no-browser --port 8080
  teleopdesign app recordings --exclude cogging torque_ripple
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "folder",
        type=Path,
        nargs="?",
        default=Path(),
        help="folder of experiments or logs (default: the current folder); files outside of it "
        "are not opened",
    )
    add_candidate_options(parser)
    parser.add_argument(
        "--port", type=int, default=0, metavar="N", help="port (default: a free port)"
    )
    parser.add_argument(
        "--no-browser", action="store_true", help="print the address and open no browser"
    )


def run(options: argparse.Namespace) -> NoReturn:
    """Serve the page until Ctrl-C."""
    folder = options.folder
    if not folder.is_dir():
        raise ExperimentError(f"{folder}: there is no such folder")
    if not 0 <= options.port <= 65535:
        raise ExperimentError(f"--port: found {options.port}, expected 0 to 65535")
    try:
        from ..app import server
    except ImportError as error:
        raise ExperimentError(
            f'app: needs marimo, found none ({error}): pip install "teleopdesign[app]"'
        ) from error
    from ..app.server import EFFECTS, FOLDER
    from ..effects import EFFECTS as KNOWN

    among = candidate_effects(KNOWN, options.only, options.exclude)
    os.environ[FOLDER] = str(folder.resolve())
    os.environ[EFFECTS] = ",".join(among or ())
    token = secrets.token_urlsafe(24)
    try:
        server.serve(LOOPBACK, options.port, token, open_browser=not options.no_browser)
    except KeyboardInterrupt:
        print("teleopdesign: stopped", file=sys.stderr, flush=True)
        os._exit(STOPPED)  # no wait for kernels of open pages: what they write is written whole
