"""How stiff may master and slave be coupled, at which delay of the line, at which sample period?

Source: P61 and P60, after Llewellyn, Proc. IRE 40 (1952) 271, and Colgate, Schenkel, J. Robotic
Systems 14 (1997) 37, applied to the position-position coupling P of Mahvash, Okamura, ICRA 2006:

    other side late by T_d, exactly:       absolutely stable iff b_m b_s >= (P T_d)^2
    forces held over a sample period T:    passive iff b_m b_s/(b_m + b_s) >= P T/2

Each point of the two maps is settled by the package's claim: a proof with certificate, or a growing
wave that takes energy out. Over them the stiffness is drawn from which on an oscillation grows, as
simulated by the compiled kernel with the exact delay or hold and found by bisection: with nothing
held at either end, and with heavy hands and loads.

Finding: simulated onset never lies below the bound, and heavy ends that share a swing as the bound
wants bring it there within 0.6 %; the step of the bisection is 0.3 %. Free ends swing faster and
share it otherwise: they grow from 11 to 15 % above the bound of the delay, and 0.3 to 1.4 % above
that of the hold, which at any frequency asks for nearly the same damping.

    python studies/passive_delay_and_stiffness.py [--quick] [--output DIR]
"""

from __future__ import annotations

import math

import numpy as np
import xarray
from _onset_figures import plot_delay_and_stiffness
from _study import values_over, write_study

import teleopdesign as td
from teleopdesign.base.errors import GrowsWithoutBound
from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, teleoperator
from teleopdesign.passivity import Claim, delayed_spring, region, sampled_coupling
from teleopdesign.simulate import Sampling, simulate
from teleopdesign.studies import find_onset

MASSES, DAMPINGS = (0.2, 0.5), (1.0, 2.5)  # kg and N s/m, of master and slave
HEAVY = 2.0  # kg at the master where hand and load are heavy
SWINGS, ROWS = 60, 40  # of one simulation, and its least number of steps a swing
TICK = 6.25e-5  # s: delays are whole numbers of it, so that steps divide them


def delayed(late: float, stiffness: float) -> Claim:
    """The claim of P61."""
    return delayed_spring(
        master_inertia=MASSES[0],
        master_damping=DAMPINGS[0],
        slave_inertia=MASSES[1],
        slave_damping=DAMPINGS[1],
        stiffness=stiffness,
        delay=late,
    )


def held(period: float, stiffness: float) -> Claim:
    """The claim of P60."""
    return sampled_coupling(
        stiffness, master_damping=DAMPINGS[0], slave_damping=DAMPINGS[1], sample_time=period
    )


def ends(kind: str) -> tuple[tuple[float, float], ...]:
    """Masses of both sides: free, and as heavy as ends may be that share a swing at the worst.

    That is v_m/v_s = -(b_s/b_m)^(1/2) with a delay and -b_s/b_m with a hold: as m_s/m_m.
    """
    ratio = DAMPINGS[1] / DAMPINGS[0]
    return MASSES, (HEAVY, HEAVY * (math.sqrt(ratio) if kind == "delay" else ratio))


def side(k: int, masses: tuple[float, float]) -> td.Body:
    """Master (0) or slave (1) with what hangs on it."""
    body = td.Body("prismatic", {"inertia": td.Value(masses[k])})
    return body.with_effect(td.EFFECTS["viscous"], {"damping": DAMPINGS[k]})


def coupled_late(late: float, stiffness: float, masses: tuple[float, float]) -> Diagram:
    """Each side on a spring of its own position, pulled by the other's as it was."""
    blocks = []
    for k, (here, other) in enumerate((("m", "s"), ("s", "m"))):
        body = side(k, masses).with_effect(td.EFFECTS["spring"], {"stiffness": stiffness})
        body = body.with_effect(td.EFFECTS["actuation_delay"], {"delay": late})
        pull = controller("spring_damper", {"stiffness": stiffness, "damping": 0.0})
        blocks += [
            Moving(f"Z_{here}", body, f"X_{here}", f"U_{here}", {f"F_{here}": 1}, f"F_{here}"),
            Control(f"P_{here}", pull, f"X_{other}", f"U_{here}", f"X_{other}"),
        ]
    error = Junction("X_e", {"X_m": 1, "X_s": -1})
    outside = {"F_m": "force", "F_s": "force"}
    return Diagram("late teleoperator", tuple(blocks), (error,), outside, ("X_m", "X_s"))


def coupled_by_computer(stiffness: float, masses: tuple[float, float]) -> Diagram:
    """The teleoperator with its coupling as a spring."""
    law = controller("spring_damper", {"stiffness": stiffness, "damping": 0.0})
    return teleoperator(side(0, masses), side(1, masses), coupling=law)


def grows(kind: str, late: float, stiffness: float, masses: tuple[float, float]) -> bool:
    """Whether a swing of the two sides against each other grows."""
    reduced = 1 / sum(1 / m for m in masses)
    swing = 2 * math.pi * math.sqrt(reduced / stiffness)
    step = TICK / max(math.ceil(ROWS * TICK / swing), 1)
    sampled = kind == "period"
    diagram = (
        coupled_by_computer(stiffness, masses) if sampled else coupled_late(late, stiffness, masses)
    )
    try:
        simulation = simulate(
            diagram,
            duration=max(SWINGS * swing, 60 * late),
            # about their common centre of mass
            initial={"X_m": 1e-3, "X_s": -1e-3 * masses[0] / masses[1]},
            computer=Sampling(period=late) if sampled else "continuous",
            step=step,
            every_step=True,
        )
    except GrowsWithoutBound:
        return True
    error = simulation["X_e"].values
    parts = np.array_split(error, 3)
    return bool(np.square(parts[2]).mean() > np.square(parts[1]).mean())


def onset(
    kind: str,
    late: float,
    masses: tuple[float, float],
    *,
    within: tuple[float, float],
    steps: int,
) -> float:
    """Least stiffness (N/m) at which a swing grows, by bisection; NaN where none within."""
    return find_onset(
        lambda stiffness: grows(kind, late, stiffness, masses), within=within, steps=steps
    )


def limit(kind: str, late: float) -> float:
    """Stiffness of the bound, N/m."""
    b_m, b_s = DAMPINGS
    if kind == "delay":
        return math.sqrt(b_m * b_s) / late
    return 2 * b_m * b_s / (b_m + b_s) / late


def run(*, quick: bool = False) -> xarray.Dataset:
    """Both maps with both simulated onsets; quick: 4 x 4 claims, 2 delays."""
    n, m, steps = (4, 2, 7) if quick else (16, 12, 10)
    stiffness = np.geomspace(30.0, 30000.0, n)
    data: dict[str, object] = {}
    statuses, contradictions, nearest = [], 0, []
    simulated = TICK * np.round(np.geomspace(4, 256, m))
    times = {name: (np.geomspace(2e-4, 2e-2, n), simulated) for name in ("delay", "period")}
    for name, claim in (("delay", delayed), ("period", held)):
        grid, points = times[name]
        status = region(claim, grid, stiffness).status.astype(str)
        onsets = np.full((2, m), np.nan)
        for i, masses in enumerate(ends(name)):

            def at(late: float, kind: str = name, masses: tuple[float, float] = masses) -> float:
                bound = limit(kind, late)
                return onset(kind, late, masses, within=(0.5 * bound, 8 * bound), steps=steps)

            onsets[i] = values_over(at, {"late": points})
        over = onsets / np.array([limit(name, float(t)) for t in points])
        data[f"status_over_{name}"] = (("stiffness", name), status)
        data[f"onset_over_{name}"] = (("ends", f"{name}_simulated"), onsets, {"units": "N/m"})
        data[f"limit_over_{name}"] = ((name,), [limit(name, float(t)) for t in grid])
        statuses.append(status)
        contradictions += int((over < 1).sum())
        nearest.append(np.nanmin(over))
    every = np.concatenate([s.ravel() for s in statuses])
    coordinates = {
        "stiffness": ("stiffness", stiffness, {"units": "N/m"}),
        "ends": ["free ends", "heavy ends"],
    }
    for name, (grid, points) in times.items():
        coordinates[name] = (name, grid, {"units": "s"})
        coordinates[f"{name}_simulated"] = (f"{name}_simulated", points, {"units": "s"})
    return xarray.Dataset(
        data,
        coordinates,
        {
            "contradictions": contradictions,
            "nearest": [float(x) for x in nearest],
            "finding": f"{every.size} points: {int((every == 'proved').sum())} proved, "
            f"{int((every == 'refuted').sum())} refuted by a wave; simulated onset at "
            f"{nearest[0]:.4g} (delay) and {nearest[1]:.4g} (period) of the bound where it comes "
            f"nearest, below it {contradictions} times",
        },
    )


if __name__ == "__main__":
    write_study(__file__, __doc__, run, plot=plot_delay_and_stiffness)
