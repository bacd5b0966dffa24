"""How stiff may a Dahl compensator be whose force a computer gives a sample or two late?

Source: P49 and P50, after Colgate, Schenkel, J. Robotic Systems 14 (1997) 37, applied to the
compensator of Mahvash, Okamura, ICRA 2006 beside friction that gives before it slides (P43). In
small motion contact and compensator are springs, sigma_p and -sigma_D, the latter sampled and late:

    sigma_D <= sigma_p    and    B >= c sigma_D T,    c = 0, 1/2, 5/8 for 0, 1, 2 samples late

Each point of the two maps, over sample period and stiffness, is settled by the package's claim: a
proof with certificate, or a sampled motion that gives out energy. Over them the stiffness is drawn
from which on an oscillation grows, as simulated by the compiled kernel with Dahl friction, Dahl
compensator and hold, in a hand that makes the joint swing at the frequency that is worst for it.

Finding: a free joint grows from sigma_p on, where its contact no longer holds it; for being late
only where its contact makes it swing above a third of the sample rate, for below that a negative
spring that is late damps. In the worst hand oscillation grows from pi^2/8 of the damping's bound on
with one sample late (straight strokes meet the bound, sinusoids do not), and from 1.32 times of it
on with two. This is small motion: what trembles in step with the samples takes energy out at any
stiffness, but little (`passivity.sampled_compensation`).

    python studies/stiffest_late_compensator.py [--quick] [--output DIR]
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import xarray
from _onset_figures import plot_period_and_stiffness
from _study import values_over, write_study

import teleopdesign as td
from teleopdesign.base.errors import GrowsWithoutBound
from teleopdesign.controllers import controller
from teleopdesign.diagrams import Diagram, haptic_interface
from teleopdesign.passivity import Claim, region, required_damping, sampled_passivity
from teleopdesign.passivity.theorems.sampled_data import Z
from teleopdesign.simulate import Sampling, simulate
from teleopdesign.studies import find_onset

MASS, DAMPING = 0.15, 2.0  # kg, N s/m
FRICTION, PRESLIDING, SHARE = 0.5, 5e3, 0.9  # N, N/m, f_D/f_C
SHARES = {1: 1 / 2, 2: 5 / 8}  # c, by samples late
LATE = tuple(SHARES)
SWINGS, ROWS = 90, 40  # of one simulation, and steps a sample
SMALL = 1e-3 * FRICTION / PRESLIDING  # m, where each swing begins: a thousandth of a bristle


def claim(late: int, period: float, stiffness: float) -> Claim:
    """Small motion with the compensator as a late negative spring."""
    law = -stiffness * Z**-late
    return sampled_passivity(law, damping=DAMPING, sample_time=period, stiffness=PRESLIDING)


def damping_limit(late: int, period: float) -> float:
    """Stiffest compensator that the damping allows, N/m."""
    return DAMPING / required_damping(-(Z**-late), sample_time=period, stiffness=1)


def limit(late: int, period: float) -> float:
    """Stiffest compensator that both conditions allow, N/m."""
    return min(PRESLIDING, damping_limit(late, period))


def worst_turn(late: int) -> float:
    """Angle by sample of the swing to which a held force pushes most, rad.

    One sample late it is half the sample rate, where a swing keeps step with the samples.
    """
    if late == 1:
        return math.pi
    angle = np.linspace(0.01, math.pi, 4000)
    energy = -np.sin((late + 0.5) * angle) * np.sin(angle / 2) / (angle / 2) / angle
    return float(angle[np.argmax(energy)])


def held(late: int, period: float, stiffness: float, *, free: bool) -> Diagram:
    """The joint with its compensator, free or in the worst hand."""
    body = td.Body("prismatic", {"inertia": td.Value(MASS)})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": FRICTION})
    contact = td.EFFECTS["presliding"].without("bristle_damping")
    body = body.with_effect(contact, {"stiffness": PRESLIDING})
    body = body.with_effect(td.EFFECTS["viscous"], {"damping": DAMPING})
    law = controller("dahl", {"level": SHARE * FRICTION, "stiffness": stiffness})
    if free:
        return haptic_interface(body, cancellation=law)
    squared = (worst_turn(late) / period) ** 2
    mass = max(MASS, 1.2 * PRESLIDING / squared)
    hand = td.Body("prismatic", {"inertia": td.Value(max(mass - MASS, 1e-6))})
    hand = hand.with_effect(td.EFFECTS["spring"], {"stiffness": mass * squared - PRESLIDING})
    return haptic_interface(body, hand=hand, cancellation=law)


def grows(late: int, period: float, stiffness: float, *, free: bool = False) -> bool:
    """Whether a small swing grows."""
    turn = math.sqrt(PRESLIDING / MASS) * period if free else worst_turn(late)
    samples = max(math.ceil(SWINGS * 2 * math.pi / turn), 60)
    try:
        simulation = simulate(
            held(late, period, stiffness, free=free),
            duration=samples * period,
            initial={"L_velocity": SMALL * turn / period} if free else {"L": SMALL},
            computer=Sampling(period=period, delay=late * period),
            step=period / ROWS,
            give=SMALL,
            every_step=True,
        )
    except GrowsWithoutBound:
        return True
    first, _, last = (np.sqrt(np.mean(p**2)) for p in np.array_split(simulation["L"].values, 3))
    return bool(last > first or last > 10 * SMALL)  # as large as the bristles let it become


def onset(late: int, period: float, *, free: bool, steps: int) -> float:
    """Least stiffness at which a small swing grows, N/m, by bisection; NaN where none is found."""
    low = 0.9 * (limit(late, period) if free else damping_limit(late, period))
    high = max(4 * PRESLIDING, 2 * low) if free else 4 * low
    return find_onset(
        lambda stiffness: grows(late, period, stiffness, free=free), within=(low, high), steps=steps
    )


def run(*, quick: bool = False) -> xarray.Dataset:
    """Both maps with the simulated onsets; quick: 4 x 4 claims, 2 periods."""
    n, m, steps = (4, 2, 7) if quick else (50, 14, 10)
    period, stiffness = np.geomspace(1e-4, 1e-2, n), np.geomspace(100.0, 3e4, n)
    simulated = np.geomspace(1e-4, 1e-2, m)
    status, limits, onsets = [], [], np.full((2, len(LATE), m), np.nan)
    for k, late in enumerate(LATE):
        status.append(region(partial(claim, late), period, stiffness).status.astype(str))
        limits.append([limit(late, float(t)) for t in period])
        for i, free in enumerate((True, False)):
            fixed = {"late": late, "free": free, "steps": steps}
            onsets[i, k] = values_over(onset, {"period": simulated, **fixed})
    verdicts, bounds = np.array(status), np.array(limits)
    damped = np.array([[damping_limit(late, float(t)) for t in simulated] for late in LATE])
    over = onsets / np.array([np.minimum(damped, PRESLIDING), damped])
    inside = stiffness[None, :, None] <= bounds[:, None, :]
    # a step of the bisection of the free joint may end just below what it looks for
    wrong = int(((verdicts == "proved") != inside).sum() + (over < 1 - 1e-3).sum())
    simulations = ("ends", "late", "period_simulated")
    low, high = over.min(axis=2), over.max(axis=2)
    return xarray.Dataset(
        {
            "status": (("late", "stiffness", "period"), verdicts),
            "limit": (("late", "period"), bounds, {"units": "N/m"}),
            "onset": (simulations, onsets, {"units": "N/m"}),
            "over": (simulations, over),
        },
        {
            "late": list(LATE),
            "ends": ["free joint", "worst hand"],
            "stiffness": ("stiffness", stiffness, {"units": "N/m"}),
            "period": ("period", period, {"units": "s"}),
            "period_simulated": ("period_simulated", simulated, {"units": "s"}),
        },
        {
            "contradictions": wrong,
            "finding": f"{verdicts.size} points: {int((verdicts == 'proved').sum())} proved, "
            f"{int((verdicts == 'refuted').sum())} refuted; a free joint grows from "
            f"{low[0].min():.3f} to {high[0].max():.3f} of both bounds on, in the worst hand from "
            f"{low[1, 0]:.3f} to {high[1, 0]:.3f} of the damping's bound on with one sample late, "
            f"{low[1, 1]:.3f} to {high[1, 1]:.3f} with two",
        },
    )


if __name__ == "__main__":
    write_study(__file__, __doc__, run, plot=plot_period_and_stiffness)
