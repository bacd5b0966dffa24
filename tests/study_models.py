"""Models that studies of these tests are about: small enough to be many."""

import math
import os
import signal
import time
from pathlib import Path

import teleopdesign as td


def interface():
    """A device with friction and a Dahl cancellation, 0.2 s of a sine: some ms to simulate."""
    body = td.Body("prismatic", {"inertia": 0.15})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": 1.0})
    body = body.with_effect(td.EFFECTS["viscous"], {"damping": 1.0})
    law = td.controller("dahl", {"level": 0.8, "stiffness": 2e4})
    return td.haptic_interface(body, cancellation=law)


SIMULATED = {"duration": 0.2, "motion": {"L": td.sine(amplitude=0.01, frequency=5.0)}}


def product(x, y):
    """A number; no simulation."""
    return x * math.sin(y)


def value(result):
    """The number itself, as a measure."""
    return result


def slow_product(x, y):
    """As `product`, some ms later."""
    time.sleep(0.004)
    return product(x, y)


def deadly_product(x, y, folder):
    """As `product`, but at x = 3 the process that computes it is killed the first time."""
    mark = Path(folder) / "killed"
    if x == 3 and not mark.exists():
        mark.write_text("")
        os.kill(os.getpid(), signal.SIGKILL)
    return product(x, y)


def ending(x):
    """The number x; at x = 2 the function ends Python."""
    if x == 2.0:
        raise SystemExit(3)
    return x


def lethal_product(x, y):
    """As `product`, but at x = 3, y = 0.1 the process that computes it is killed every time."""
    if x == 3 and y == 0.1:
        os.kill(os.getpid(), signal.SIGKILL)
    return product(x, y)
