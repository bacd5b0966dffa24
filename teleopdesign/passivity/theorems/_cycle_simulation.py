"""Replay of refuting cycles of friction and its cancellation in the compiled simulation."""

from __future__ import annotations

from ...base.errors import ModelError
from ...blocks import Body, Value
from ...controllers import controller, laws_that_declare
from ...diagrams import haptic_interface
from ...effects import EFFECTS
from ..claims.claim import Counterexample
from ..rate_independent import Coulomb, Cycle, Dahl
from ..search.by_simulation import SimulatedMotion, confirmed_motion
from ..search.stroke_motion import Strokes


def simulate_cycle(cycle: Counterexample) -> SimulatedMotion | None:
    """Simulate a refuting cycle of one friction element with a Dahl compensator.

    returns: the confirmed motion. None where the simulation does not confirm a release of energy
        (as close to a limit), would take too long, or where the counterexample is no cycle of one
        element
    """
    if not isinstance(cycle, Cycle) or len(cycle.friction) != 1:
        return None
    friction, helps = cycle.friction[0], cycle.compensator
    if not isinstance(friction, Coulomb | Dahl):
        return None
    body = Body("prismatic", {"inertia": Value(1e-3)})
    body = body.with_effect(EFFECTS["coulomb"], {"level": friction.level})
    lengths = [helps.level / helps.stiffness]
    if isinstance(friction, Dahl):
        presliding = EFFECTS["presliding"].without("bristle_damping")
        body = body.with_effect(presliding, {"stiffness": friction.stiffness})
        lengths.append(friction.level / friction.stiffness)
    bristle = laws_that_declare("bristle_stiffness")[0]
    values = {bristle.bound: helps.level, bristle.bristle_stiffness: helps.stiffness}
    law = controller(bristle.name, values)
    # friction does not depend on speed: a stroke takes about 10 ms
    strokes = Strokes(cycle.turning_points, speed=300 * max(map(abs, cycle.turning_points)))
    deflection = min(*lengths, *map(abs, cycle.turning_points)) / 1000
    try:
        return confirmed_motion(haptic_interface(body, cancellation=law), strokes, give=deflection)
    except ModelError:  # lengths so far apart that a simulation of it would take too many steps
        return None
