"""Load-dependent friction: the level grows with the force that the transmission carries.

    level = F_C + mu ((1 - s) W(u) + s W(L)) (1 + e exp(-(v / v_S)^2))
    W(f) = abs(f) (1 + d sgn(f v)),   u: acting force, L: carried force

Gears press harder on their contacts, the more force they transmit. With s = 0 this is the acting
force u, with s = 1 the force L at the output: inertia, gravity and the hand. A motor driven by a
voltage needs s = 1, for the back-EMF acts before the gears. d distinguishes an actuator that drives
(d > 0: more friction) from one that is driven back. e is the extra friction at rest. Commands that
vary at equal speed distinguish this effect from `coulomb`, loads with and against the motion
determine d. mu d acts like an `actuator_gain`, only loads distinguish e from `stribeck`: d, e, v_S
are estimated where a model states them. A search tries s = 0 and s = 1.
"""

from sympy import exp, sign

from ._effect import Effect, FitSearch, Parameter

#: m/s or rad/s: a speed far below any measured one, which keeps the law defined at v_S = 0
AT_REST = 1e-9


def law(now, p):
    parts = ((1 - p.output_share, now.acting_force), (p.output_share, now.carried_force))
    level = p.coefficient * sum(s * load(now, p, force) for s, force in parts if s != 0)
    slow = exp(-(now.velocity**2) / (p.stribeck_velocity**2 + AT_REST**2))
    return level * (1 + p.extra_at_rest * slow) if p.extra_at_rest != 0 else level


def load(now, p, force):
    way = sign(force) * now.direction
    return abs(force) * (1 + p.driving_difference * way if p.driving_difference != 0 else 1)


def of_load(meaning, *starts, lower=0.0, upper=float("inf"), quantity="dimensionless"):
    search = FitSearch(starts=starts, chosen=True)
    return Parameter(quantity, meaning, lower, upper, optional=True, search=search)


MU = FitSearch(within=1.0)
D, V_S = "d: half of (driving - driven back), over the mean", "v_S: speed where e is down to 1/e"
EFFECT = Effect(
    role="friction_level",
    energy="dissipates",
    law=law,
    parameters={
        "coefficient": Parameter("dimensionless", "mu: level per force", search=MU),
        "driving_difference": of_load(D, 0.0, lower=-1.0, upper=1.0),
        "extra_at_rest": of_load("e: extra at rest over sliding level", 0.0),
        "stribeck_velocity": of_load(V_S, 0.1, quantity="velocity"),
        "output_share": of_load("s: part of mu on the carried force", 0.0, 1.0, upper=1.0),
    },
    absent={"coefficient": 0.0},
    needs=frozenset({"coulomb"}),
    always=frozenset({"non-negative"}),
    source="Amontons' law on the transmitted force; with direction and speed: Duclusaud, Passault, "
    "Padois, Daney, Extended Friction Models for the Physics Simulation of Servo Actuators (2024)",
)
