"""What each effect leaves in a model that lacks it, over velocity and position; and its look-alike.

python docs/make_residual_maps.py

One motion of one device is given. For each effect the command is computed that keeps this motion up
where the effect is there; a model of inertia, Coulomb and viscous friction is fitted to it by least
squares, and what it leaves is drawn. Two effects look alike where what they leave does: the cosine
of the two residuals, at these values and along this motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

import teleopdesign as td  # noqa: E402
from teleopdesign.blocks import Body, Value  # noqa: E402
from teleopdesign.measurement.motion import motion_of  # noqa: E402
from teleopdesign.realise.along_motion import residual_along  # noqa: E402

STYLE = Path(td.__file__).parent / "show" / "figures" / "teleopdesign.mplstyle"
STATIC = Path(__file__).parent / "_static"
PICTURE, TABLE = STATIC / "residual_maps.png", STATIC / "residual_maps.txt"
SAMPLE_TIME = 1e-3  # s
DURATION = 8.0  # s
#: the device: kg, N, N s/m
PLAIN = {"inertia": 0.2, "coulomb.level": 0.6, "viscous.damping": 1.5}
#: SI values at which each effect is a good part of the friction; optional ones are zero
VALUES: Mapping[str, Mapping[str, float]] = {
    "stribeck": {"extra_static_level": 0.3, "stribeck_velocity": 0.02},
    "presliding": {"stiffness": 1500.0, "bristle_damping": 0.0},
    "coulomb_asymmetry": {"half_difference": 0.15},
    "load_dependent_friction": {"coefficient": 0.3},
    "position_dependent_friction": {"amplitude": 0.4, "period": 0.02, "phase": 0.0},
    "friction_drift": {"fraction": 0.5, "time_constant": 3.0},
    "viscous_asymmetry": {"half_difference": 0.7},
    "quadratic_drag": {"drag": 4.0},
    "shear_thinning": {"drag": 0.8, "exponent": 0.4},
    "bias": {"force": 0.2},
    "spring": {"stiffness": 10.0},
    "hardening_spring": {"stiffness": 8e3},
    "cogging": {"amplitude": 0.2, "period": 0.02, "phase": 0.0},
    "position_dependent_gain": {"fall": 900.0, "centre": 0.0},
    "torque_ripple": {"amplitude": 0.2, "period": 0.02, "phase": 0.0},
    "actuator_gain": {"gain": 0.8},
    "actuator_saturation": {"limit": 1.2},
    "actuator_lag": {"time_constant": 8e-3},
    "actuation_delay": {"delay": 8e-3},
}


def motion() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Time (n,) in s and position (n,) in m: slow strokes with faster ones on them."""
    t = np.arange(0.0, DURATION, SAMPLE_TIME)
    slow = 0.03 * np.sin(2 * np.pi * 0.45 * t)
    return t, slow + 0.006 * np.sin(2 * np.pi * 1.9 * t) + 0.0015 * np.sin(2 * np.pi * 5.3 * t)


def hand(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Force of the hand (n,) in N; without one no scale of the actuator could be told."""
    return 0.6 * np.sin(2 * np.pi * 0.8 * t + 1.0)


def body(name: str | None) -> Body:
    """The plain device, with one effect beside."""
    numbers = dict(PLAIN)
    if name is not None:
        parameters = td.EFFECTS[name].parameters
        numbers |= {f"{name}.{p}": VALUES[name].get(p, 0.0) for p in parameters}
    names = ("coulomb", "viscous", *((name,) if name else ()))
    parameters = {n: Value(v) for n, v in numbers.items()}
    return Body("prismatic", parameters, tuple(td.EFFECTS[n] for n in names))


def force_error(name: str | None, command: NDArray[np.float64]) -> NDArray[np.float64]:
    """Force in N that a body with this effect leaves unexplained along the motion."""
    t, x = motion()
    along = motion_of(
        body="device", file="made", time=t, position=x, command=command, interaction=hand(t),
        sample_time=SAMPLE_TIME, rows=slice(0, len(t)), bandwidth=60.0, resolution=None,
    )  # fmt: skip
    return np.asarray(residual_along(body(name), along).residual.value)


def left_by(name: str, plain: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the fitted plain model leaves where the effect is there, to first order in the effect.

    plain: (n,) command that the plain device needs
    """
    whole = force_error(None, plain) - force_error(name, plain)
    t, x = motion()
    v = np.gradient(x, t)
    columns = np.stack([np.gradient(v, t), np.sign(v), v], axis=1)
    inner = slice(300, -300)  # 0.3 s: the first and last stretch, in which hidden states settle
    solution, *_ = np.linalg.lstsq(columns[inner], whole[inner], rcond=None)
    return np.asarray((whole - columns @ solution)[inner])


def look_alikes(left: Mapping[str, NDArray[np.float64]]) -> str:
    """A line an effect: the part of it that no refit hides, and what is most like it."""
    lines = ["effect                       left (N rms)   most like it (cosine)"]
    for name, r in left.items():
        likeness = {
            n: float(r @ o / np.sqrt((r @ r) * (o @ o))) for n, o in left.items() if n != name
        }
        best = sorted(likeness, key=lambda n: -abs(likeness[n]))[:2]
        names_of_best = ", ".join(f"{n} ({likeness[n]:+.2f})" for n in best)
        lines.append(f"{name:<28} {np.sqrt(np.mean(r**2)):<14.3f} {names_of_best}")
    return "\n".join(lines) + "\n"


def draw(left: Mapping[str, NDArray[np.float64]]) -> plt.Figure:
    """For each effect its residual over velocity and over position."""
    t, x = motion()
    v = np.gradient(x, t)
    inner = slice(300, -300)
    places: Any
    with plt.style.context(STYLE):
        rows = -(-len(left) // 3)
        figure, places = plt.subplots(rows, 6, figsize=(10.0, 1.55 * rows), layout="constrained")
        for k, (name, r) in enumerate(left.items()):
            pair = places[k // 3, 2 * (k % 3) : 2 * (k % 3) + 2]
            for axes, across, label in zip(
                pair, (v, 1e3 * x), ("velocity (m/s)", "position (mm)"), strict=True
            ):
                axes.plot(across[inner][::3], r[::3], ".", ms=0.9, color="#D55E00")
                axes.axhline(0, color="k", lw=0.4)
                axes.tick_params(labelsize=6)
                axes.set_xlabel(label, fontsize=7, labelpad=1)
            pair[0].set_title(name, loc="left", fontsize=8)
            pair[0].set_ylabel("residual (N)", fontsize=7, labelpad=1)
            # rows at rest, where friction may be anything, would set the scale: 1 % is left out
            low, high = min(0.0, np.quantile(r, 0.005)), max(0.0, np.quantile(r, 0.995))
            for axes in pair:
                axes.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
            pair[1].set_yticklabels([])
        for axes in places.flat[2 * len(left) :]:
            axes.axis("off")
    return figure


if __name__ == "__main__":
    needed = -force_error(None, np.zeros(len(motion()[0])))
    residuals = {name: left_by(name, needed) for name in VALUES}
    TABLE.write_text(look_alikes(residuals), encoding="utf-8")
    draw(residuals).savefig(PICTURE, dpi=130)
    print(TABLE.read_text(encoding="utf-8"), PICTURE.stat().st_size // 1000, "kB")
