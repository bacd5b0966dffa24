"""A body along a measured motion: the force that its model leaves unexplained, with tangents.

The motion is given, so the effects decouple: each turns arrays into arrays, composed by role.

    command -> actuation stages (averages over each hold) -> acting force at the rows
    needed friction = acting + interaction - inertia a - forces
    friction = shape(level, motion); where the position cannot tell a motion it is what balances
    residual = needed friction - friction           > 0: more force acts than the model needs

Every array carries its tangents, the derivatives by the parameters that are asked for; both come
from the same sympy law. Hidden states advance exactly where their rate is affine in them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy as sp

from ..blocks import Body
from ..blocks.environment import touching
from ..effects import SIGNALS, UNEXPLAINED, Effect, Role, delayed, ordered
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from .balance import balanced
from .ode_scan import ode_scan
from .scan import driven_scan, shape_bounds, stage_scan
from .traced import TRACED, Law, Probe, Traced, law_of, through

_MOTION = ("time", "position", "velocity", "acceleration")
#: parts of a row over which a command that acts late is averaged
PARTS = 4


@dataclass(frozen=True)
class Stage:
    """A stage of the actuation along a motion: what goes in, what comes out, hidden states between.

    law: on symbols, its delayed signals as symbols of their own;  delays: those symbols -> s
    given: symbols -> signals over `parts` equal parts of each row;  output: as long
    """

    effect: Effect
    law: sp.Expr
    delays: Mapping[sp.Symbol, float]
    given: Mapping[sp.Symbol, Traced]
    parts: int
    output: Traced


@dataclass(frozen=True)
class Residual:
    """What the model leaves along one motion (n samples), SI, tangents (p, n).

    residual: force that acts beyond what the model needs;  friction: the model's friction force
    acting: acting force at the rows;  moving: less the friction that it makes itself
    """

    motion: Motion
    residual: Traced
    friction: Traced
    acting: Traced
    moving: Traced


def residual_along(body: Body, motion: Motion, wrt: Sequence[str | Probe] = ()) -> Residual:
    """Residual force of the body's model along the motion.

    wrt: parameters ("coulomb.level") or probes whose tangents are carried along
    returns: n samples smoothed as the motion is, not yet through the comparison's low-pass
    """
    symbols, values = body.symbols(), body.numbers()
    columns = [name if isinstance(name, Probe) else symbols[name] for name in wrt]
    n = len(motion.time)

    def plain(y: Array) -> Traced:
        return Traced(y, np.zeros((len(columns), n)))

    given = {SIGNALS[name]: plain(getattr(motion, name)) for name in _MOTION}
    acting = _acting(body, motion, plain(motion.command), values, columns)
    given[SIGNALS["acting_force"]] = acting
    given[SIGNALS["interaction_force"]] = plain(motion.interaction)
    inertia = law_of(symbols["inertia"] * SIGNALS["acceleration"])
    needed = acting + plain(motion.interaction) - inertia(given, values, columns)
    for effect in _present(body, "force", values):
        needed = needed - _force(effect, given, values, columns, motion.sample_time)
    contact = body.contact()
    structures = _present(body, "structure", values)
    if contact != 0 and structures:
        structures = [touching(effect, contact) for effect in structures]
    elif contact != 0:
        needed = needed - law_of(contact)(given, values, columns)
    level, speeds = _level(body, motion, given, values, columns)
    given |= speeds
    low, high = _friction_bounds(body, level, motion, given, values, columns)
    for effect in structures:
        rest = (needed, low, high)
        needed = needed - _force(effect, given, values, columns, motion.sample_time, rest)
    friction = _friction(motion, needed, low, high)
    residual = needed - friction
    for effect in structures:
        residual = residual - _led(effect, motion, residual, values, columns)
    given[SIGNALS["direction"]] = plain(motion.direction.astype(float))
    moving = acting - _own_friction(level, friction, given, values, columns)
    return Residual(motion, residual, friction, acting, moving)


def _own_friction(
    level: sp.Expr,
    friction: Traced,
    given: Mapping[Any, Traced],
    values: Mapping[Any, float],
    columns: list[Any],
) -> Traced:
    """The part of the friction that the acting force itself makes."""
    if not level.has(SIGNALS["acting_force"]):
        return Traced(np.zeros_like(friction.value), np.zeros_like(friction.tangent))
    rest = level.subs(SIGNALS["acting_force"], 0)
    part = sp.Piecewise((1 - rest / level, level > 0), (0, True))
    share = _law_of_level(part, given, values)(given, values, columns)
    tangent = friction.tangent * share.value + friction.value * share.tangent
    return Traced(friction.value * share.value, tangent)


def _force(
    effect: Effect,
    given: Mapping[sp.Symbol, Traced],
    values: Mapping[Any, float],
    columns: list[Any],
    step: float,
    rest: Sequence[Traced] = (),
) -> Traced:
    """Force of an effect along the motion, its hidden states simulated.

    rest: force needed without it and the bounds of friction, to correct its states by
    """
    hidden = ode_scan(effect, given, values, columns, step, rest) if effect.states else {}
    law = law_of(effect.expression(), (*SIGNALS.values(), *hidden), TRACED | set(hidden))
    return law({**given, **hidden}, values, columns)


def _led(
    effect: Effect,
    motion: Motion,
    unexplained: Traced,
    values: Mapping[Any, float],
    columns: list[Any],
) -> Traced:
    """Force that it takes to lead a hidden body as its position is corrected."""
    momentum = effect.led_momentum()
    if momentum == 0:
        return Traced(np.zeros_like(unexplained.value), np.zeros_like(unexplained.tangent))
    law = law_of(momentum, (UNEXPLAINED,), frozenset({UNEXPLAINED}))
    slope = motion.spectrum.derivative(1) * motion.smoothing
    led = law({UNEXPLAINED: unexplained}, values, columns)
    return through(lambda y: motion.spectrum.multiply(y, slope), led)


def _present(body: Body, role: Role, values: Mapping[Any, float]) -> list[Effect]:
    """Effects of a role but those whose values say that they are absent: laws may divide by it."""
    return [e for e in ordered(body.effects, role) if not (e.states and e.is_absent(values))]


def _acting(
    body: Body, motion: Motion, command: Traced, values: Mapping[Any, float], columns: list[Any]
) -> Traced:
    """Acting force at the rows."""
    stages = stages_along(body, motion, command, values, columns)
    return through(motion.at_rows, stages[-1].output if stages else command)


def stages_along(
    body: Body,
    motion: Motion,
    command: Traced,
    values: Mapping[Any, float],
    columns: list[Any],
) -> list[Stage]:
    """Each stage of the actuation, on averages over the hold of a row, or over parts of it.

    What is late turns edges of the staircase into something between the rows.
    command: at the rows (n);  values: of the body's parameters, by symbol
    """
    effects = _present(body, "actuation", values)
    parts = PARTS if any(e.states or e.expression().has(delayed) for e in effects) else 1
    signal = Traced(np.repeat(command.value, parts), np.repeat(command.tangent, parts, axis=1))
    along = {name: np.repeat(getattr(motion, name), parts) for name in _MOTION}
    stages: list[Stage] = []
    for effect in effects:
        stages.append(_stage(effect, along, motion.sample_time / parts, signal, values, columns))
        signal = stages[-1].output
    return [replace(stage, parts=parts) for stage in stages]


def _stage(
    effect: Effect,
    along: Mapping[str, Array],
    step: float,
    command: Traced,
    values: Mapping[Any, float],
    columns: list[Any],
) -> Stage:
    """A stage of the actuation, as averages over each step (s) of its command."""
    law = effect.expression()
    zero = np.zeros_like(command.tangent)
    given = {SIGNALS[name]: Traced(signal, zero) for name, signal in along.items()} | {
        SIGNALS["command"]: command
    }
    extra: list[sp.Symbol] = []
    delays: dict[sp.Symbol, float] = {}
    for i, call in enumerate(sorted(law.atoms(delayed), key=str)):
        symbol = sp.Symbol(f"delayed_{i}", real=True)
        law = law.subs(call, symbol)
        given[symbol] = _shifted(command, call.args[1], values, columns, step)
        delays[symbol] = max(float(call.args[1].subs(values)), 0.0)
        extra.append(symbol)
    if effect.states:
        outputs = stage_scan(effect, given, values, columns, step)
        given |= outputs
        extra += outputs
    signals = (*SIGNALS.values(), *extra)
    output = law_of(law, signals, TRACED | set(extra))(given, values, columns)
    return Stage(effect, law, delays, given, 1, output)


def _shifted(
    signal: Traced, delay: sp.Expr, values: Mapping[Any, float], columns: list[Any], step: float
) -> Traced:
    """A held signal some time earlier, as averages over each hold: exact, linear between rows."""
    tau = float(delay.subs(values))
    whole, part = divmod(max(tau, 0.0) / step, 1.0)
    n = signal.value.shape[-1]
    late = np.clip(np.arange(n) - int(whole), 0, None)
    later = np.clip(late - 1, 0, None)
    value = (1 - part) * signal.value[late] + part * signal.value[later]
    tangent = (1 - part) * signal.tangent[:, late] + part * signal.tangent[:, later]
    slope = (signal.value[later] - signal.value[late]) / step
    for i, column in enumerate(columns):
        if isinstance(column, sp.Symbol) and delay.has(column):
            tangent[i] += slope * float(sp.diff(delay, column).subs(values))
    return Traced(value, tangent)


def _level(
    body: Body,
    motion: Motion,
    given: Mapping[Any, Traced],
    values: Mapping[Any, float],
    columns: list[Any],
) -> tuple[sp.Expr, dict[Any, Traced]]:
    """The friction level, and along the motion the hidden speeds that it follows."""
    level = body.level()
    speeds: dict[Any, Traced] = {}
    for effect in ordered(body.effects, "friction_speed"):
        if effect.is_absent(values):
            level = level.subs(effect.expression(), sp.Abs(SIGNALS["velocity"]))
        else:
            speeds |= driven_scan(effect, given, values, columns, motion.sample_time)
    return level, speeds


def level_along(
    body: Body, motion: Motion, given: Mapping[Any, Traced], values: Mapping[Any, float]
) -> tuple[sp.Expr, dict[Any, Traced]]:
    """The friction level on symbols, and along the motion the hidden speeds that it follows."""
    return _level(body, motion, given, values, [])


def _law_of_level(
    expression: sp.Expr, given: Mapping[Any, Traced], values: Mapping[Any, float]
) -> Law:
    """An expression of signals, parameters and hidden speeds, which carry tangents, as a law."""
    hidden = tuple(s for s in given if s not in SIGNALS.values() and s not in values)
    return law_of(expression, (*SIGNALS.values(), *hidden), TRACED | set(hidden))


def _friction_bounds(
    body: Body,
    level: sp.Expr,
    motion: Motion,
    given: Mapping[Any, Traced],
    values: Mapping[Any, float],
    columns: list[Any],
) -> tuple[Traced, Traced]:
    """Least and largest friction at each row; they coincide where the motion tells it."""
    zero = np.zeros((len(columns), len(motion.time)))
    if level == 0:
        none = Traced(np.zeros(len(motion.time)), zero)
        return none, none
    law = _law_of_level(level, given, values)

    def towards(way: float) -> Traced:
        ways = {SIGNALS["direction"]: Traced(np.full(len(motion.time), way), zero)}
        found = law({**given, **ways}, values, columns)
        found.tangent[:, found.value < 0] = 0.0
        return Traced(np.maximum(found.value, 0.0), found.tangent)

    forward = towards(1.0)
    backward = towards(-1.0) if level.has(SIGNALS["direction"]) else forward
    shapes = _present(body, "friction_shape", values)
    if shapes:
        return shape_bounds(shapes[0], motion, given, forward, backward, values, columns)
    return _sliding_bounds(motion, forward, backward)


def _friction(motion: Motion, needed: Traced, low: Traced, high: Traced) -> Traced:
    """Friction within its bounds that balances what is needed."""
    if low is high:
        return low
    both = balanced(
        needed.rows(),
        low.rows(),
        high.rows(),
        bandwidth=motion.bandwidth,
        sample_time=motion.sample_time,
    )
    return Traced(both[0], both[1:])


def _sliding_bounds(motion: Motion, forward: Traced, backward: Traced) -> tuple[Traced, Traced]:
    """sgn v times the level where the motion is told, anything up to it where it is not."""
    ahead, back = motion.direction > 0, motion.direction < 0
    low = Traced(
        np.where(ahead, forward.value, -backward.value),
        np.where(ahead, forward.tangent, -backward.tangent),
    )
    high = Traced(
        np.where(back, -backward.value, forward.value),
        np.where(back, -backward.tangent, forward.tangent),
    )
    return low, high
