"""A trial reading of an HDF5 file in a separate process, which a damaged file may block or end.

In a damaged file the HDF5 library, which is written in C, may run into an endless loop or access
invalid memory. Nothing in Python can stop the library, but a separate process can be ended.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from ..base.errors import ExperimentError

#: s: processor time for reading a file in addition to the time that its size explains. A study of
#: 10 000 points takes 0.1 s. A longer time waits for damaged files; a shorter one refuses large
#: files on a slow machine
LONGEST = 3.0
#: bytes that are read in a second of processor time, at least; compressed bytes take longest
RATE = 5e7
#: s until the process is ended in any case: a machine may be busy, or may not limit processor time
PATIENCE = 120.0

#: source of a program that reads every attribute and all data that are not too large. It ignores
#: what h5py refuses, because the reader of the study then reports it
_LOOK = """
import sys
sys.path[:] = {path!r}
import h5py
try:
    import resource, time
    soon = int(time.process_time() + {seconds!r}) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (soon, soon))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
except (ImportError, OSError, ValueError):
    pass
data = []
def look(name, item):
    for key in item.attrs:
        item.attrs[key]
    if isinstance(item, h5py.Dataset):
        data.append(item)
try:
    with h5py.File(sys.argv[1]) as file:
        look("", file)
        file.visititems(look)
        if sum(one.size * one.dtype.itemsize for one in data) <= {largest!r}:
            for one in data:
                one[()]
except Exception:
    pass
"""


def read_on_trial(path: str | Path, *, largest: float) -> None:
    """Read an HDF5 file once in a separate process, which is ended if it does not finish.

    largest: bytes; the data of a file with more data are not read
    raises ExperimentError: the HDF5 library ends the process, or does not finish
    """
    try:
        size = os.stat(path).st_size
    except OSError:
        return  # the reader says what is wrong
    seconds = LONGEST + size / RATE
    code = _LOOK.format(path=sys.path, seconds=seconds, largest=largest)
    # what the library says before it ends is of no use to a reader
    try:
        ended = subprocess.run(
            [sys.executable, "-c", code, os.fspath(path)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=PATIENCE + seconds,
            check=False,
        )
        is_read = ended.returncode == 0
    except subprocess.TimeoutExpired:
        is_read = False
    if not is_read:
        raise ExperimentError(
            f"{path}: no study can be read: the file is damaged, the HDF5 library comes to no end "
            "with it"
        )
