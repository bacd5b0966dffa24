"""Load-dependent friction: the level grows with the force that the transmission carries.

    level = F_C + mu abs(u) (1 + d sgn(u v)) (1 + e exp(-(v / v_S)^2)),   u: acting force

Gears, screws and capstans press harder on their contacts, the more force they transmit. This force
is the acting force, as the actuator feels it: gravity, inertia and the hand on the far side are
included. d distinguishes an actuator that drives (d > 0: more friction) from one that is driven
back. e is the extra friction at rest of contacts that slide better as speed grows. Commands that
vary at equal speed distinguish this effect from `coulomb`, loads with and against the motion
determine d. From mu = 1 on no acting force moves the body. The product mu d acts like an
`actuator_gain`, and only loads distinguish e from `stribeck`. So d, e and v_S are estimated where a
model states them, and a search leaves them at zero.
"""

from sympy import exp, sign

from ._effect import Effect, FitSearch, Parameter

#: m/s or rad/s: a speed far below any measured one, which keeps the law defined at v_S = 0
AT_REST = 1e-9


def law(now, p):
    level = p.coefficient * abs(now.acting_force)
    if p.driving_difference != 0:
        level *= 1 + p.driving_difference * sign(now.acting_force) * now.direction
    if p.extra_at_rest != 0:
        slow = exp(-(now.velocity**2) / (p.stribeck_velocity**2 + AT_REST**2))
        level *= 1 + p.extra_at_rest * slow
    return level


def of_load(quantity, meaning, start, upper=float("inf"), lower=0.0):
    """A parameter that is estimated where the user states it, and no part of a search."""
    search = FitSearch(starts=(start,), chosen=True)
    return Parameter(quantity, meaning, lower, upper, optional=True, search=search)


EFFECT = Effect(
    role="friction_level",
    energy="dissipates",
    law=law,
    parameters={
        "coefficient": Parameter(
            "dimensionless", "mu: level per transmitted force", search=FitSearch(within=1.0)
        ),
        "driving_difference": of_load(
            "dimensionless", "d: half of (driving - driven back), over the mean", 0.0, 1.0, -1.0
        ),
        "extra_at_rest": of_load("dimensionless", "e: extra at rest over sliding level", 0.0),
        "stribeck_velocity": of_load("velocity", "v_S: speed where that extra is down to 1/e", 0.1),
    },
    absent={"coefficient": 0.0},
    needs=frozenset({"coulomb"}),
    always=frozenset({"non-negative"}),
    source="Amontons' law on the transmitted force; with direction and speed: Duclusaud, Passault, "
    "Padois, Daney, Extended Friction Models for the Physics Simulation of Servo Actuators (2024)",
)
