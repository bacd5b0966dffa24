"""Laws of the package with symbols of a proof; every law comes from the catalogues."""

from __future__ import annotations

from types import SimpleNamespace

import sympy as sp

from ..controllers import CONTROLLERS
from ..effects import EFFECTS


def coulomb(velocity: sp.Expr, level: sp.Expr) -> sp.Expr:
    """Friction force of the effect `coulomb`: level sgn v."""
    return EFFECTS["coulomb"].expression(values={"level": level}) * sp.sign(velocity)


def viscous(velocity: sp.Expr, damping: sp.Expr) -> sp.Expr:
    """Force of the effect `viscous`."""
    return EFFECTS["viscous"].expression({"velocity": velocity}, {"damping": damping})


def stribeck_level(velocity: sp.Expr, level: sp.Expr, extra: sp.Expr, scale: sp.Expr) -> sp.Expr:
    """Friction level of the effects `coulomb` and `stribeck` together."""
    values = {"extra_static_level": extra, "stribeck_velocity": scale}
    return EFFECTS["coulomb"].expression(values={"level": level}) + EFFECTS["stribeck"].expression(
        {"velocity": velocity}, values
    )


def smoothed_coulomb(velocity: sp.Expr, level: sp.Expr, smoothing: sp.Expr) -> sp.Expr:
    """Force of the controller `smoothed_coulomb`, block C."""
    now = SimpleNamespace(velocity=velocity, speed=sp.Abs(velocity))
    p = SimpleNamespace(level=level, smoothing_velocity=smoothing)
    return sp.sympify(CONTROLLERS["smoothed_coulomb"].law(now, p))


def schedule(speed: sp.Expr, gain: sp.Expr, scheduling: sp.Expr) -> sp.Expr:
    """Gain of the controller `velocity_schedule`, block H at zero frequency."""
    now = SimpleNamespace(input=sp.S(1), speed=speed)
    p = SimpleNamespace(gain=gain, scheduling_velocity=scheduling)
    return sp.sympify(CONTROLLERS["velocity_schedule"].law(now, p))


def bristle_rate(
    bristle: sp.Expr, velocity: sp.Expr, level: sp.Expr, stiffness: sp.Expr
) -> sp.Expr:
    """Rate of the bristle of the effect `presliding`."""
    signals = {"velocity": velocity, "level": level, "bristle": bristle}
    return EFFECTS["presliding"].rates(signals, {"stiffness": stiffness, "bristle_damping": 0})[
        "bristle"
    ]


def bristle_force(
    bristle: sp.Expr, velocity: sp.Expr, level: sp.Expr, stiffness: sp.Expr, damping: sp.Expr
) -> sp.Expr:
    """Friction force of the effect `presliding`, with bristle damping: the LuGre model."""
    signals = {"velocity": velocity, "level": level, "bristle": bristle}
    values = {"stiffness": stiffness, "bristle_damping": damping}
    return EFFECTS["presliding"].expression(signals, values)


def dahl_rate(force: sp.Expr, velocity: sp.Expr, level: sp.Expr, stiffness: sp.Expr) -> sp.Expr:
    """Rate of the force of the controller `dahl`, from its law and the rate of its state."""
    law = CONTROLLERS["dahl"]
    z = sp.Symbol("z", real=True)
    now = SimpleNamespace(bristle=z, travel_rate=velocity, velocity=velocity)
    p = SimpleNamespace(level=level, stiffness=stiffness)
    output = sp.sympify(law.law(now, p))
    rate = sp.diff(output, z) * sp.sympify(law.states["bristle"].rate(now, p))
    return sp.expand(rate.subs(z, force / sp.diff(output, z)))


def dahl_step(
    force: sp.Expr, distance: sp.Expr, direction: int, level: sp.Expr, stiffness: sp.Expr
) -> sp.Expr:
    """Force of `dahl` after a travel distance >= 0 in one direction (1 or -1), from the rate.

    The rate at unit speed is affine, A f + B. The step is exact, as for every sampled controller:
    e^(A d) f + B (e^(A d) - 1)/A.
    """
    f = sp.Symbol("f_before", real=True)
    rate = dahl_rate(f, sp.S(direction), level, stiffness)
    a = sp.diff(rate, f)
    b = rate.subs(f, 0)
    growth = sp.exp(a * distance)
    return growth * force + b * (growth - 1) / a


def dahl_loop(position: sp.Expr, amplitude: sp.Expr, level: sp.Expr, stiffness: sp.Expr) -> sp.Expr:
    """Force of `dahl` on the rising branch of the steady loop with that amplitude.

    The branch starts at -level tanh(u) at -amplitude, u = stiffness amplitude/level. The falling
    branch is its mirror image in the origin.
    """
    lowest = -level * sp.tanh(stiffness * amplitude / level)
    return dahl_step(lowest, position + amplitude, 1, level, stiffness)
