"""A page that is served until a test ends."""

import os
import re
import signal
import subprocess
import sys
from functools import partial

import pytest

from teleopdesign.app.server import FOLDER


@pytest.fixture
def served(tmp_path, request):
    """(address with its token, folder) of a page that is served until the test ends.

    indirect parameters: more arguments of the command
    """
    pytest.importorskip("marimo", reason="needs the extra app")
    tmp_path = tmp_path / "laboratory"
    tmp_path.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "teleopdesign.cli", "app", str(tmp_path), "--no-browser"]
        + getattr(request, "param", []),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={k: v for k, v in os.environ.items() if k != FOLDER} | {"PYTHONUNBUFFERED": "1"},
        # tests that run in the background of a shell are deaf to Ctrl-C: the page is not
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        address = re.search(r"http\S+", line)
        assert address, line
        assert process.stdout.readline() == "stop with Ctrl-C\n"
        yield address.group(), tmp_path
    finally:
        process.send_signal(signal.SIGINT)
        try:
            output, _ = process.communicate(timeout=300)
        finally:
            process.kill()  # no server stays behind
    assert (output, process.returncode) == ("teleopdesign: stopped\n", 130)
