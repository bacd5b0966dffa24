"""Simulate a diagram, with a prescribed motion or in closed loop, sampled or continuous."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .force_displacement import ForceDisplacement as ForceDisplacement
    from .force_displacement import ForceVelocity as ForceVelocity
    from .force_displacement import Loop as Loop
    from .force_displacement import force_displacement as force_displacement
    from .force_displacement import force_velocity as force_velocity
    from .force_displacement import loop_of as loop_of
    from .many import simulate_many as simulate_many
    from .sampling import Sampling as Sampling
    from .setup import Setup as Setup
    from .setup import prepare as prepare
    from .simulation import Simulation as Simulation
    from .simulation import simulate as simulate
    from .trajectory import Trajectory as Trajectory
    from .trajectory import sampled_motion as sampled_motion
    from .trajectory import sine as sine

__getattr__, __dir__, __all__ = lazy_face(__name__)
