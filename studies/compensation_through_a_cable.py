"""How much may a motor cancel of friction that partly sits behind a compliant cable?

Source: the extension that Mahvash, Okamura, ICRA 2006 announce; P53 to P57 and the open questions
after them. Motor contact f_1, measured and compensated by a Dahl law (f_D, sigma_D); cable k; link
contact f_2, nothing else holds the link. Slow motion.

    f_D <= f_1                               passive beside any environment, proved (P53)
    f_D <= f_1 + f_2, and                    no plain cycle of the motor gives out energy (P55)
    f_D (1 - tanh(u)/u) <= f_1, u = sigma_D f_2/(k f_D)

Cycles that step back at each reversal are searched beside the plain ones; each is integrated
exactly. The other way round, a storage function is sought numerically: the available storage over a
grid of forces. Where it settles, no motion at all gives out energy, as far as the grid tells.
The second panel gives both contacts presliding; the capstan's friction, a motor contact pressed by
the cable's tension, adds its share to what may be cancelled.

Finding: plain cycles are refuted exactly where P55 says. Steps at the reversals lower the limit, by
3 % at sigma_D = 2 k; elsewhere by less than the bisection resolves (0.5 %). The available storage
settles up to where cycles with steps begin to give out energy (within 1.3 %), so a storage function
exists almost up to there: evidence for the open question, not a proof, and P55 itself has none at
its limit. The capstan raises the limit. With presliding at both contacts the same limit stays, and
a second one appears below it, sigma_D^2/f_D <= sigma_1^2/f_1, as for one contact alone.

    python studies/compensation_through_a_cable.py [--quick] [--output DIR]
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray
from _passivity_figures import plot_cable_limits
from _study import write_study

from teleopdesign.passivity import (
    Coulomb,
    Cycle,
    Dahl,
    DahlBehindSpring,
    Spring,
    available_storage,
    largest_passive_level,
    symmetric_cycle,
)

MOTOR, LINK, CABLE = 1.0, 2.0, 1e4  # f_1, f_2 in N; k in N/m
MOTOR_PRESLIDING, LINK_PRESLIDING = 1e5, 1e5  # N/m, both ten times the cable's
CAPSTAN = 0.2  # share of the cable's tension that adds to the motor's friction


def plain_limit(stiffness: float) -> float:
    """P55: largest f_D at which no cycle between -A and A gives out energy, N."""
    stuck = largest_passive_level(coulomb_level=MOTOR, stiffness=stiffness, amplitude=LINK / CABLE)
    return min(stuck, MOTOR + LINK)


def gives_out(helps: Dahl, against: list[Coulomb | Dahl | Spring | DahlBehindSpring]) -> bool:
    """Whether a cycle with or without steps back at its reversals gives out energy."""
    lengths = [helps.level / helps.stiffness, LINK / CABLE]
    sizes = np.geomspace(0.1 * min(lengths), 10 * max(lengths), 14)
    # plain cycles give out most at the stroke that the cable takes, or at very long ones
    for a in (LINK / CABLE, 1e4 * max(lengths), *sizes):
        plain = symmetric_cycle(helps, against, float(a))
        if plain.energy > 1e-9 * helps.level * a:
            return True
        for step in a * np.array([0.01, 0.03, 0.1, 0.3]):
            points = tuple(map(float, (a, a - step, a, -a, step - a, -a)))
            rounds = min(plain.rounds, 60)
            if Cycle(helps, tuple(against), points, rounds).energy > 1e-9 * helps.level * a:
                return True
    return False


def largest_level(holds: Callable[[float], bool], *, steps: int) -> float:
    """Largest f_D, N, up to which it holds, by bisection from f_1 to a fifth beyond f_1 + f_2."""
    low, high = 0.95 * MOTOR, 1.2 * (MOTOR + LINK)
    for _ in range(steps):
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def limit_by_cycles(stiffness: float, *, steps: int) -> float:
    """Largest f_D at which no cycle was found that gives out energy, N."""
    friction = [Coulomb(MOTOR), Spring(LINK, CABLE)]
    return largest_level(lambda f: not gives_out(Dahl(f, stiffness), friction), steps=steps)


def limit_by_storage(
    stiffness: float, *, steps: int, points: int, load_coefficient: float = 0.0
) -> float:
    """Largest f_D at which the available storage settles on the grid, N."""
    friction = [Coulomb(MOTOR), Spring(LINK, CABLE)]

    def settles(level: float) -> bool:
        return available_storage(
            Dahl(level, stiffness),
            friction,
            points=points,
            load_coefficient=load_coefficient,
        ).is_finite

    return largest_level(settles, steps=steps)


def presliding_map(softness: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """1 where a cycle gives out energy, both contacts presliding: over f_D, over sigma_D."""
    friction = [Dahl(MOTOR, MOTOR_PRESLIDING), DahlBehindSpring(LINK, LINK_PRESLIDING, CABLE)]
    return np.array(
        [[gives_out(Dahl(float(f), float(CABLE * s)), friction) for s in softness] for f in levels]
    ).astype(int)


def run(*, quick: bool = False) -> xarray.Dataset:
    """Limits over sigma_D, and the map with presliding; quick: fewer points, a coarser grid."""
    fine = np.geomspace(0.3, 30.0, 120)
    softness = np.geomspace(0.3, 30.0, 3 if quick else 13)
    across = np.geomspace(0.3, 30.0, 4 if quick else 28)
    levels = np.linspace(0.1, 3.5, 4 if quick else 35)
    steps, points = (5, 25) if quick else (9, 41)
    limits = np.array([limit_by_cycles(CABLE * s, steps=steps) for s in softness])
    stored = np.array([limit_by_storage(CABLE * s, steps=steps, points=points) for s in softness])
    capstan = np.array(
        [
            limit_by_storage(CABLE * s, steps=steps, points=points, load_coefficient=CAPSTAN)
            for s in softness
        ]
    )
    plain = np.array([plain_limit(CABLE * s) for s in softness])
    one = {"units": "1"}
    return xarray.Dataset(
        {
            "plain": ("stiffness_curve", [plain_limit(CABLE * s) / MOTOR for s in fine], one),
            "cycles": (
                "stiffness",
                limits / MOTOR,
                {**one, "how": "searched"},
            ),
            "storage": ("stiffness", stored / MOTOR, {**one, "how": "available storage settles"}),
            "capstan": ("stiffness", capstan / MOTOR, {**one, "how": "available storage settles"}),
            "presliding_gives_out": (("level", "across"), presliding_map(across, levels)),
        },
        {
            "stiffness": ("stiffness", softness, {**one, "text": "sigma_D/k"}),
            "stiffness_curve": ("stiffness_curve", fine, one),
            "across": ("across", across, {**one, "text": "sigma_D/k"}),
            "level": ("level", levels / MOTOR, {**one, "text": "f_D/f_1"}),
        },
        {
            "together": 1 + LINK / MOTOR,
            "motor_presliding": MOTOR_PRESLIDING / CABLE,
            "capstan_coefficient": CAPSTAN,
            "lowest_share_of_plain": float((limits / plain).min()),
            "finding": "largest f_D/f_1 without a cycle that gives out energy: "
            + ", ".join(f"{x:.3g}" for x in limits)
            + "; storage settles up to "
            + ", ".join(f"{x:.3g}" for x in stored)
            + "; plain cycles alone allow "
            + ", ".join(f"{x:.3g}" for x in plain),
        },
    )


if __name__ == "__main__":
    write_study(__file__, __doc__, run, plot=plot_cable_limits)
