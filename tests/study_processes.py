"""Studies in processes of their own, and what tests ask of these processes."""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

TESTS = Path(__file__).parent
AXES = {"x": np.arange(6.0), "y": np.linspace(0.1, 1.0, 5)}
EXPECTED = AXES["x"][:, None] * np.sin(AXES["y"])


def in_a_process(code, *, limit="", **options):
    """Start Python with this package and these tests in reach."""
    head = f"import sys; sys.path[:0] = [{str(TESTS)!r}, {str(TESTS.parent)!r}]\n{limit}\n"
    return subprocess.Popen([sys.executable, "-c", head + code], **options)


def study_code(out, model="slow_product", points=300, **more):
    """A study of `points` points that writes into `out`."""
    arguments = "".join(f", {k}={v!r}" for k, v in more.items())
    return (
        "import numpy as np, teleopdesign as td, study_models as models\n"
        f"td.study(models.{model}, {{'x': np.arange({points}.0), 'y': 0.5}}, "
        f"measures=models.value, out={str(out)!r}{arguments})\n"
    )


def children():
    """Processes that this one started and has not waited for, and that compute."""
    listed = Path("/proc/self/task").glob("*/children")  # none where there is no such folder
    numbers = {number for file in listed for number in file.read_text().split()}
    return {number for number in numbers if not _tracks_resources(number)}


def _tracks_resources(number):
    """Whether this process only removes what loky leaves; it ends with the one that started it."""
    return "resource_tracker" in Path(f"/proc/{number}/cmdline").read_text()


def wait_for_points(out, count, limit=300.0):
    """Wait until that many points are kept."""
    part, end = out.with_name(f"{out.name}.part"), time.monotonic() + limit
    while time.monotonic() < end:
        if out.exists() or (part.exists() and part.read_bytes().count(b'"point":') >= count):
            return
        time.sleep(0.01)
    raise AssertionError(f"no point within {limit:.0f} s")
