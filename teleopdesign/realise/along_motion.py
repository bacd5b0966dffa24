"""A body along a measured motion: the force that its model leaves unexplained, with tangents.

The motion is prescribed, so the effects decouple: each turns arrays into arrays, composed by role.

    command -> actuation stages (averages over each hold) -> acting force at the rows
    needed friction = acting + interaction - inertia a - forces (- force of an arm's links)
    friction = shape(level, motion); where no motion is certain, the force that balances
    residual = needed friction - friction           > 0: more force acts than the model needs

Every array has its tangents, the derivatives by the requested parameters; both come from the same
sympy law. Hidden states advance exactly where their rate is affine in them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.errors import ModelError
from ..blocks import Body
from ..effects import (
    INERTIA,
    SIGNALS,
    UNEXPLAINED,
    Effect,
    make_rubbing_structure,
    make_touching_structure,
)
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from .friction_along import balance_friction, bound_friction, friction_of_acting_force, level_along
from .scan import coupled_scan
from .stages_along import (
    COMMAND_LATE,
    INTERACTION_LATE,
    INTERACTION_SHIFT,
    RECORD_SHIFT,
    acting_along,
)
from .tangent_columns import LinkParameter, Probe, TangentColumns
from .traced import Along, Traced, filter_traced

#: signal of a law -> its name in a motion, for signals that are known from the records alone
_MEASURED = {
    "time": "time",
    "position": "position",
    "velocity": "velocity",
    "acceleration": "acceleration",
    "direction": "direction",
    "command": "command",
    "interaction_force": "interaction",
}


_INERTIAL_FORCE = INERTIA * SIGNALS["acceleration"]


@dataclass(frozen=True)
class Residual:
    """Residual of the model along one motion (n samples), SI, with tangents (p, n).

    residual: acting force less the force that the model needs;  friction: the model's friction
    acting: acting force at the rows
    moving: acting force less the friction that it causes
    """

    motion: Motion
    residual: Traced
    friction: Traced
    acting: Traced
    moving: Traced


def residual_along(
    body: Body, motion: Motion, wrt: Sequence[str | Probe | LinkParameter] = ()
) -> Residual:
    """Residual force of the body's model along the motion.

    wrt: parameters ("coulomb.level"), `RECORD_SHIFT`, `INTERACTION_SHIFT`, probes or base
        parameters of an arm; the residual has tangents by each of these p
    returns: n samples, smoothed like the motion; the comparison's low-pass is not applied
    raises ModelError: an effect needs a channel that the motion lacks
    """
    along = measured_along(body, motion, wrt)
    interaction = along.signals[SIGNALS["interaction_force"]]
    acting = acting_along(body, motion, along)
    along = with_loads(body, motion, along, acting)
    inertia = along.evaluate(_INERTIAL_FORCE)
    forces = [_force(effect, along) for effect in along.present(body.effects, "force")]
    if motion.carried is not None:
        forces = [_force_of_links(motion, motion.carried, along), *forces]
    needed = (acting + interaction).subtract([inertia, *forces])
    contact = body.contact()
    structures = along.present(body.effects, "structure")
    if contact != 0 and structures:
        structures = [make_touching_structure(effect, contact) for effect in structures]
    elif contact != 0:
        needed = needed - along.evaluate(contact)
    if (held := body.tip_level()) != 0:
        structures = [make_rubbing_structure(effect, held) for effect in structures]
    level, along = level_along(body, along)
    low, high = bound_friction(body, level, motion, along, needed)
    for effect in structures:
        needed = needed - _force(effect, along, (needed, low, high))
    friction = balance_friction(motion, needed, low, high)
    residual = needed - friction
    for effect in structures:
        residual = residual - _leading_force(effect, motion, along, residual)
    moving = acting - friction_of_acting_force(level, friction, along)
    return Residual(motion, residual, friction, acting, moving)


def with_loads(body: Body, motion: Motion, along: Along, acting: Traced) -> Along:
    """Signals along a motion, with the acting force and, where friction needs it, the carried one.

    acting: acting force at the rows
    """
    along = along.with_signals({SIGNALS["acting_force"]: acting})
    if not body.level().has(SIGNALS["carried_force"]):
        return along
    carried = along.evaluate(body.carried_force())
    if motion.carried is not None:
        carried = carried + _force_of_links(motion, motion.carried, along)
    return along.with_signals({SIGNALS["carried_force"]: carried})


def friction_level_along(body: Body, motion: Motion) -> Array:
    """Friction level (n,) of a body along a motion, as far as it is the same in both directions."""
    known = measured_along(body, motion)
    known = with_loads(body, motion, known, residual_along(body, motion).acting)
    level, known = level_along(body, known)
    neither = known.constant(np.zeros(len(motion.time)))
    at_rest = known.with_signals({SIGNALS["direction"]: neither}).evaluate(level)
    return np.broadcast_to(at_rest.value, len(motion.time))


def _force_of_links(motion: Motion, force: Array, along: Along) -> Traced:
    """The force (n,) of an arm's links, with its tangents by their base parameters."""
    places = [(j, c.index) for j, c in enumerate(along.columns) if isinstance(c, LinkParameter)]
    if not places or motion.links is None:
        return along.constant(force)
    tangent = np.zeros((len(along.columns), len(force)))
    for j, index in places:
        tangent[j] = motion.links.columns[index]
    return Traced(force, tangent, tuple(j for j, _ in places))


def measured_along(
    body: Body, motion: Motion, wrt: Sequence[str | Probe | LinkParameter] = ()
) -> Along:
    """Signals along a motion from its records alone, with the body's parameters.

    wrt: as in `residual_along`
    raises ModelError: an effect needs a channel that the motion lacks
    """
    shifts = {RECORD_SHIFT: COMMAND_LATE, INTERACTION_SHIFT: INTERACTION_LATE}
    symbols = {**body.symbols(), **shifts}
    columns = TangentColumns(symbols[name] if isinstance(name, str) else name for name in wrt)
    along = Along({}, body.numbers(), columns, motion.sample_time)
    readings = {
        SIGNALS[n]: np.asarray(getattr(motion, column), float) for n, column in _MEASURED.items()
    }
    readings |= {SIGNALS[n]: signal for n, signal in motion.further.items()}
    for effect in body.effects:
        if missing := [n for n in sorted(effect.channels()) if n not in motion.further]:
            raise ModelError(
                f'{effect.name}: needs the channel "{missing[0]}", which {motion.file} has not'
            )
    signals = {s: along.constant(reading) for s, reading in readings.items()}
    if INTERACTION_LATE in columns:
        signals[SIGNALS["interaction_force"]] = _with_late_tangent(motion, columns)
    return along.with_signals(signals)


def _with_late_tangent(motion: Motion, columns: Sequence[object]) -> Traced:
    """The hand's force, with its tangent by the time constant T of its sensor.

    With a sensor low-pass of T, the force is f + T df/dt of the logged force f, so the tangent is
    df/dt.
    """
    tangent = np.zeros((len(columns), len(motion.time)))
    rate = motion.spectrum.derivative(1)
    logged = rate / (1.0 + motion.interaction_late * rate)
    place = columns.index(INTERACTION_LATE)
    tangent[place] = motion.spectrum.multiply(motion.interaction, logged)
    return Traced(motion.interaction, tangent, (place,))


def _force(effect: Effect, along: Along, rest: Sequence[Traced] = ()) -> Traced:
    """Force of an effect along the motion, with its hidden states simulated.

    rest: signals that correct the states: force needed without the effect, bounds of friction
    """
    if effect.states:
        along = along.with_signals(coupled_scan(effect, along, rest))
    return along.evaluate(effect.expression())


def _leading_force(effect: Effect, motion: Motion, along: Along, unexplained: Traced) -> Traced:
    """Force that moves a hidden body along with the corrections of its position."""
    momentum = effect.led_momentum()
    if momentum == 0:
        return along.constant(np.zeros_like(unexplained.value))
    slope = motion.spectrum.derivative(1) * motion.smoothing
    led = along.with_signals({UNEXPLAINED: unexplained}).evaluate(momentum)
    return filter_traced(lambda y: motion.spectrum.multiply(y, slope), led)
