"""Effects as a control law: the force that cancels them, made from the laws of their own files.

The control law "cancel" holds the effects that its parameters name, such as "cogging.amplitude":

    forces     each law as it stands, at the position input - zero and at the measured velocity
    friction   (sum of the levels times their factors) v/(a + abs(v)); a bristle that follows the
               measured travel with `presliding`; sgn v without either
    actuation  u = command + forces + friction comes out of it where `command` is the force
               commanded without this law: the output is acting^-1(u) - command

A level that grows with the acting force takes `command` for it. Time runs from power-on, in a
state. An effect that needs what no controller knows is refused with the reason.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from ..base.errors import ModelError
from ..base.recipes import remember
from ..blocks import Body, compose_equation
from ..effects import EFFECTS, SIGNALS, Effect, Parameter, delayed, find_effect, is_linear
from ._controller import ControlLaw, Controller, ControllerState, Stage, parameter_symbol
from ._law import SIGNALS as MEASURED

#: name of the control law
CANCEL = "cancel"
_ZERO, _SMOOTHING = "zero", "smoothing_velocity"
_DRIVING = ("input", "velocity", "travel_rate")
_MORE = {
    _ZERO: Parameter("position", "reading where the position of the effects is 0", -float("inf")),
    _SMOOTHING: Parameter("velocity", "a: speed at which half of the level is reached"),
}
_BEYOND = frozenset({"structure", "tip_level", "contact", "contact_shape"})
#: signals that no controller knows, in words
_UNKNOWN = {
    "acceleration": "the acceleration (`nominal_inertia` differentiates a velocity)",
    "interaction_force": "the interaction force",
    "carried_force": "the force that the transmission carries",
}


def cancel(
    what: Body | Mapping[Any, Mapping[str, float]],
    *,
    only: Collection[str] = (),
    smoothing_velocity: float | None = None,
    zero: float = 0.0,
) -> Controller:
    """A controller whose force cancels effects, by the laws of their own files.

    what: effect, or its name -> parameter values (SI); or a body with its effects and values
    only: names of the effects of `what` that are cancelled; (): all of them
    smoothing_velocity: a of friction that becomes v/(a + abs(v)) of its level, m/s or rad/s; None:
        sgn v, or a bristle if `presliding` is among the effects
    zero: reading of the position where the effects have their zero, m or rad
    raises ModelError: an effect cannot be cancelled, or lacks a value; the message says why

        >>> td.cancel({"coulomb": {"level": 1.5}, "viscous": {"damping": 0.4}})
        Controller cancel(coulomb.level = 1.5, viscous.damping = 0.4)
    """
    if isinstance(what, Body):
        effects = what.effects
        values = {n: v.value for n, v in what.parameters.items() if n != "inertia"}
    else:
        effects = tuple(e if isinstance(e, Effect) else find_effect(e) for e in what)
        values = {f"{e.name}.{n}": v for e, (_, t) in zip(effects, what.items(), strict=True)
                  for n, v in t.items()}  # fmt: skip
    names = [e.name for e in effects]
    if unknown := set(only) - set(names):
        raise ModelError(f'cancel: only: no effect "{min(unknown)}", has {", ".join(names)}')
    wanted = [e for e in effects if not only or e.name in only]
    kept = tuple(_keep(e, [n for n in e.parameters if values.get(f"{e.name}.{n}")]) for e in wanted)
    law = _law_of(kept, smoothing_velocity is not None)
    gone = {f"{e.name}.{n}" for e in effects for n in e.parameters} - {*law.parameters}
    values = {n: v for n, v in values.items() if n not in gone}
    stated = {_ZERO: zero, _SMOOTHING: smoothing_velocity}
    values |= {n: float(v) for n, v in stated.items() if n in law.parameters and v is not None}
    return Controller((Stage(law, values),))


def cancelling_law(
    parameters: Collection[str], effects: Mapping[str, Effect] = EFFECTS
) -> ControlLaw:
    """The law "cancel" with these parameters, such as "cogging.amplitude" and "zero".

    raises ModelError: no such effect or parameter, or an effect that cannot be cancelled
    """
    by_effect: dict[str, list[str]] = {}
    for name in parameters:
        if name not in _MORE:
            effect, _, parameter = name.partition(".")
            by_effect.setdefault(effect, []).append(parameter)
    named = (find_effect(name, effects, where=CANCEL) for name in by_effect)
    kept = tuple(_keep(e, by_effect[e.name]) for e in named)
    return _law_of(kept, _SMOOTHING in parameters)


def why_not_cancelled(effect: Effect, stated: Collection[str] = ()) -> str:
    """Why no control law can cancel an effect; "" where one can.

    stated: its optional parameters that are not zero
    """
    effect = _keep(effect, stated)
    laws = (effect.expression(), *effect.rates().values())
    if effect.role in _BEYOND:
        return "it acts beyond the body that the actuator moves"
    if effect.channels():
        return f"it needs the channel {', '.join(sorted(effect.channels()))}"
    for signal, words in _UNKNOWN.items():
        if any(law.has(SIGNALS[signal]) for law in laws):
            return f"it needs {words}"
    if effect.role == "friction_shape" and (effect.stops() or len(effect.states) > 1):
        return "its shape is no single bristle: state presliding, or smoothing_velocity"
    if effect.role == "actuation" and (effect.states or _inverse((effect,)) is None):
        return "no command in closed form makes up for it"
    symbols = effect.state_symbols()
    if any(sp.diff(rate, symbols[n]).has(symbols[n]) for n, rate in effect.rates().items()):
        return "a hidden state of it has no exact step"
    return ""


def _inverse(effects: tuple[Effect, ...]) -> tuple[sp.Expr, sp.Expr] | None:
    """Gain and offset of actuation stages that are linear in the command; None for others."""
    acting, command = compose_equation(effects).acting, SIGNALS["command"]
    gain = sp.diff(acting, command)
    if acting.has(delayed) or gain == 0 or gain.has(command):
        return None
    return gain, acting.xreplace({command: sp.S(0)})


def _keep(effect: Effect, stated: Collection[str]) -> Effect:
    """The effect without the optional parameters that are not stated."""
    for name in [n for n, p in effect.parameters.items() if p.optional and n not in stated]:
        effect = effect.without(name)
    return effect


@lru_cache(maxsize=256)
def _law_of(effects: tuple[Effect, ...], smoothed: bool) -> ControlLaw:
    """The control law of these effects; smoothed: friction is v/(a + abs(v)) of its level."""
    if not effects:
        raise ModelError("cancel: found no effect, expected one or more")
    # one law for all that say the same: files tell a law by its parameters
    if smoothed and any(e.role == "friction_shape" for e in effects):
        return _law_of(tuple(e for e in effects if e.role != "friction_shape"), smoothed)
    if smoothed and not any(e.role == "friction_level" for e in effects):
        return _law_of(effects, False)
    names = {e.name for e in effects}
    for effect in effects:
        if why := why_not_cancelled(effect):
            raise ModelError(f"cancel: {effect.name}: {why}")
        within = effect.role in ("friction_factor", "friction_speed", "friction_shape")
        if within and (missing := sorted(effect.needs - names)):
            raise ModelError(f'cancel: "{effect.name}" needs "{missing[0]}" beside it')
    output, rates = _place(effects, smoothed)
    used = set[sp.Basic]().union(*(x.free_symbols for x in (output, *rates.values())))
    stated = {_zero(): _ZERO, _smoothing(): _SMOOTHING}
    symbols = {s: n for s, n in stated.items() if s in used}
    symbols |= {s: f"{e.name}.{n}" for e in effects for n, s in e.symbols().items()}
    declared = {f"{e.name}.{n}": p for e in effects for n, p in e.parameters.items()} | _MORE
    quantities = {s: x.quantity for e in effects for n, x in e.states.items()
                  for s in [e.state_symbols()[n]]}  # fmt: skip
    if SIGNALS["time"] in used:
        rates, quantities[SIGNALS["time"]] = {**rates, SIGNALS["time"]: sp.S(1)}, "time"
    reads, driving = MEASURED["command"] in used, [MEASURED[n] for n in _DRIVING]
    about_zero = [x.xreplace({_zero(): sp.S(0)}) for x in (output, *rates.values())]
    made = ControlLaw(
        law=_Placed(output, symbols),
        parameters={n: declared[n] for n in symbols.values()},
        states={
            s.name: ControllerState(quantities[s], _Placed(r, symbols)) for s, r in rates.items()
        },
        linear=not reads and is_linear(about_zero, [*driving, *rates]),
        reads_command=reads,
        **_abilities({*symbols.values()}),
        source="; ".join(dict.fromkeys(e.source for e in effects)),
    )
    return remember(made.named(CANCEL, __doc__ or ""), _law_of, effects, smoothed)


def _abilities(parameters: set[str]) -> dict[str, Any]:
    """What the law is declared to be where friction of one level is all that it cancels.

    Claims derive these declarations from the equations.
    """
    level, bristle = "coulomb.level", "presliding.stiffness"
    declared = {
        (level,): {"bound": level},
        (level, _SMOOTHING): {"bound": level, "smoothing": _SMOOTHING},
        (level, bristle): {"bound": level, "bristle_stiffness": bristle},
    }
    return declared.get(tuple(sorted(parameters)), {})


def _zero() -> sp.Symbol:
    return parameter_symbol(CANCEL, _ZERO)


def _smoothing() -> sp.Symbol:
    return parameter_symbol(CANCEL, _SMOOTHING)


def _place(
    effects: tuple[Effect, ...], smoothed: bool
) -> tuple[sp.Expr, Mapping[sp.Symbol, sp.Expr]]:
    """The output, and the rates of the effects' states, on the signals that a controller has."""
    equation = compose_equation(effects)
    v, speed, moved = (MEASURED[n] for n in ("velocity", "speed", "travel_rate"))
    here = {
        SIGNALS["position"]: MEASURED["input"] - _zero(),
        SIGNALS["velocity"]: v,
        SIGNALS["acting_force"]: MEASURED["command"],
    }
    shape = next((e for e in effects if e.role == "friction_shape"), None)
    way = v / (_smoothing() + speed) if smoothed else sp.sign(v if shape is None else moved)
    here[SIGNALS["direction"]] = way
    level, even = equation.level, {SIGNALS["velocity"]: -SIGNALS["velocity"]}
    at = speed if level.xreplace(even) == level else v
    level = level.xreplace({**here, SIGNALS["velocity"]: at})
    along = {**here, SIGNALS["velocity"]: moved, SIGNALS["level"]: level}
    friction = level * way if shape is None else shape.expression().xreplace(along)
    output = equation.force.xreplace(here) + friction
    rates = {
        e.state_symbols()[n]: rate.xreplace(along if e is shape else here)
        for e in effects
        for n, rate in e.rates().items()
    }
    if (inverse := _inverse(effects)) is not None and any(e.role == "actuation" for e in effects):
        gain, offset = (x.xreplace(here) for x in inverse)
        output = (MEASURED["command"] + output - offset) / gain - MEASURED["command"]
    return output.xreplace({sp.Abs(v): speed}), rates


@dataclass(frozen=True)
class _Placed:
    """An expression as a law: law(now, p) with signals, states and parameters in their places.

    parameters: symbol -> name in `p`; all other symbols are signals and states of `now`
    """

    expression: sp.Expr
    parameters: Mapping[sp.Symbol, str]

    def __call__(self, now: Any, p: Any) -> sp.Expr:
        read = {s: getattr(p, n) for s, n in self.parameters.items()}
        rest = self.expression.free_symbols - read.keys()
        return self.expression.xreplace(read | {s: getattr(now, s.name) for s in rest})

    def __hash__(self) -> int:
        return hash(self.expression)
