"""Serve the page on this machine only, behind a token."""

from __future__ import annotations

import os
import socket
import threading
import warnings
import webbrowser
from collections.abc import Mapping
from pathlib import Path
from typing import NoReturn

import marimo
import uvicorn

from ..base.errors import ExperimentError

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


#: s that open pages have to close when the server stops
LEAVING = 2.0
NOTEBOOK = Path(__file__).with_name("notebook.py")


def serve(host: str, port: int, token: str, *, open_browser: bool) -> NoReturn:
    """Serve until Ctrl-C; the address, with its token, is printed once the server answers.

    port: 0: a free port
    raises KeyboardInterrupt: Ctrl-C; kernels of open pages may still compute
    raises ExperimentError: the port is in use
    """
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
    except OSError as error:
        raise ExperimentError(f"--port {port}: {error.strerror}") from error
    # where a figure has no room for its layout the page shows it: nothing to say on the terminal
    warnings.filterwarnings("ignore", message="constrained_layout not applied")
    address = f"http://{host}:{listener.getsockname()[1]}/?access_token={token}"
    page = marimo.create_asgi_app(quiet=True, token=token).with_app(path="", root=str(NOTEBOOK))
    config = uvicorn.Config(page.build(), log_level="error", timeout_graceful_shutdown=1)
    server = uvicorn.Server(config)
    serving = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
    serving.start()
    try:
        while serving.is_alive() and not server.started:
            serving.join(0.02)
        print(f"teleopdesign is at {address}\nstop with Ctrl-C", flush=True)
        if open_browser:
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        while serving.is_alive():
            serving.join(0.2)
    except KeyboardInterrupt:
        server.should_exit = True
        serving.join(LEAVING)
        raise
    raise ExperimentError(f"{address}: the server ended by itself")
