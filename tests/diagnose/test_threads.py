"""Work in threads: the order of results, and memory that is not cleared again for each array."""

import platform
import subprocess
import sys

import pytest

from teleopdesign.diagnose.threads import map_in_threads

#: arrays of 1 MiB that a residual and its tangents take together, and how often they are made
TOGETHER, TIMES = 16, 50


def test_results_keep_the_order_of_the_arguments():
    assert map_in_threads(lambda x, y: x - y, range(50), [1] * 50) == [x - 1 for x in range(50)]


def faults_of_arrays(after: str) -> int:
    """Pages that the system clears while arrays are made and dropped, in a process of its own."""
    code = f"""
import resource
import numpy as np
from teleopdesign.diagnose.threads import map_in_threads
{after}
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range({TIMES}):
    arrays = [np.ones(2**17) for _ in range({TOGETHER})]
    del arrays
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""
    output = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    return int(output.stdout)


@pytest.mark.slow
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="it is glibc's rule")
def test_arrays_are_not_cleared_by_the_system_again_and_again():
    assert faults_of_arrays("map_in_threads(abs, [1])") < faults_of_arrays("") / 5
