"""Run every study, each in a process of its own that starts with the libraries imported.

Imports take some five seconds. Under Linux they are done once, and each study runs in a copy of
that process: what a study changes ends with its copy.

    python studies/_all.py [--jobs N] [--folder DIR] [arguments of every study]
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import runpy
import sys
import tempfile
from contextlib import suppress
from importlib import import_module
from multiprocessing.connection import wait
from pathlib import Path

#: on other systems, libraries of the system may not survive the copy: each study imports its own
START = "fork" if sys.platform == "linux" else "spawn"
#: what nearly every study imports, itself or by what it calls
IMPORTED = (
    "_study",
    "control",
    "dask.distributed",  # where it is installed, for xarray asks it how files are locked
    "matplotlib.backends.backend_agg",
    "matplotlib.backends.backend_pdf",
    "matplotlib.backends.backend_svg",
    "matplotlib.pyplot",
    "teleopdesign.diagnose",
    "teleopdesign.diagrams",
    "teleopdesign.frequency",
    "teleopdesign.passivity",
    "teleopdesign.simulate",
)


def run_all(paths: list[Path], arguments: list[str], *, jobs: int) -> list[Path]:
    """Run those scripts, some at a time; print what each prints once it has ended.

    return: those that failed
    """
    context = multiprocessing.get_context(START)
    waiting, failed = list(reversed(paths)), []
    running: dict[int, tuple[multiprocessing.process.BaseProcess, Path]] = {}
    with tempfile.TemporaryDirectory() as folder:
        while waiting or running:
            while waiting and len(running) < jobs:
                path = waiting.pop()
                process = context.Process(
                    target=_run, args=(str(path), arguments, f"{folder}/{path.stem}")
                )
                process.start()
                running[process.sentinel] = process, path
            for ended in wait(list(running)):
                process, path = running.pop(ended)
                process.join()
                printed = Path(folder, path.stem).read_text(encoding="utf-8", errors="replace")
                print(f"== {path}\n{printed}", flush=True)
                if process.exitcode:
                    failed.append(path)
    return failed


def _run(path: str, arguments: list[str], log: str) -> None:
    """As `python PATH ARGUMENTS > LOG 2>&1` does, in a process that nothing else uses."""
    with open(log, "wb") as file:
        for stream in (1, 2):
            os.dup2(file.fileno(), stream)
    sys.argv = [path, *arguments]
    sys.path.insert(0, str(Path(path).parent))
    runpy.run_path(path, run_name="__main__")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--folder", type=Path, default=Path(__file__).parent)
    chosen, arguments = parser.parse_known_args()
    if START == "fork":
        for name in IMPORTED:
            with suppress(ModuleNotFoundError):  # a study that needs it says so itself
                import_module(name)
    failed = run_all(sorted(chosen.folder.glob("[!_]*.py")), arguments, jobs=chosen.jobs)
    if failed:
        sys.exit("failed: " + ", ".join(map(str, failed)))


if __name__ == "__main__":
    main()
