"""Master and slave of the teleoperator studies: friction and its cancellation at the slave only.

An example, not a measurement: masses, damping and coupling of a small teleoperator, forces in units
of the slave's friction, which gives by a tenth of a millimetre before it slides.
"""

from __future__ import annotations

from teleopdesign.blocks import Body, Value
from teleopdesign.controllers import Controller, controller
from teleopdesign.diagrams import Diagram, teleoperator
from teleopdesign.effects import EFFECTS

MASTER, SLAVE = 0.1, 0.3  # kg
DAMPING = 2.0  # of either side, N s/m
COUPLING = {"stiffness": 2000.0, "damping": 10.0}  # P and D, N/m and N s/m
FRICTION, GIVE = 1.0, 1e-4  # f_C of the slave, N, and its bristle length, m


def two_sides(share: float, environment: Body | None = None) -> Diagram:
    """The teleoperator with that share of the slave's friction cancelled by Dahl's law.

    Its bristles are the stiffest for which the pair of friction and cancellation is passive:
    (sigma_D/sigma_p)^2 = f_D/f_C.
    """
    bare = Body("prismatic", {"inertia": Value(MASTER)})
    master = bare.with_effect(EFFECTS["viscous"], {"damping": DAMPING})
    slave = master.with_values({"inertia": SLAVE})
    slave = slave.with_effect(EFFECTS["coulomb"], {"level": FRICTION})
    slave = slave.with_effect(EFFECTS["presliding"], {"stiffness": FRICTION / GIVE})
    return teleoperator(
        master,
        slave,
        coupling=controller("spring_damper", COUPLING),
        environment=environment,
        slave_cancellation=_dahl(share) if share else None,
    )


def _dahl(share: float) -> Controller:
    stiffness = FRICTION / GIVE * share**0.5
    return controller("dahl", {"level": share * FRICTION, "stiffness": stiffness})
