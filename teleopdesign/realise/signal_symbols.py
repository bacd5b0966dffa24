"""The symbols of a diagram's signals, and one part of it as an equation on them.

The simulation reads a delayed signal of a law from its history, under a symbol of its own. On a
grid a delay is whole steps or samples where possible, otherwise between two of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import SIGNALS as CONTROL_SIGNALS
from ..controllers import Controller, ControllerEquation, parameter_symbol
from ..diagrams import Attached, Control, Diagram, Junction, Kinematics, Moving
from ..diagrams.junctions import Weight
from ..diagrams.wiring import without_motion
from ..effects import SIGNALS, Effect, delayed

TIME = sp.Symbol("time", real=True)
#: duration of a sample, in the laws of what is sampled
PERIOD = CONTROL_SIGNALS["period"]


def signal(name: str) -> sp.Symbol:
    """Symbol of a signal; for a motion, of its position."""
    return sp.Symbol(name, real=True)


def velocity(motion: str) -> sp.Symbol:
    return sp.Symbol(f"{motion}_velocity", real=True)


def acceleration(motion: str) -> sp.Symbol:
    return sp.Symbol(f"{motion}_acceleration", real=True)


def reading_symbol(name: str) -> sp.Symbol:
    """Symbol of a sensor's reading at a sample."""
    return sp.Symbol(f"{name}_measured", real=True)


def travel_rate(motion: str) -> sp.Symbol:
    """Symbol of the measured travel of the last sample over its duration."""
    return sp.Symbol(f"{motion}_travel_rate", real=True)


def estimate(motion: str) -> sp.Symbol:
    """Symbol of the velocity as the computer estimates it: filtered travel rate, or an observer."""
    return sp.Symbol(f"{motion}_velocity_estimate", real=True)


def rate_of(position: sp.Expr, rate: Callable[[str], sp.Expr]) -> sp.Expr:
    """Rate of change of a position on motions of bodies;  rate: motion -> its velocity."""
    return sp.Add(*(sp.diff(position, x) * rate(x.name) for x in position.free_symbols))


def motion_of(diagram: Diagram, name: str) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Position, velocity and acceleration of a motion, written in those of the moving bodies."""
    position = diagram.position(name)
    speed = rate_of(position, velocity)
    bent = (sp.diff(speed, x) * velocity(x.name) for x in position.free_symbols)
    return position, speed, sp.Add(rate_of(position, acceleration), *bent)


def parameter_names(diagram: Diagram) -> dict[sp.Symbol, str]:
    """Symbol of each parameter -> its name in `Diagram.values`."""
    names = {}
    for full in diagram.values:
        block, _, local_name = full.partition(".")
        names[parameter_symbol(block, local_name)] = full
    return names


#: late signal -> what it was, and how much earlier
LateSignals = dict[sp.Symbol, tuple[sp.Expr, sp.Expr]]


def without_delays(
    equation: ControllerEquation, name: str, late: LateSignals
) -> ControllerEquation:
    """The equation with a symbol for each delayed signal; these signals are put into `late`."""

    def replaced(changes: Mapping[sp.Symbol, sp.Expr]) -> dict[sp.Symbol, sp.Expr]:
        return {x: replace_delays(name, change, late) for x, change in changes.items()}

    return ControllerEquation(
        replace_delays(name, equation.output, late),
        replaced(equation.rates),
        replaced(equation.steps),
        equation.before,
    )


def replace_delays(name: str, expression: sp.Expr, late: LateSignals) -> sp.Expr:
    """The expression with a symbol for each delayed(x, tau), which is put into `late`."""
    while calls := expression.atoms(delayed):
        innermost = (c for c in calls if not any(x.has(delayed) for x in c.args))
        for call in sorted(innermost, key=str):
            symbol = sp.Symbol(f"{name}_late_{len(late)}", real=True)
            symbol = {c: s for s, c in late.items()}.get(call.args, symbol)
            late[symbol] = call.args
            expression = expression.xreplace({call: symbol})
    return expression


#: distance of a delay from a whole number of steps or samples that is rounding of the division
_WHOLE = 1e-9


def is_whole(count: float) -> bool:
    """Whether a delay of `count` steps or samples is whole, except for rounding."""
    return abs(count - round(count)) <= _WHOLE * max(count, 1.0)


def delay_in_samples(delay: float, period: float, *, what: str) -> float:
    """The delay of a computer's signal in samples, at least one.

    delay, period: s;  what: first words of the error
    raises ModelError: the delay is below the period
    """
    count = delay / period
    if is_whole(count) and round(count) >= 1:
        return float(round(count))
    if count < 1:
        raise ModelError(
            f"{what}: a delay of {delay * 1e3:g} ms is below the computer's period of "
            f"{period * 1e3:g} ms: make the block analog, or the period shorter"
        )
    return count


#: signal's name -> symbol that stands for it
SignalReader = Callable[[str], sp.Symbol]
#: the velocity of a controller without a motion: no law may use it
NO_VELOCITY = sp.Symbol("no_velocity", real=True)
#: the command of a controller without one among its other signals
NO_COMMAND = sp.Symbol("no_command_read", real=True)


def _uses(effect: Effect, signal: sp.Symbol) -> bool:
    """Whether a law of the effect uses this signal of its body."""
    return any(law.has(signal) for law in (effect.expression(), *effect.rates().values()))


def refuse_unsimulated(part: Moving | Attached, diagram: str) -> None:
    """Refuse a body with an effect that no simulation has: a hidden tip, or a record's channel.

    raises ModelError: with the effect
    """
    assert isinstance(part.body, Body)
    if parted := [e.name for e in part.body.effects if e.role == "structure"]:
        raise ModelError(
            f"{diagram}: {part.name}: {parted[0]} has no simulated form: what holds "
            "the body would have to be wired to its tip (transmission_compliance has one)"
        )
    if unknown := [e.name for e in part.body.effects if e.channels()]:
        raise ModelError(
            f"{diagram}: {part.name}: {unknown[0]} has no simulated form: its law "
            "uses a channel of a record"
        )
    outside = SIGNALS["interaction_force"]
    if unknown := [e.name for e in part.body.effects if _uses(e, outside)]:
        raise ModelError(
            f"{diagram}: {part.name}: {unknown[0]} has no simulated form: its law "
            "uses now.interaction_force, a channel of a record; a diagram has none"
        )


def check_inputs(diagram: Diagram, motions: list[str]) -> None:
    """Refuse a motion as the input of a law that takes a force.

    raises ModelError: with the law and the motion
    """
    for part in diagram.controls:
        if part.input in motions and any(g.law.takes == "force" for g in part.stages[:1]):
            raise ModelError(
                f"{diagram.name}: {part.name}: {part.stages[0].law.name} takes a force, found the "
                f'motion "{part.input}": wire its input to the force that is commanded'
            )


def place_controller(
    part: Control,
    input: sp.Expr,
    rate: sp.Expr,
    speed: sp.Expr,
    period: sp.Expr = sp.S.Zero,
    *,
    others: tuple[sp.Expr, ...],
    late: LateSignals,
) -> ControllerEquation:
    """The equation of a controller on signals; its delayed signals are put into `late`.

    raises ModelError: the law uses a velocity, but the controller has no motion
    """
    assert isinstance(part.controller, Controller)
    signals = {"input": input, "velocity": speed, "speed": sp.Abs(speed), "travel_rate": rate}
    signals |= {"period": period, "command": others[0] if others else NO_COMMAND}
    made = part.controller.equation(part.name, signals, others=others, code=True)
    if any(e.has(NO_COMMAND) for e in (made.output, *made.rates.values())):
        raise ModelError(
            f'{part.name}: its law reads the command without it, and none is wired: others=("X",) '
            "says which"
        )
    equation = without_delays(made, part.name, late)
    kept = [*equation.rates.values(), *equation.steps.values(), *(e for e, _ in late.values())]
    if any(e.has(NO_VELOCITY) for e in (equation.output, *kept)):
        raise without_motion(part.name)
    return equation


def sum_inputs(part: Junction | Kinematics, of: SignalReader) -> sp.Expr:
    """Output of a junction or kinematics;  of: name of a signal -> its symbol."""
    if isinstance(part, Kinematics):
        return _read(part.expression, of)
    return sp.Add(*(_read(weight, of) * of(s) for s, weight in part.terms.items()))


def _read(weight: Weight, of: SignalReader) -> sp.Expr:
    expression = sp.sympify(weight, strict=True)
    return expression.xreplace({x: of(x.name) for x in expression.free_symbols})
