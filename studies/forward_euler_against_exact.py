"""What does a Dahl compensator do that is stepped by forward Euler instead of exactly?

Source: Mahvash, Okamura, ICRA 2006, eq (3) against eq (9); the limits are P29 and P30. With
q = T sigma abs(v)/f_c the Euler step has the pole 1 - q: it diverges from q = 2 on. But the bound
abs(f) <= f_c, on which passivity rests, is lost from q = 1 on: after a reversal the first step
reaches (2 q - 1) f_c.

The joint moves at constant speed, reverses, and moves back. Each sample shows the force of the
exact update, and that of the Euler step.

Finding: q = 0.5 keeps the bound; q = 1.5 rings to twice the level although it is "stable"; at 2.1
it grows by 1.1 a sample without end. The limit speed is one bristle length a sample, not two: at
0.1 mm and 1 ms it is 0.1 m/s.

    python studies/forward_euler_against_exact.py [--quick] [--output DIR]
"""

from __future__ import annotations

import numpy as np
import sympy as sp
import xarray
from _passivity_figures import plot_forward_euler
from _study import write_study

from teleopdesign.papers import dahl_integration
from teleopdesign.passivity import Dahl

LEVEL, STIFFNESS, PERIOD = 1.0, 1e4, 1e-3  # N, N/m, s: bristle length 0.1 mm
SHOWN = (0.5, 1.0, 1.5, 2.1)
SAMPLES = 24  # one way; then as many back

_euler_step = sp.lambdify(
    (dahl_integration.f, dahl_integration.v),
    dahl_integration.FORWARD.subs(
        {dahl_integration.f_c: LEVEL, dahl_integration.sigma: STIFFNESS, dahl_integration.T: PERIOD}
    ),
    "math",
)


def forces(q: float, *, samples: int = SAMPLES) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position in bristle lengths, exact force and Euler's over f_c, (2 samples + 1,).

    The motion begins where the force has settled at +f_c; it goes back first, then forth.
    """
    speed = q * LEVEL / (STIFFNESS * PERIOD)
    rates = np.repeat([-speed, speed], samples)
    exact, euler = [LEVEL], [LEVEL]
    for v in rates:
        exact.append(Dahl(LEVEL, STIFFNESS).leg(exact[-1], v * PERIOD)[0])
        euler.append(_euler_step(euler[-1], v))
    position = np.concatenate([[0.0], np.cumsum(rates)]) * PERIOD * STIFFNESS / LEVEL
    return position, np.array(exact) / LEVEL, np.array(euler) / LEVEL


def run(*, quick: bool = False) -> xarray.Dataset:
    """The four cases over the samples, and the largest force over q; quick: fewer q."""
    cases = [forces(q) for q in SHOWN]
    sweep = np.linspace(0.05, 2.2, 44 if quick else 216)
    largest = {n: np.array([np.abs(forces(q, samples=60)[n]).max() for q in sweep]) for n in (1, 2)}
    first = np.array([-forces(q)[2][1] for q in sweep])  # after the first step back
    kept, bounded = largest[2] <= 1 + 1e-12, largest[2] <= 4
    one = {"units": "1"}
    return xarray.Dataset(
        {
            "position": (("q", "sample"), [c[0] for c in cases], {**one, "text": "sigma x/f_c"}),
            "exact": (("q", "sample"), [c[1] for c in cases], {**one, "text": "f/f_c"}),
            "euler": (("q", "sample"), [c[2] for c in cases], {**one, "text": "f/f_c"}),
            "largest_exact": ("q_sweep", largest[1], one),
            "largest_euler": ("q_sweep", largest[2], one),
            "first_step": ("q_sweep", first, one),
        },
        {"q": ("q", list(SHOWN), one), "q_sweep": ("q_sweep", sweep, one)},
        {
            "bound_lost_at": float(sweep[~kept].min()),
            "diverges_at": float(sweep[~bounded].min()),
            "finding": f"forward Euler keeps abs(f) <= f_c up to q = {sweep[kept].max():.3g} and "
            f"is bounded up to q = {sweep[bounded].max():.3g}; the exact update keeps it always",
        },
    )


if __name__ == "__main__":
    write_study(__file__, __doc__, run, plot=plot_forward_euler)
