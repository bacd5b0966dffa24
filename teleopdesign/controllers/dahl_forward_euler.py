"""Dahl cancellation stepped by forward Euler, as printed: for comparison with `dahl` only.

    z_next = z + T (v - (sigma / F_D) abs(v) z),   F = sigma z

The publication calls this step backward Euler, but the rate is that at the old sample. Let q = T
sigma abs(v) / F_D. From q = 1 on the force exceeds its bound F_D (one step from -F_D reaches (2 q -
1) F_D), and the law is no longer passive. Beyond q = 2 it diverges (P28 to P30). `dahl` has neither
limit at the same cost. In continuous time the two laws are the same.
"""

from types import SimpleNamespace

from . import dahl
from ._controller import ControlLaw, ControllerState


def step(now, p):
    old = SimpleNamespace(travel_rate=now.velocity, bristle=now.bristle)
    return now.bristle + now.period * dahl.bristle(old, p)


CONTROLLER = ControlLaw(
    law=dahl.law,
    states={"bristle": ControllerState("position", dahl.bristle, step)},
    parameters=dahl.CONTROLLER.parameters,
    source="Mahvash, Okamura, ICRA 2006, eq (3)",
)
