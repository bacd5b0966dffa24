"""Simulate a diagram: prescribed motion or closed loop, sampled or continuous controllers."""

from .force_velocity import ForceVelocity, force_velocity
from .motion import Motion, sampled_motion, sine
from .prepared import Prepared, prepare
from .sampling import Sampling
from .simulation import Simulation, simulate

__all__ = [
    "ForceVelocity",
    "Motion",
    "Prepared",
    "Sampling",
    "Simulation",
    "force_velocity",
    "prepare",
    "sampled_motion",
    "simulate",
    "sine",
]
