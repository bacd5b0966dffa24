"""Energy that is given out only with steps at the reversals, behind a compliant cable: P56.

A motor that steps back and forth at its reversals lets the bristle of the compensator forget the
last stroke, so that the compensator pushes along the motion sooner in the next stroke. The price is
the work against the motor's friction over the steps.
"""

from __future__ import annotations

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from ..blocks import Body, Value
from ..controllers import controller
from ..diagrams import haptic_interface
from ..effects import EFFECTS
from ..simulate import Trajectory, simulate
from ._laws import dahl_rate, dahl_step
from ._proof import Correction, Equal, Holds, NotNegative, ProofSteps, proof
from ._statement import DERIVED, Figure, Numbers, numbers_of, shows
from .dahl_loop import BEND, BENDS, SHARE

f_D, sigma, f_1, f_2, k, u = sp.symbols("f_D sigma_D f_1 f_2 k u", positive=True)
SMALL = sp.Symbol("small", positive=True)
FRICTION = 1 / 12  # N, of the simulated motor; f_D is 1 N
Array = NDArray[np.float64]


def dithered_cycle() -> sp.Expr:
    """Energy of half a cycle of amplitude u, with a step of `SMALL` to and fro at each reversal.

    Units f_D = sigma_D = 1, link stuck; the second half of a cycle mirrors the first.
    """
    h, along = sp.Symbol("h", real=True), sp.Symbol("along", positive=True)

    def stroke(force: sp.Expr, length: sp.Expr, way: int) -> tuple[sp.Expr, sp.Expr]:
        path = dahl_step(force, along, way, sp.S(1), sp.S(1))
        return path.subs(along, length), sp.integrate(sp.expand(way * path), (along, 0, length))

    back, first = stroke(h, SMALL, -1)
    again, second = stroke(back, SMALL, 1)
    peak, third = stroke(-again, 2 * u, 1)  # the mirrored stroke that follows
    (steady,) = sp.solve(sp.expand(peak - h), h)
    energy = first + second + third - f_1 * (2 * u + 2 * SMALL)
    return energy.subs(h, steady)


def stepping_motor() -> Numbers:
    """Simulated energy given out in a cycle of the proof's case, with steps and without."""
    steps = energy_of_cycle((0.5, 0.4, 0.5, -0.5, -0.4, -0.5))
    plain = energy_of_cycle((0.5, -0.5))
    # a percent of what friction takes: the contact gives before it slides
    within = 0.01 * 2 * FRICTION
    return numbers_of(
        Figure("plain cycle, f_1 = 1/12 f_D, u_2 = 1/2", plain, high=-within, unit="J"),
        Figure("with a step of 0.1 at each reversal", steps, low=within, unit="J"),
    )


def energy_of_cycle(turning: tuple[float, ...]) -> float:
    """Work of the compensator less the work of the motor's friction in the last of four cycles (J).

    turning: points where the motor reverses (m); it takes half a second from one to the next
    """
    points = np.array(turning)
    n = len(points)

    def part(t: Array) -> tuple[Array, Array, Array]:
        count = np.floor(2 * t).astype(int)
        return points[count % n], points[(count + 1) % n], np.pi * (2 * t - count)

    def position(t: Array) -> Array:
        start, end, angle = part(t)
        return np.asarray(start + (end - start) * (1 - np.cos(angle)) / 2)

    def velocity(t: Array) -> Array:
        start, end, angle = part(t)
        return np.asarray((end - start) * np.pi * np.sin(angle))

    def acceleration(t: Array) -> Array:
        start, end, angle = part(t)
        return np.asarray((end - start) * 2 * np.pi**2 * np.cos(angle))

    motor = Body("prismatic", {"inertia": Value(0.1)})
    motor = motor.with_effect(EFFECTS["coulomb"], {"level": FRICTION})
    law = controller("dahl", {"level": 1.0, "stiffness": 1.0})
    simulation = simulate(
        haptic_interface(motor, cancellation=law),
        duration=4 * n / 2,
        motion={"L": Trajectory(position, velocity, acceleration)},
        computer="continuous",
        give=1e-3,
    )
    last = simulation.data["time"].values >= 3 * n / 2
    force = (simulation["R_MBC"] - simulation["Z_M_friction"]).values[last]
    return float(trapezoid(force, simulation["L"].values[last]))


@shows(
    56,
    DERIVED,
    "search for motions beyond the cycles of P55",
    how="refuted",
    numbers=stepping_motor,
)
def steps_at_reversals() -> Correction:
    """The conditions of P55 are exact for plain cycles only. With a step back and forth at the
    reversals the bristle forgets the last stroke, and little energy is lost to friction.

    formula: cycles with a small step back and forth at each reversal give out energy at the limit
        of P55 for every u_2; with the link stuck f_1 >= f_D (1 - e^(-2 u_2))^2 is enough for every
        closed path from a bristle at rest, and any motion then gives out at most f_D^2 (1 - e^(-2
        u_2))^2/(2 sigma_D)
    printed: not in the papers; an earlier random search (60 sets, up to 10 strokes) found no motion
        that gives out energy where P55 holds
    """
    net = dithered_cycle()
    limit = SHARE  # f_1 at the limit of P55
    slope = sp.diff(net, SMALL).subs(SMALL, 0)
    rest = sp.Symbol("rest", nonnegative=True)
    # f_D = sigma_D = f_2 = 1, k = 2, f_1 = 1/12: u_2 = 1/2, sigma_D = k sqrt(3 f_1 f_D)/f_2
    case = {u: sp.Rational(1, 2), f_1: sp.Rational(1, 12), SMALL: sp.Rational(1, 10)}
    return Correction(
        proof(
            Equal("without steps: the plain cycle", net.subs(SMALL, 0), 2 * u * (limit - f_1)),
            Equal("each step adds at first", slope, 2 * (sp.tanh(u) ** 2 - f_1)),
            BENDS,
            NotNegative(
                "more than nothing where the plain cycle gives out nothing",
                slope.subs(f_1, limit),
                2 * rest / u,
                {rest: BEND},
            ),
            Holds("a case within P55: f_D = 1 <= f_1 + f_2", 1, "<=", sp.Rational(1, 12) + 1),
            Holds("and within its simple bound", 1, "<=", 2 * sp.sqrt(3 * sp.Rational(1, 12))),
            Holds("gives out energy with one step of 0.1 at each reversal", net.subs(case), ">", 0),
        ),
        _force_within_a_bound(),
    )


def _force_within_a_bound() -> ProofSteps:
    """With the link stuck, f_1 >= f_D (1 - e^(-2 u_2))^2 is enough for every closed path."""
    f, edge = sp.Symbol("f", real=True), sp.Symbol("edge", positive=True)
    x = sp.Symbol("x", positive=True)  # above the lower end of the range of the motion
    most = sp.Symbol("most", positive=True)  # the bound at the upper end
    bound = f_D * (1 - sp.exp(-sigma * x / f_D))
    decay = sigma / f_D
    enough, inside = sp.symbols("enough inside", nonnegative=True)
    return proof(
        Equal(
            "moving up, the distance from the bound shrinks",
            sp.diff(bound, x) - dahl_rate(f, sp.S(1), f_D, sigma),
            -decay * (bound - f),
        ),
        Equal(
            "moving down it grows while abs(f) is within it: from f = 0 it stays within",
            -sp.diff(bound, x) - dahl_rate(f, sp.S(-1), f_D, sigma),
            decay * (bound + f),
        ),
        NotNegative(
            "the bound rises along the range, 2 f_2/k wide",
            sp.diff(bound, x),
            sigma * sp.exp(-decay * x),
        ),
        Equal("to", bound.subs(x, 2 * f_2 / k), f_D * (1 - sp.exp(-2 * sigma * f_2 / (k * f_D)))),
        Equal(
            "power of the compensator: rate of f^2/(2 sigma_D), and abs(v) f^2/f_D",
            f * edge - f / sigma * dahl_rate(f, edge, f_D, sigma),
            edge * f**2 / f_D,
        ),
        NotNegative(
            "which the motor's friction covers",
            f_1 - f**2 / f_D,
            enough + inside / f_D,
            {enough: f_1 - most**2 / f_D, inside: most**2 - f**2},
        ),
        NotNegative(
            "so any motion from f = 0 gives out at most most^2/(2 sigma_D), a closed path that "
            "repeats none",
            most**2 / (2 * sigma) - f**2 / (2 * sigma),
            inside / (2 * sigma),
            {inside: most**2 - f**2},
        ),
        assuming=[f_1 - most**2 / f_D, most**2 - f**2],
    )
