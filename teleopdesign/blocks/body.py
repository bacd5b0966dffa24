"""One moving body with its effects: device, master or slave.

    inertia * a = acting force + interaction force - force - friction

`Body.equation` composes the laws of its effects by role into this equation. All other forms
(transfer function, python-control system, kernel, residual along a motion) use it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

import sympy as sp

from ..base.arguments import check_types, instance, number
from ..base.errors import ModelError, did_you_mean, quote
from ..base.frozen import Frozen
from ..base.shown import html_table
from ..base.units import AXES, unit_after_number, unit_of
from ..effects import EFFECTS, Effect, Parameter, sort_by_action
from .body_equation import (
    BodyEquation,
    actuation_of,
    body_symbols,
    carried_force,
    compose_equation,
    contact_force,
    friction_level,
    impedance_of,
)
from .value import Value, with_held

#: roles that one effect of a body can have, in the words of messages
ONE_ONLY = {
    "friction_shape": "friction shapes",
    "friction_speed": "speeds of the friction level",
    "structure": "structures",
    "contact_shape": "shapes of the contact force",
}
INERTIA = Parameter("inertia", "inertia of the body", lower=0.0)
_FREE = Value(0.0)


@dataclass(frozen=True, repr=False)
class Body:
    """A body on one axis: its inertia, its effects, and a value for every parameter.

    axis: "prismatic" or "revolute";  parameters: "inertia", "coulomb.level", ... -> Value, or a
        plain number (SI)
    raises ModelError: a parameter is unknown, missing or out of bounds, or effects do not combine
    """

    axis: str
    parameters: Mapping[str, Value]
    effects: tuple[Effect, ...] = field(default=())

    def __post_init__(self) -> None:
        if not (isinstance(self.axis, str) and self.axis in AXES):
            _refuse_axis(self.axis)
        instance(self.parameters, Mapping, "Body: parameters", expected='such as {"inertia": 0.15}')
        object.__setattr__(self, "effects", _effects(self.effects))
        _check_effects(self.effects, self.axis)
        declared = _list_declared(self.effects)
        for name in self.parameters:
            if name not in declared:
                raise _missing_parameter_error(name, declared)
        parameters = {name: _FREE for name, p in declared.items() if p.optional}
        parameters |= {n: _value(v, n) for n, v in self.parameters.items()}
        for name, parameter in declared.items():
            if name not in parameters:
                raise ModelError(f'body: parameter "{name}" has no value')
            value = parameters[name].value
            if value != value:
                raise ModelError(f"body: {name} is NaN, expected a number ({self.unit(name)})")
            if not parameter.lower <= value <= parameter.upper:
                raise ModelError(
                    f"body: {name} = {value:g}{unit_after_number(self.unit(name))} is outside "
                    f"{parameter.lower:g} .. {parameter.upper:g}"
                )
        object.__setattr__(self, "parameters", Frozen(with_held(parameters, declared)))

    def declared(self) -> list[tuple[str, Parameter]]:
        """Every parameter of the body: its name in answers, and its declaration."""
        return list(_list_declared(self.effects).items())

    def parameter(self, name: str) -> Parameter:
        """Declaration of a parameter; raises ModelError: there is none of this name."""
        declared = _list_declared(self.effects)
        if name not in declared:
            raise _missing_parameter_error(name, declared)
        return declared[name]

    @check_types
    def unit(self, name: str) -> str:
        """Unit of a parameter on the axis of this body."""
        return unit_of(self.parameter(name).quantity, self.axis)

    def has(self, effect: str) -> bool:
        """Whether the body has an effect of this name."""
        return any(e.name == effect for e in self.effects)

    def lacks(self, effect: Effect) -> tuple[str, ...]:
        """Names of effects that an effect needs and the body lacks, sorted.

        For a role that only one effect can have, any effect of this role is enough. So is an effect
        that counts as the needed one, unless the law holds a parameter of the needed one.
        """
        return _list_missing_parts(self.effects, effect)

    @check_types
    def effect(self, name: str) -> Effect:
        """The effect of this name; raises ModelError: the body has none."""
        for effect in self.effects:
            if effect.name == name:
                return effect
        near = did_you_mean(name, [e.name for e in self.effects])
        raise ModelError(f'body: has no effect "{name}"{near}')

    @check_types
    def with_effect(self, effect: Effect, values: Mapping[str, float] | None = None) -> Body:
        """The body with one more effect, at these values (None: those at which it is absent).

        A shape of friction, or a structure, replaces the present one of the same role.
        raises ModelError: the body has the effect already, or the effect has no such parameter
        """
        if self.has(effect.name):
            raise ModelError(
                f'body: effect "{effect.name}" is there already: with_values changes its values'
            )
        stated = dict(values or {})
        unknown = set(stated) - set(effect.parameters)
        if unknown:
            raise ModelError(
                f'{effect.name}: no parameter "{min(unknown)}"'
                f"{did_you_mean(min(unknown), effect.parameters)}"
            )
        start = {n: effect.default(n) for n in effect.parameters} | stated
        gone = tuple(e.name for e in self.effects if e.role in ONE_ONLY and e.role == effect.role)
        added = {
            f"{effect.name}.{n}": Value(v, fixed=effect.parameters[n].search.chosen)
            for n, v in start.items()
        }
        return replace(
            self,
            effects=(*(e for e in self.effects if e.name not in gone), effect),
            parameters={
                **{n: v for n, v in self.parameters.items() if n.partition(".")[0] not in gone},
                **added,
            },
        )

    @check_types
    def without_effect(self, name: str) -> Body:
        """The body without an effect; raises ModelError: it lacks it, or another one needs it."""
        self.effect(name)
        return replace(
            self,
            effects=tuple(e for e in self.effects if e.name != name),
            parameters={k: v for k, v in self.parameters.items() if not k.startswith(f"{name}.")},
        )

    def without_parameter(self, effect: str, parameter: str) -> Body:
        """The body with an optional parameter of an effect left out."""
        effects = [e.without(parameter) if e.name == effect else e for e in self.effects]
        kept = {k: v for k, v in self.parameters.items() if k != f"{effect}.{parameter}"}
        return replace(self, effects=tuple(effects), parameters=kept)

    def with_values(self, values: Mapping[str, float | Value]) -> Body:
        """The body with other parameter values (SI), by names such as "coulomb.level".

        A plain number keeps whether the parameter is fixed.
        raises ModelError: no parameter of that name, or a value outside the parameter's bounds
        """
        instance(values, Mapping, "with_values", expected='such as {"inertia": 0.15}')
        new = {}
        for name, number_or_value in values.items():
            if name not in self.parameters:
                raise _missing_parameter_error(name, self.parameters)
            new[name] = _value(number_or_value, name, self.parameters[name])
        return Body(self.axis, {**self.parameters, **new}, self.effects)

    def symbols(self) -> dict[str, sp.Symbol]:
        """Parameter name -> sympy symbol of the equation: "coulomb.level" -> coulomb_level."""
        return dict(body_symbols(self.effects))

    def numbers(self) -> dict[sp.Symbol, float]:
        """Parameter symbol -> value, to substitute in the equation."""
        return {s: self.parameters[n].value for n, s in self.symbols().items()}

    def level(self) -> sp.Expr:
        """Friction level: sum of the laws times their factors, at the speed that it depends on.

        A factor scales the levels that it needs ("coulomb"), or all of them where it needs none.
        """
        return friction_level(self.effects)

    def tip_level(self) -> sp.Expr:
        """Level of the dry friction on the tip of a structure."""
        return sp.Add(*(e.expression() for e in sort_by_action(self.effects, "tip_level")))

    def carried_force(self) -> sp.Expr:
        """Force of the transmission along a measured motion, positive as the acting force."""
        return carried_force(self.effects)

    def contact(self) -> sp.Expr:
        """Force of a modelled environment that resists the body; 0 where there is none."""
        return contact_force(self.effects)

    def equation(self) -> BodyEquation:
        """The body's equation, composed from its effects by role."""
        return compose_equation(self.effects)

    def impedance(self, s: sp.Symbol) -> tuple[sp.Expr, tuple[str, ...]]:
        """Impedance relative to position, Z(s) (force per position), and names of effects left out.

        The sum of inertia s^2 and the linear forms that effects declare.
        """
        return impedance_of(self.effects, s)

    def actuation(self, s: sp.Symbol) -> tuple[sp.Expr, tuple[str, ...]]:
        """Transfer function from command to acting force, and names of effects left out."""
        return actuation_of(self.effects, s)

    def __repr__(self) -> str:
        rows = [
            f"  {n} = {v:.5g}{unit_after_number(self.unit(n))}" for n, v in self._plain().items()
        ]
        return "\n".join([f"Body, {self.axis}", *rows])

    def _repr_html_(self) -> str:
        rows = [(n, f"{v:.5g}", self.unit(n)) for n, v in self._plain().items()]
        return html_table(f"Body, {self.axis}", ("parameter", "value", "unit"), rows)

    def _plain(self) -> dict[str, float]:
        return {name: self.parameters[name].value for name, _ in self.declared()}


def _value(number_or_value: object, name: object, known: Value = _FREE) -> Value:
    if isinstance(number_or_value, Value):
        return number_or_value
    return Value(number(number_or_value, f"body: {name}"), known.fixed, known.stderr)


def _missing_parameter_error(name: object, known: Iterable[str]) -> ModelError:
    near = did_you_mean(name, known) if isinstance(name, str) else ""
    shown = quote(name) if isinstance(name, str) else repr(name)
    return ModelError(f"body: no parameter {shown}, has {', '.join(known)}{near}")


@lru_cache(maxsize=4096)
def _list_declared(effects: tuple[Effect, ...]) -> Mapping[str, Parameter]:
    """Parameters of a body with these effects, by their names in answers."""
    named = {f"{e.name}.{n}": p for e in effects for n, p in e.parameters.items()}
    return {"inertia": INERTIA, **named}


@lru_cache(maxsize=4096)
def _list_missing_parts(effects: tuple[Effect, ...], effect: Effect) -> tuple[str, ...]:
    """Result of `Body.lacks` for a body with these effects."""
    roles = {e.role for e in effects} & set(ONE_ONLY)
    known = {n: EFFECTS[n].role for n in effect.needs if n in EFFECTS}
    counted = {n for e in effects for n in e.counts_as} - effect.parameters_of_others()
    names = {e.name for e in effects}
    return tuple(
        n for n in sorted(effect.needs) if not (n in names or n in counted or known.get(n) in roles)
    )


@lru_cache(maxsize=256)
def _check_effects(effects: tuple[Effect, ...], axis: str) -> None:
    """Refuse effects that no body can have together; cached, for a fit makes thousands.

    raises ModelError: with the effects
    """
    names = [e.name for e in effects]
    if doubled := {n for n in names if names.count(n) > 1}:
        raise ModelError(f'body: effect "{min(doubled)}" is there twice')
    for role, words in ONE_ONLY.items():
        same = [e.name for e in effects if e.role == role]
        if len(same) > 1:
            raise ModelError(f"body: two {words}, {' and '.join(same)}: one is possible")
    for effect in effects:
        if missing := _list_missing_parts(effects, effect):
            raise ModelError(f'body: "{effect.name}" needs "{missing[0]}" beside it')
        if axis in effect.counterparts:
            raise ModelError(
                f'body: "{effect.name}" holds on no {axis} axis: there it is '
                f'"{effect.counterparts[axis]}"'
            )


def _refuse_axis(axis: object) -> None:
    instance(axis, str, "Body: axis", expected=" or ".join(map(quote, AXES)))
    raise ModelError(
        f"Body: axis: found {quote(str(axis))}, expected {' or '.join(map(quote, AXES))}"
        f"{did_you_mean(str(axis), AXES)}"
    )


def _effects(effects: object) -> tuple[Effect, ...]:
    """A tuple of effects; a list is converted, a name is refused."""
    expected = 'a tuple of effects, such as (EFFECTS["coulomb"],)'
    if not isinstance(effects, tuple):
        instance(effects, list, "Body: effects", expected=expected)
    assert isinstance(effects, tuple | list)
    for i, effect in enumerate(effects):
        instance(effect, Effect, f"Body: effects[{i}]", expected="an Effect, of EFFECTS or a file")
    return tuple(effects)
