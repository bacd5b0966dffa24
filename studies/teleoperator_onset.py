"""Up to which cancellation of the slave's friction does an oscillation of the teleoperator die out?

Source: an extension of Mahvash, Okamura, ICRA 2006, who cancel the friction of the slave with
f_D <= f_C (P37), and of P40: a cycle of amplitude A gives out energy iff f_D (1 - tanh(u)/u) > f_C,
u = sigma_D A/f_D. The user holds the master still; the slave swings on the coupling P, D and on a
springy environment k_e it holds on to. What the damper takes has to be given out as well:

    f_D (1 - tanh(u)/u) > f_C + (pi/4) (D + b) w A,    w^2 = (P + k_e)/m

Each point of the two maps, over the coupling's damping and over the environment's stiffness, is a
simulation by the compiled kernel, from rest at A on the settled loop: does the next swing come back
larger?

Finding: no swing grows at f_D <= f_C, whatever the coupling and the environment. Simulated onset is
within 4 % of the balance of energy, from 1.4 f_C at a coupling damper of 0.05 N s/m to twice that
at 3 N s/m. This room above the bound belongs to one amplitude and one damper and is no margin: a
stiff contact widens it only because it makes the same motion faster.

    python studies/teleoperator_onset.py [--quick] [--output DIR]
"""

from __future__ import annotations

import math

import numpy as np
import xarray
from _onset_figures import plot_teleoperator_onset
from _study import values_over, write_study

import teleopdesign as td
from teleopdesign.controllers import controller
from teleopdesign.diagrams import Diagram, teleoperator
from teleopdesign.passivity import largest_ratio
from teleopdesign.simulate import Trajectory, simulate

FRICTION, MASTER, SLAVE = 1.0, 0.1, 0.3  # N, kg, kg
COUPLING, DAMPING = 2000.0, 1.0  # P, N/m, and D, N s/m, of the map that does not vary it
SLAVE_DAMPING = 0.2  # b of the slave, N s/m
CONTACT = 0.25  # k_e/P of the map that does not vary it
AMPLITUDE = 5e-3  # m: there the coupling pulls ten times as hard as friction
LENGTHS = 5.0  # u: bristle lengths of the compensator in that amplitude
GIVE = 1e-4 * AMPLITUDE  # m, of ideal friction


def machine(share: float, *, damping: float, contact: float) -> Diagram:
    """The teleoperator with f_D = share f_C at the slave.

    damping: D, N s/m;  contact: k_e/P of an environment that pulls as well as pushes
    """
    bare = td.Body("prismatic", {"inertia": td.Value(MASTER)})
    slave = bare.with_values({"inertia": SLAVE})
    slave = slave.with_effect(td.EFFECTS["viscous"], {"damping": SLAVE_DAMPING})
    slave = slave.with_effect(td.EFFECTS["coulomb"], {"level": FRICTION})
    spring = td.Body("prismatic", {"inertia": td.Value(0.0)})
    spring = spring.with_effect(td.EFFECTS["spring"], {"stiffness": contact * COUPLING})
    level = share * FRICTION
    law = {"level": level, "stiffness": level * LENGTHS / AMPLITUDE}
    return teleoperator(
        bare,
        slave,
        coupling=controller("spring_damper", {"stiffness": COUPLING, "damping": damping}),
        environment=spring,
        slave_cancellation=controller("dahl", law),
    )


def swing(contact: float) -> float:
    """Frequency at which the slave swings, rad/s."""
    return math.sqrt(COUPLING * (1 + contact) / SLAVE)


def growth(share: float, *, damping: float, contact: float) -> float:
    """Relative growth of the amplitude over one swing."""

    def nothing(t: np.ndarray) -> np.ndarray:
        return np.zeros_like(t)

    period = 2 * math.pi / swing(contact)
    simulation = simulate(
        machine(share, damping=damping, contact=contact),
        duration=1.25 * period,
        motion={"X_m": Trajectory(nothing, nothing, nothing)},
        # at the turning point of the settled loop, where the Dahl force is f_D tanh(u)
        initial={
            "X_s": AMPLITUDE,
            "C_s_dahl_bristle": AMPLITUDE / LENGTHS * math.tanh(LENGTHS),
            "Z_s_presliding_bristle": GIVE,
        },
        computer="continuous",
        step=period / 400,
        give=GIVE,
        every_step=True,
    )
    second_half = simulation.data["time"].values > 0.75 * period
    return float(simulation["X_s"].values[second_half].max() / AMPLITUDE - 1)


def balance(*, damping: float, contact: float) -> float:
    """f_D/f_C at which a cycle of that amplitude gives out just what the dampers take."""
    loss = math.pi / 4 * (damping + SLAVE_DAMPING) * swing(contact) * AMPLITUDE
    return largest_ratio(LENGTHS) * (1 + loss / FRICTION)


def run(*, quick: bool = False) -> xarray.Dataset:
    """Both maps of the growth over one swing; quick: 9 x 13 points."""
    n, m = (9, 13) if quick else (32, 41)
    shares = np.linspace(0.75, 3.15, m)
    axes = {"damping": np.geomspace(0.05, 5.0, n), "contact": np.geomspace(0.02, 20.0, n)}
    fixed = {"damping": DAMPING, "contact": CONTACT}
    data, worst, early = {}, 0.0, 0
    for name, values in axes.items():
        grown = values_over(growth, {"share": shares, **fixed, name: values})
        expected = np.array([balance(**{**fixed, name: float(x)}) for x in values])
        onset = np.array([_onset(shares, column) for column in grown.T])
        data[f"growth_over_{name}"] = (("share", name), grown, {"units": "1"})
        data[f"onset_over_{name}"] = ((name,), onset, {"units": "1", "how": "simulated"})
        data[f"balance_over_{name}"] = ((name,), expected, {"units": "1"})
        worst = max(worst, float(np.nanmax(np.abs(onset / expected - 1))))
        early += int((grown[shares <= 1] > 0).sum())
    points = sum(grown.size for grown in (data[f"growth_over_{n}"][1] for n in axes))
    return xarray.Dataset(
        data,
        {
            "share": ("share", shares, {"units": "1", "text": "f_D/f_C"}),
            "damping": ("damping", axes["damping"], {"units": "N*s/m", "text": "D"}),
            "contact": ("contact", axes["contact"], {"units": "1", "text": "k_e/P"}),
        },
        {
            "worst_difference": worst,
            "grown_within_bound": early,
            "cycles": largest_ratio(LENGTHS),
            "fixed_damping": DAMPING,
            "fixed_contact": CONTACT,
            "amplitude": AMPLITUDE,
            "finding": f"{points} simulations: {early} grow at f_D <= f_C; onset within "
            f"{100 * worst:.2g} % of the balance of energy",
        },
    )


def _onset(shares: np.ndarray, grown: np.ndarray) -> float:
    """f_D/f_C at which growth changes sign, between the points; NaN where it does not."""
    above = np.flatnonzero((grown[1:] > 0) & (grown[:-1] <= 0))
    if not len(above):
        return float("nan")
    k = int(above[0])
    return float(np.interp(0.0, grown[k : k + 2], shares[k : k + 2]))


if __name__ == "__main__":
    write_study(__file__, __doc__, run, plot=plot_teleoperator_onset)
