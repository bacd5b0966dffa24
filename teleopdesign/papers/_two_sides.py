"""Master and slave joined by a position-position spring, wired from blocks of the package."""

from __future__ import annotations

import numpy as np

from ..blocks import Body, Value
from ..controllers import controller
from ..diagrams import Diagram, teleoperator
from ..effects import EFFECTS
from ..simulate import Simulation, simulate, sine

FRICTION = 1.0  # N, at the slave
STIFFNESS = 1000.0  # P, N/m
SLAVE_DAMPING = 2.0  # N s/m; settles the slave on the coupling spring
AMPLITUDE, FREQUENCY = 5e-3, 0.1  # of the master: up to 3 mm/s, inertial forces below 1 mN
BRISTLE = 1e-5  # m: deflection before sliding, which stands for ideal Coulomb friction


def two_sides(*, cancelled: float, environment: float = 0.0) -> Diagram:
    """Master without friction; slave with damping, Coulomb friction and a Dahl compensator.

    cancelled: f_D (N);  environment: stiffness that holds the slave (N/m)
    """
    master = Body("prismatic", {"inertia": Value(0.1)})
    slave = master.with_effect(EFFECTS["coulomb"], {"level": FRICTION})
    slave = slave.with_effect(EFFECTS["viscous"], {"damping": SLAVE_DAMPING})
    held = Body("prismatic", {"inertia": Value(0.0)})
    cancelled = max(cancelled, 1e-9)  # a level of zero leaves the bristle without a length
    # as soft as the plant's presliding: (sigma_D/sigma_p)^2 = (f_D/f_C)^2 <= f_D/f_C
    dahl = controller("dahl", {"level": cancelled, "stiffness": cancelled / BRISTLE})
    return teleoperator(
        master,
        slave,
        coupling=controller("spring_damper", {"stiffness": STIFFNESS, "damping": 0.0}),
        environment=held.with_effect(EFFECTS["spring"], {"stiffness": environment}),
        slave_cancellation=dahl,
    )


def slow_cycle(*, cancelled: float, environment: float = 0.0) -> Simulation:
    """The second of two slow cycles of the master; F_u is the user force that moves the master."""
    simulation = simulate(
        two_sides(cancelled=cancelled, environment=environment),
        duration=2 / FREQUENCY,
        motion={"X_m": sine(amplitude=AMPLITUDE, frequency=FREQUENCY)},
        computer="continuous",
        give=BRISTLE,
    )
    kept = simulation.data["time"].values >= 1 / FREQUENCY
    return Simulation(simulation.diagram, simulation.data.isel(time=np.flatnonzero(kept)))
