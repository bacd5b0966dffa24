"""The exact machines as diagrams of the package, with its answer in the columns of theirs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from devices import body
from exact.machines import Belt, Bristle, Gap, LateSpring, Relay, Stroke

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Diagram, haptic_interface
from teleopdesign.simulate import Sampling, Trajectory


@dataclass(frozen=True)
class Pair:
    """A machine both ways.

    columns: name of the exact column -> signal of the diagram, and what to add to it over time
    positions: those of the columns that are positions; the others are forces
    """

    diagram: Diagram
    arguments: Mapping[str, Any]
    exact: Callable[[np.ndarray], Mapping[str, np.ndarray]]
    columns: Mapping[str, tuple[str, Callable[[np.ndarray], Any]]]
    positions: tuple[str, ...] = ("x",)


def pair(machine: Any) -> Pair:
    """The machine as a diagram, how it is simulated, and its exact columns."""
    return _PAIRS[type(machine)](machine)


def _nothing(t: np.ndarray) -> float:
    return 0.0


def _bristle_body(b: Bristle, **more: float):
    values = {
        "coulomb__level": b.level,
        "stribeck__extra_static_level": b.extra,
        "stribeck__stribeck_velocity": b.stribeck_velocity,
        "presliding__stiffness": b.stiffness,
        "presliding__bristle_damping": b.bristle_damping,
        "viscous__damping": b.viscous,
    }
    return body(b.mass, **values, **more)


def _belt(m: Belt) -> Pair:
    device = _bristle_body(m.body, spring__stiffness=m.spring)

    def exact(t):
        columns = m.motion(t)
        return {"x": columns["x"] + m.speed * t, "friction": columns["friction"]}

    return Pair(
        haptic_interface(device),
        {"inputs": {"R_V": m.force}, "computer": "continuous"},
        exact,
        {"x": ("L", lambda t: m.speed * t), "friction": ("Z_M_friction", _nothing)},
    )


def _bristle(m: Bristle) -> Pair:
    return Pair(
        haptic_interface(_bristle_body(m)),
        {"inputs": {"R_V": m.force}, "computer": "continuous"},
        m.motion,
        {"x": ("L", _nothing), "friction": ("Z_M_friction", _nothing)},
    )


def _stroke(m: Stroke) -> Pair:
    device = body(0.5, coulomb__level=m.level, presliding__stiffness=m.stiffness)
    motion = Trajectory(m.position, m.velocity, m.acceleration)
    return Pair(
        haptic_interface(device),
        {"motion": {"L": motion}, "computer": "continuous"},
        m.motion,
        {"friction": ("Z_M_friction", _nothing)},
        (),
    )


def _gap(m: Gap) -> Pair:
    device = body(
        m.first + m.second,
        backlash__tip_inertia=m.second,
        backlash__stiffness=m.stiffness,
        backlash__damping=m.damping,
        backlash__gap=m.gap,
        viscous__damping=m.viscous,
    )
    signals = {"x": "L", "tip": "L_tip", "force": "Z_M_transmission"}
    return Pair(
        haptic_interface(device),
        {"inputs": {"R_D": m.drive}, "computer": "continuous"},
        m.motion,
        {name: (signal, _nothing) for name, signal in signals.items()},
        ("x", "tip"),
    )


def _relay(m: Relay) -> Pair:
    device = body(m.mass, spring__stiffness=m.spring, viscous__damping=m.viscous)
    push = controller("coulomb", {"level": m.level})
    computer = Sampling(period=m.period, encoder_step=m.encoder_step)
    return Pair(
        haptic_interface(device, cancellation=push),
        {"initial": {"L": m.start}, "computer": computer},
        lambda t: m.motion(len(t) - 1),
        {"x": ("L", _nothing), "command": ("R_MBC", _nothing)},
    )


def _late(m: LateSpring) -> Pair:
    spring = controller("gain", {"gain": m.stiffness})
    device = body(m.mass, actuation_delay__delay=m.delay)
    return Pair(
        haptic_interface(device, position_loop=spring),
        {"inputs": {"L_D": m.step}, "computer": "continuous"},
        m.motion,
        {"x": ("L", _nothing), "force": ("R_A", _nothing)},
    )


_PAIRS: Mapping[type, Callable[[Any], Pair]] = {
    Belt: _belt,
    Bristle: _bristle,
    Stroke: _stroke,
    Gap: _gap,
    Relay: _relay,
    LateSpring: _late,
}


def _scaled(rng: np.random.Generator, values: Mapping[str, float]) -> dict[str, float]:
    """Each value times a factor from a half to two."""
    return {name: x * float(2.0 ** rng.uniform(-1, 1)) for name, x in values.items()}


def draw(rng: np.random.Generator, machine: Any) -> Any:
    """The machine with other values: every positive number times a factor from 1/2 to 2."""
    fields = {n: x for n, x in vars(machine).items() if isinstance(x, float) and x > 0}
    fields = {n: x for n, x in fields.items() if n not in ("period", "encoder_step")}
    new = _scaled(rng, fields)
    if "delay" in new:
        new["delay"] = round(new["delay"], 3)  # a whole number of steps
    if isinstance(machine, Belt):
        new["body"] = draw(rng, machine.body)
    return replace(machine, **new)
