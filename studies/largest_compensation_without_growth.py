"""How far beyond the Coulomb level may a Dahl compensator go before oscillations grow?

Source: an extension of Mahvash, Okamura, ICRA 2006, whose theorem (f_D <= f_C) is tight only for
unlimited motion: a cycle of amplitude A gives out energy iff f_D (1 - tanh(u)/u) > f_C, with
u = sigma_D A/f_D bristle lengths (P40).

A mass on a spring with Coulomb friction f_C and the compensator, simulated by the compiled kernel,
starts at rest at A on its settled loop. Over one period its amplitude grows or shrinks; bisection
finds the level f_D at which it does neither.

Finding: the points lie on 1/(1 - tanh(u)/u) within 0.02 %. A soft compensator hides
over-compensation until motion is large: at u = 1 four times the friction may be cancelled. That is
the limit of plain oscillation. A motion that steps back and forth at its reversals gives out energy
earlier; below 1/(1 - e^(-2u))^2 no motion within A does (P56).

    python studies/largest_compensation_without_growth.py [--quick] [--output DIR]
"""

from __future__ import annotations

import math

import numpy as np
import xarray
from _passivity_figures import plot_largest_compensation
from _study import values_over, write_study

import teleopdesign as td
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import largest_ratio
from teleopdesign.simulate import simulate

FRICTION, AMPLITUDE, MASS = 1.0, 1e-2, 1.0  # N, m, kg
#: N/m; at the amplitude the spring pulls forty times as hard as friction, so that a cycle that
#: loses a little is still nearly as large as the one before it
STIFFNESS = 40 * FRICTION / AMPLITUDE
#: m; ideal friction gives by this before it slides, which takes this share off a cycle's loss
CLOSED = "closed paths"
GIVE = 1e-4 * AMPLITUDE
PERIOD = 2 * math.pi * math.sqrt(MASS / STIFFNESS)


def growth(u: float, ratio: float) -> float:
    """Relative growth of the amplitude over one period at f_D = ratio f_C."""
    level = ratio * FRICTION
    length = AMPLITUDE / u
    body = td.Body("prismatic", {"inertia": td.Value(MASS)})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": FRICTION})
    body = body.with_effect(td.EFFECTS["spring"], {"stiffness": STIFFNESS})
    law = controller("dahl", {"level": level, "stiffness": level / length})
    simulation = simulate(
        haptic_interface(body, cancellation=law),
        duration=1.25 * PERIOD,
        # at the turning point of the settled loop, where the Dahl force is f_D tanh(u)
        initial={
            "L": AMPLITUDE,
            "C_dahl_bristle": length * math.tanh(u),
            "Z_M_presliding_bristle": GIVE,
        },
        computer="continuous",
        step=PERIOD / 2000,
        give=GIVE,
        every_step=True,
    )
    second_half = simulation.data["time"].values > 0.75 * PERIOD
    return float(simulation["L"].values[second_half].max() / AMPLITUDE - 1)


def largest_without_growth(u: float, *, steps: int) -> float:
    """Largest f_D/f_C at which the amplitude does not grow, by bisection."""
    low, high = 1.0, 2.0
    while growth(u, high) < 0:
        low, high = high, 2 * high
    for _ in range(steps):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if growth(u, middle) < 0 else (low, middle)
    return math.sqrt(low * high)


def run(*, quick: bool = False) -> xarray.Dataset:
    """Simulated onset and both limits over u; quick: fewer points, a coarser bisection."""
    # the amplitudes of f_D/f_C = 1.05 (u = 21) to 4.2 (u = 1)
    u = np.geomspace(0.7, 25.0, 8 if quick else 20)
    fine = np.geomspace(0.5, 40.0, 200)
    simulated = values_over(largest_without_growth, {"u": u, "steps": 11 if quick else 16})
    theory = np.array([largest_ratio(x) for x in u])
    worst = float(np.abs(simulated / theory - 1).max())
    attrs = {"units": "1"}
    return xarray.Dataset(
        {
            "simulated": ("u", simulated, {**attrs, "how": "simulated, bisection"}),
            "cycles": ("u_curve", [largest_ratio(x) for x in fine], attrs),
            "closed_paths": ("u_curve", [largest_ratio(x, motion=CLOSED) for x in fine], attrs),
        },
        {"u": ("u", u, attrs), "u_curve": ("u_curve", fine, attrs)},
        {
            "worst_difference": worst,
            "finding": f"simulated onset within {100 * worst:.2g} % of 1/(1 - tanh(u)/u), "
            f"u = {u[0]:.2g} to {u[-1]:.2g}",
        },
    )


if __name__ == "__main__":
    write_study(__file__, __doc__, run, plot=plot_largest_compensation)
