"""One part of a diagram as an equation on its signals, and parts without equations."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import Controller, ControllerEquation
from ..diagrams import Attached, Control, Diagram, Junction, Kinematics, Moving
from ..diagrams.junctions import Weight
from ..diagrams.wiring import without_motion
from ..effects import SIGNALS, Effect
from .signal_symbols import LateSignals, without_delays

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
        stages = part.controller.stages[:1] if isinstance(part.controller, Controller) else ()
        if part.input in motions and any(g.law.takes == "force" for g in stages):
            raise ModelError(
                f"{diagram.name}: {part.name}: {stages[0].law.name} takes a force, found the "
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
