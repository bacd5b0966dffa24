"""Simulate a diagram, with a prescribed motion or in closed loop, sampled or continuous."""

from ..base.arguments import check_arguments
from .force_displacement import ForceDisplacement, Loop, force_displacement, loop_of
from .force_velocity import ForceVelocity, force_velocity
from .many import simulate_many
from .sampling import Sampling
from .setup import Setup, prepare
from .simulation import Simulation, simulate
from .trajectory import Trajectory, sampled_motion, sine

__all__ = [
    "ForceDisplacement",
    "ForceVelocity",
    "Loop",
    "Trajectory",
    "Setup",
    "Sampling",
    "Simulation",
    "force_displacement",
    "force_velocity",
    "loop_of",
    "prepare",
    "sampled_motion",
    "simulate",
    "simulate_many",
    "sine",
]

check_arguments(globals(), __all__)
