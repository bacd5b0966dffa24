"""Pictures of control laws: force over velocity and position, and what an encoder makes of it."""

from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt

import teleopdesign as td
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.simulate import Sampling, simulate, sine

STYLE = Path(td.__file__).parent / "show" / "figures" / "teleopdesign.mplstyle"
LEVEL = 0.5  # N
BRISTLE = {"level": LEVEL, "stiffness": 1e4}  # gives by 50 um
STRIBECK = {"extra_static_level": 0.15, "stribeck_velocity": 2e-3, "bristle_damping": 0.0}
LAWS = {
    "coulomb": {"level": LEVEL},
    "smoothed_coulomb": {"level": LEVEL, "smoothing_velocity": 1e-3},
    "karnopp": {"level": LEVEL, "band": 1e-3},
    "dahl": BRISTLE,
    "lugre": BRISTLE | STRIBECK,
}
LINES = {
    "coulomb": ("#000000", "-"),
    "smoothed_coulomb": ("#0072B2", "-"),
    "karnopp": ("#CC79A7", (0, (4, 1.4, 1, 1.4))),
    "dahl": ("#D55E00", "-"),
    "lugre": ("#009E73", (0, (5, 1.6))),
}
COMMAND = 0.2  # N, of which Karnopp's law knows


def led(law, motion, duration, computer):
    """The law's force on a device that is led along the motion."""
    diagram = haptic_interface(
        td.Body("prismatic", {"inertia": td.Value(0.1)}), cancellation=controller(law, LAWS[law])
    )
    if law == "karnopp":
        blocks = (replace(b, input="R_D") if b.name == "C" else b for b in diagram.blocks)
        diagram = replace(diagram, blocks=tuple(blocks))
    return simulate(
        diagram,
        duration=duration,
        motion={"L": motion},
        inputs={"R_D": COMMAND},
        computer=computer,
        every_step=computer == "continuous",
    )


def laws():
    """Each law over one cycle of a small motion, 0.4 mm at 2 Hz."""
    motion = sine(amplitude=4e-4, frequency=2.0)
    with plt.style.context(STYLE):
        figure, axes = plt.subplots(1, 2, sharey=True, figsize=(7.16, 2.7))
        for law, (color, line) in LINES.items():
            motion_with_law = led(law, motion, 1.0, "continuous")
            cycle = slice(len(motion_with_law["time"]) // 2, None)  # the first one settles
            force = motion_with_law["R_MBC"].values[cycle]
            style = {"color": color, "linestyle": line, "label": law.replace("_", " ")}
            axes[0].plot(1e3 * motion_with_law["L_velocity"].values[cycle], force, **style)
            axes[1].plot(1e3 * motion_with_law["L"].values[cycle], force, **style)
        axes[0].set(xlabel="velocity (mm/s)", ylabel="added force (N)")
        axes[1].set(xlabel="position (mm)")
        for axis, title in zip(axes, ("(a) over velocity", "(b) over position"), strict=True):
            axis.set_title(title, loc="left")
        for axis in axes:
            axis.grid(True)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right center")
    return figure


ESTIMATES = {
    "difference": {"velocity": "difference"},
    "filtered, 30 Hz": {"velocity_bandwidth": 30.0},
    "observer of order 2, 30 Hz": {
        "velocity": "observer",
        "velocity_bandwidth": 30.0,
        "observer_order": 2,
    },
    "observer of order 3, 30 Hz": {"velocity": "observer", "velocity_bandwidth": 30.0},
}


def estimates():
    """Smoothed Coulomb cancellation through a reversal, encoder steps of 7.2 um."""
    motion = sine(amplitude=2e-3, frequency=2.0)
    start, end = 0.0999, 0.2001
    true = led("smoothed_coulomb", motion, 0.25, "continuous")
    with plt.style.context(STYLE):
        figure, axes = plt.subplots(2, 2, sharex=True, sharey=True, figsize=(7.16, 3.4))
        for axis, letter, (name, way) in zip(axes.flat, "abcd", ESTIMATES.items(), strict=True):
            sampled = led("smoothed_coulomb", motion, 0.25, Sampling(encoder_step=7.2e-6, **way))
            for simulation, style in (
                (true, {"color": "0.6", "lw": 2.2, "label": "true velocity"}),
                (sampled, {"color": "#0072B2", "label": "sampled", "drawstyle": "steps-post"}),
            ):
                shown = simulation.data.sel(time=slice(start, end))
                axis.plot(1e3 * shown["time"], shown["R_MBC"], **style)
            axis.set_title(f"({letter}) {name}", loc="left")
            axis.grid(True)
        axes[0, 0].legend(loc="upper right")
        for axis in axes[1]:
            axis.set_xlabel("time (ms)")
        figure.supylabel("added force (N)", fontsize=8)
    return figure
