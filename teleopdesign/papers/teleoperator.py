"""Position-position teleoperator in free motion and in contact: P62 to P65.

Master and slave joined by a position-position spring, wired from blocks of the package.
"""

from __future__ import annotations

import numpy as np
import sympy as sp

from ..blocks import Body, Value
from ..controllers import controller
from ..diagrams import Diagram, teleoperator
from ..effects import EFFECTS
from ..simulate import Loop, Simulation, loop_of, simulate, sine
from ._laws import coulomb
from ._proof import Equal, ProofStep, ProofSteps, proof
from ._statement import MAHVASH, Numbers, claim, figure_near, shows

FRICTION = 1.0  # N, at the slave
STIFFNESS = 1000.0  # P, N/m
SLAVE_DAMPING = 2.0  # N s/m; settles the slave on the coupling spring
AMPLITUDE, FREQUENCY = 5e-3, 0.1  # of the master: up to 3 mm/s, inertial forces below 1 mN
BRISTLE = 1e-5  # m: deflection before sliding, short against the travel


def two_sides(*, cancelled: float, environment: float = 0.0) -> Diagram:
    """Master without friction; slave with damping, Dahl friction and a Dahl compensator.

    Friction that does not give stays below its level while the compensator's bristle bends, so that
    a slave with the same compensator sticks and slips.

    cancelled: f_D (N);  environment: stiffness that holds the slave (N/m)
    """
    master = Body("prismatic", {"inertia": Value(0.1)})
    slave = master.with_effect(EFFECTS["coulomb"], {"level": FRICTION})
    slave = slave.with_effect(EFFECTS["viscous"], {"damping": SLAVE_DAMPING})
    bristle = EFFECTS["presliding"].without("bristle_damping")
    slave = slave.with_effect(bristle, {"stiffness": FRICTION / BRISTLE})
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
    )
    kept = simulation.data["time"].values >= 1 / FREQUENCY
    return Simulation(simulation.diagram, simulation.data.isel(time=np.flatnonzero(kept)))


CANCELLED = (0.0, 0.5, 0.9)  # of the slave's friction
ENVIRONMENT = 0.15 * STIFFNESS  # k_e, N/m

P, w = sp.symbols("P w", positive=True)
x_m, x_s = sp.symbols("x_m x_s", real=True)


def mid_stroke(simulation: Simulation, name: str) -> Loop:
    """The loop of a signal over the master's position, in both directions, near mid-stroke."""
    middle = (-0.2 * AMPLITUDE, 0.2 * AMPLITUDE)
    return loop_of(simulation["X_m"].values, simulation[name].values, within=middle)


def free_space_force() -> Numbers:
    """User force at mid-stroke and position error, simulated in free space."""
    viscous = SLAVE_DAMPING * 2 * np.pi * FREQUENCY * AMPLITUDE
    figures = []
    for share in CANCELLED:
        simulation = slow_cycle(cancelled=share * FRICTION)
        felt, left = mid_stroke(simulation, "F_u").width / 2, (1 - share) * FRICTION
        # the damper, and a hundredth of the friction: inertia, settling of the bristles
        within = viscous + 0.01 * FRICTION
        figures.append(figure_near(f"user force, f_D = {share} f_C", felt, left, within, "N"))
        slack = 1e3 * mid_stroke(simulation, "X_e").width / 2
        expected = 1e3 * left / STIFFNESS
        figures.append(
            figure_near("  position error", slack, expected, 1e3 * within / STIFFNESS, "mm")
        )
    return Numbers(tuple(figures))


@shows(62, MAHVASH, "figure 6", numbers=free_space_force)
def free_space() -> ProofSteps:
    """The force that the user feels in slow free motion with both sides sliding, and the lag of the
    slave.

    formula: user force (f_Cm + f_Cs - f_Dm - f_Ds) sgn v; position error (f_Cs - f_Ds)/P
    """
    f_Cm, f_Cs, f_Dm, f_Ds = sp.symbols("f_Cm f_Cs f_Dm f_Ds", positive=True)
    user = sp.Symbol("F_u", real=True)
    steps: list[ProofStep] = []
    for way in (1, -1):
        slave = P * (x_m - x_s) + way * f_Ds - coulomb(way * w, f_Cs)
        (lag,) = sp.solve(slave, x_m)
        master = user - P * (x_m - x_s) + way * f_Dm - coulomb(way * w, f_Cm)
        (felt,) = sp.solve(master.subs(x_m, lag), user)
        steps += [
            Equal(f"position error, direction {way:+d}", lag - x_s, way * (f_Cs - f_Ds) / P),
            Equal("user force", felt, way * (f_Cm + f_Cs - f_Dm - f_Ds)),
        ]
    return proof(steps)


def contact(share: float) -> tuple[float, float, float]:
    """Stiffness felt (N/m), hysteresis width (N), rms difference from the environment (N).

    share: f_D/f_C
    """
    simulation = slow_cycle(cancelled=share * FRICTION, environment=ENVIRONMENT)
    loop = mid_stroke(simulation, "F_u")
    whole = simulation["F_u"].values - ENVIRONMENT * simulation["X_m"].values
    return loop.stiffness, loop.width, float(np.sqrt(np.mean(whole**2)))


def contact_force() -> Numbers:
    """Stiffness and hysteresis that the user feels, simulated in contact."""
    ratio = ENVIRONMENT / STIFFNESS
    viscous = 2 * SLAVE_DAMPING * 2 * np.pi * FREQUENCY * AMPLITUDE
    figures = []
    for share in CANCELLED:
        stiffness, width, _ = contact(share)
        expected = 2 * (1 - share) * FRICTION / (1 + ratio)
        # the damper widens the loop; a hundredth of the friction for what is not yet steady
        figures.append(
            figure_near(
                f"hysteresis width, f_D = {share} f_C", width, expected, viscous + 0.02, "N"
            )
        )
        series = STIFFNESS * ENVIRONMENT / (STIFFNESS + ENVIRONMENT)
        figures.append(figure_near("  stiffness felt", stiffness, series, 0.01 * series, "N/m"))
    return Numbers(tuple(figures))


@shows(63, MAHVASH, "figure 7", numbers=contact_force)
def soft_contact() -> ProofSteps:
    """The stiffness that the user feels in a contact of stiffness k_e: the coupling spring in
    series is itself a transparency error.

    formula: P k_e/(P + k_e), hysteresis width 2 (f_Cs - f_Ds)/(1 + k_e/P)
    """
    k_e, f_Cs, f_Ds = sp.symbols("k_e f_Cs f_Ds", positive=True)
    felt = []
    for way in (1, -1):
        slave = P * (x_m - x_s) - k_e * x_s + way * f_Ds - coulomb(way * w, f_Cs)
        (slave_position,) = sp.solve(slave, x_s)
        felt.append(sp.expand(P * (x_m - slave_position)))
    return proof(
        Equal("stiffness, either way", sp.diff(felt[0], x_m), P * k_e / (P + k_e)),
        Equal("the same falling", sp.diff(felt[1], x_m), P * k_e / (P + k_e)),
        Equal("width of the loop", felt[0] - felt[1], 2 * (f_Cs - f_Ds) / (1 + k_e / P)),
    )


@shows(64, MAHVASH, "figures 6, 7", how="checked numerically")
def transparency_figures() -> Numbers:
    """Force against displacement at the user's hand, compared with that of the environment: three
    numbers state how close the two curves are.

    formula: stiffness ratio, hysteresis width/f_C, rms force difference/f_C over a slow cycle
    printed: "transparency plot", without a number to it
    """
    ratio = ENVIRONMENT / STIFFNESS
    figures = []
    for share in CANCELLED:
        stiffness, width, difference = contact(share)
        name = f"f_D = {share} f_C"
        # a twentieth of a newton of friction: damping of the slave, settling of bristles
        figures += [
            figure_near(f"{name}: stiffness ratio", stiffness / ENVIRONMENT, 1 / (1 + ratio), 0.01),
            figure_near(
                "  hysteresis width", width / FRICTION, 2 * (1 - share) / (1 + ratio), 0.05, "f_C"
            ),
            figure_near(
                "  rms difference",
                difference / FRICTION,
                quasi_static_difference(share),
                0.02,
                "f_C",
            ),
        ]
    return Numbers(tuple(figures))


def quasi_static_difference(share: float) -> float:
    """Rms difference (N) of user force and environment force over a cycle, by a static balance.

    The slave stays in place while abs(P x_m - (P + k_e) x_s) is below the remaining friction.

    share: f_D/f_C
    """
    left = (1 - share) * FRICTION
    total = STIFFNESS + ENVIRONMENT
    position, forces = 0.0, []
    master = AMPLITUDE * np.sin(2 * np.pi * np.arange(2000) / 1000)
    for x in master:
        low, high = (STIFFNESS * x - left) / total, (STIFFNESS * x + left) / total
        position = min(max(position, low), high)
        forces.append(STIFFNESS * (x - position) - ENVIRONMENT * x)
    return float(np.sqrt(np.mean(np.square(forces[1000:]))))


bench = claim(
    65,
    MAHVASH,
    "experiment",
    "The force sensor at the slave's tip is for checks only. The user force comes from the "
    "motor current of the master, so it lacks the master's friction and inertia. All forces are "
    "divided by f_c, from the force-velocity curve of smooth motion. sigma_D is the largest value "
    "without oscillation.",
    (43, 46, 62),
)
