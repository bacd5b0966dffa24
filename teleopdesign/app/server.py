"""Serve the page on this machine alone, behind a token."""

from __future__ import annotations

import os
import socket
import threading
import webbrowser
from pathlib import Path

import marimo
import uvicorn

from ..errors import ExperimentError

#: s that open pages are given to close
LEAVING = 2.0
NOTEBOOK = Path(__file__).with_name("notebook.py")


def serve(host: str, port: int, token: str, *, open_browser: bool) -> None:
    """Serve until Ctrl-C; the address, with its token, is printed.

    port: 0: a free one
    raises ExperimentError: the port is taken
    """
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
    except OSError as error:
        raise ExperimentError(f"--port {port}: {error.strerror}") from error
    address = f"http://{host}:{listener.getsockname()[1]}/?access_token={token}"
    page = marimo.create_asgi_app(quiet=True, token=token).with_app(path="", root=str(NOTEBOOK))
    print(f"teleopdesign is at {address}\nstop with Ctrl-C", flush=True)
    if open_browser:
        threading.Timer(1.0, webbrowser.open, (address,)).start()
    config = uvicorn.Config(page.build(), log_level="error", timeout_graceful_shutdown=1)
    server = uvicorn.Server(config)
    serving = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
    serving.start()
    try:
        while serving.is_alive():
            serving.join(0.2)
    except KeyboardInterrupt:
        server.should_exit = True
        serving.join(LEAVING)
    print("stopped", flush=True)
    os._exit(0)  # kernels of open pages may still compute; what they write is written whole
