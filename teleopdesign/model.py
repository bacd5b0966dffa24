"""The model that a user compares with a recording: bodies with their effects at places.

A model is frozen; `model.with_effect("stribeck", at="device")` returns a new model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from .base.arguments import check_types, describe_value, instance
from .base.errors import ExperimentError, ModelError, did_you_mean, unknown
from .base.frozen import Frozen
from .base.sentences import with_standard_error
from .base.shown import html_table
from .base.units import unit_after_number
from .blocks import CONTACT, Body, Value
from .blocks.described import free_body_of, joint_with_links, with_environment
from .effects import CONTACT_ROLES, EFFECTS, Effect, Parameter, find_effect
from .measurement.experiment import Experiment


@dataclass(frozen=True)
class Model:
    """Bodies by their place ("device", or "master" and "slave"), each with its effects (SI).

    known: effects by name that may be added
    record_shift: body -> s by which the log of its command is late; "BODY.interaction_force" -> s,
        time constant of the hand's sensor: errors of the records that the model was estimated on,
        no physics; empty where unknown
    links: base parameters (SI) of the arm whose joints are the bodies; (): none is estimated

        >>> td.Model.from_experiment(td.load_experiment(td.example("rod"))).body("device").axis
        'prismatic'
    """

    bodies: Mapping[str, Body]
    known: Mapping[str, Effect] = field(default_factory=lambda: EFFECTS, repr=False)
    record_shift: Mapping[str, Value] = field(default_factory=dict, repr=False)
    links: tuple[float, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        expected = 'bodies by their place, such as {"device": Body(...)}'
        instance(self.bodies, Mapping, "Model: bodies", expected=expected)
        if not self.bodies:
            raise ModelError(f"Model: bodies: found none, expected {expected}")
        for place, body in self.bodies.items():
            instance(place, str, "Model: bodies", expected=expected)
            instance(body, Body, f"Model: bodies[{place!r}]")
        instance(self.known, Mapping, "Model: known", expected="effects by name, such as EFFECTS")
        if not isinstance(self.bodies, Frozen):
            object.__setattr__(self, "bodies", Frozen(self.bodies))
        if not isinstance(self.record_shift, Frozen):
            object.__setattr__(self, "record_shift", Frozen(self.record_shift))

    @classmethod
    @check_types
    def from_experiment(
        cls, experiment: Experiment, known: Mapping[str, Effect] = EFFECTS
    ) -> Model:
        """The model that an experiment.toml describes, its values converted to SI.

        known: effects by name, with those of the user
        raises ExperimentError: unknown effect or parameter, wrong unit, value out of bounds, no
            channel
        """
        described = experiment.bodies
        if experiment.arm is not None:
            described = {n: joint_with_links(b) for n, b in described.items()}
        bodies = {n: free_body_of(b, known) for n, b in described.items()}
        for place, body in bodies.items():
            for effect in body.effects:
                wanted = sorted(effect.channels())
                if missing := [c for c in wanted if f"{place}.{c}" not in experiment.channels]:
                    raise ExperimentError(
                        f"{experiment.bodies[place].where}.effects.{effect.name}: needs the "
                        f'channel "{missing[0]}", which [channels] has not'
                    )
        touching = list(bodies)[-1]
        measured = f"{touching}.interaction_force" in experiment.channels
        if experiment.environment is not None and not measured:
            bodies[touching] = with_environment(bodies[touching], experiment.environment, known)
        return cls(Frozen(bodies), known)

    @check_types
    def body(self, at: str) -> Body:
        """The body at a place; for the environment, the body that touches it.

        raises ModelError: there is no such place
        """
        return self.bodies[self.holder(at)]

    @check_types
    def with_effect(
        self,
        effect: str | Effect,
        *,
        at: str | None = None,
        values: Mapping[str, float] | None = None,
    ) -> Model:
        """The model with one effect more.

        at: place; None: the only body, or the environment for its effects
        values: parameter -> value (SI); None: the effect is absent, and a fit searches its start
            values
        raises ModelError: no such effect, place or parameter, or the model has the effect already
        """
        added = (
            find_effect(effect, self.known, "with_effect") if isinstance(effect, str) else effect
        )
        place = self._place(at, added.role)
        if (place == CONTACT.name) != (added.role in CONTACT_ROLES):
            words = "the environment" if added.role in CONTACT_ROLES else "a body"
            raise ModelError(f'with_effect: "{added.name}" acts at {words}, found at = "{place}"')
        if self.body(place).has(added.name):
            raise ModelError(
                f'with_effect: effect "{added.name}" is there already at {place}: with_values '
                "changes its values"
            )
        return self._with_body(place, self.body(place).with_effect(added, values))

    @check_types
    def without_effect(self, effect: str, *, at: str | None = None) -> Model:
        """The model without an effect; raises ModelError: it lacks it, or another one needs it."""
        removed = self.known.get(effect)
        place = self._place(at, removed.role if removed else "")
        return self._with_body(place, self.body(place).without_effect(effect))

    def with_values(self, values: Mapping[str, float | Value]) -> Model:
        """The model with other parameter values (SI), by full names such as "device.coulomb.level".

        raises ModelError: no parameter of that name, or a value outside the parameter's bounds
        """
        instance(values, Mapping, "with_values", expected='such as {"device.inertia": 0.15}')
        of_body: dict[str, dict[str, float | Value]] = {}
        for name, value in values.items():
            if name not in self._named:
                self._refuse_parameter(name)
            place, local_name = self.locate(name)
            of_body.setdefault(place, {})[local_name] = value
        changed = {at: self.bodies[at].with_values(mine) for at, mine in of_body.items()}
        return Model({**self.bodies, **changed}, self.known, self.record_shift, self.links)

    def log_late(self, log: str) -> float:
        """Seconds by which a log is late: of a command "device", or "device.interaction_force"."""
        shift = self.record_shift.get(log)
        return 0.0 if shift is None else shift.value

    def with_record_shift(self, shifts: Mapping[str, Value]) -> Model:
        """The model with other shifts of the records; shifts: log -> Value in s, {}: none."""
        instance(shifts, Mapping, "with_record_shift", expected='such as {"device": Value(0.001)}')
        return replace(self, record_shift=Frozen(shifts))

    def with_links(self, values: tuple[float, ...]) -> Model:
        """The model with other base parameters of its arm."""
        return replace(self, links=values)

    @property
    def parameters(self) -> dict[str, Value]:
        """Every parameter by its full name, "device.coulomb.level" -> Value (SI)."""
        return dict(self._named)

    @cached_property
    def _named(self) -> Mapping[str, Value]:
        """The parameters, put together once: a fit asks thousands of times."""
        named = {}
        for place, body in self.bodies.items():
            places = {e.name: self._place_of(place, f"{e.name}.any") for e in body.effects}
            for name, _ in body.declared():
                at = places.get(name.partition(".")[0], f"{place}.")
                named[f"{at}{name}"] = body.parameters[name]
        return named

    def locate(self, name: str) -> tuple[str, str]:
        """Body, and name within it, of the parameter with this full name.

        Parameters of the environment belong to the body that touches it.
        """
        place, _, local_name = name.partition(".")
        if place == CONTACT.name:
            return self.holder(place), local_name if "." in local_name else name
        return place, local_name

    def _refuse_parameter(self, name: object) -> None:
        shown = f'"{name}"' if isinstance(name, str) else describe_value(name)
        near = did_you_mean(name, self.parameters) if isinstance(name, str) else ""
        raise ModelError(f"model: no parameter {shown}{near}")

    @check_types
    def declared(self, name: str) -> Parameter:
        """Declaration of the parameter with this full name."""
        place, local_name = self.locate(name)
        return self.body(place).parameter(local_name)

    @check_types
    def unit(self, name: str) -> str:
        """Unit of the parameter with this full name."""
        place, local_name = self.locate(name)
        return self.body(place).unit(local_name)

    def from_absence(self, name: str) -> float:
        """Distance of a parameter from the value at which its effect is absent, or from 0."""
        place, local_name = self.locate(name)
        effect, _, parameter = local_name.partition(".")
        value = abs(self._named[name].value)
        if not parameter:
            return value
        absent = self.body(place).effect(effect).absent.get(parameter, 0.0)
        return abs(self._named[name].value - absent) if abs(absent) < float("inf") else value

    def canonical(self) -> Model:
        """The same model with the parameter values to report (see `Effect.canonical`)."""
        values: dict[str, float] = {}
        for place, body in self.bodies.items():
            for effect in body.effects:
                full = {p: f"{effect.name}.{p}" for p in effect.parameters}
                numbers = {p: body.parameters[name].value for p, name in full.items()}
                values |= {
                    f"{self._place_of(place, full[p])}{full[p]}": v
                    for p, v in effect.canonical(numbers).items()
                }
        return self.with_values(values)

    def in_order(self) -> Model:
        """The same model with interchangeable parts of effects sorted (`Effect.order`)."""
        values: dict[str, float] = {}
        for place, body in self.bodies.items():
            numbers = {n: v.value for n, v in body.parameters.items()}
            for effect in body.effects:
                ours = {p: numbers[f"{effect.name}.{p}"] for p in effect.parameters}
                fixed = any(body.parameters[f"{effect.name}.{p}"].fixed for p in ours)
                if effect.order is None or fixed or effect.is_absent(body.numbers()):
                    continue
                values |= {
                    f"{place}.{effect.name}.{p}": v
                    for p, v in effect.order(ours, numbers).items()
                    if v != ours[p]
                }
        return self.with_values(values) if values else self

    @property
    def absent(self) -> tuple[tuple[str, str], ...]:
        """(effect, place) of the effects that are absent by their values."""
        return tuple(
            (effect.name, CONTACT.name if effect.role in CONTACT_ROLES else place)
            for place, body in self.bodies.items()
            for effect in body.effects
            if effect is not CONTACT and effect.is_absent(body.numbers())
        )

    @property
    def effects(self) -> tuple[tuple[str, str], ...]:
        """(effect, place) of every effect in the model."""
        return tuple(
            (e.name, CONTACT.name if e.role in CONTACT_ROLES else place)
            for place, b in self.bodies.items()
            for e in b.effects
        )

    @cached_property
    def places(self) -> tuple[str, ...]:
        """Places of effects: the bodies, and "environment" where one is modelled."""
        touched = any(b.has(CONTACT.name) for b in self.bodies.values())
        return (*self.bodies, CONTACT.name) if touched else tuple(self.bodies)

    def holder(self, at: str) -> str:
        """Name of the body at a place or touching it; raises ModelError: there is no such place."""
        if at not in self.places:
            raise ModelError(f"model: {unknown('body', at, self.places)}")
        if at in self.bodies:
            return at
        return next(p for p, b in self.bodies.items() if b.has(CONTACT.name))

    def _place_of(self, holder: str, local_name: str) -> str:
        """Prefix, with its dot, of a body's parameter in the parameter's full name."""
        effect, _, parameter = local_name.partition(".")
        if effect == CONTACT.name:
            return ""
        if parameter and self.bodies[holder].effect(effect).role in CONTACT_ROLES:
            return f"{CONTACT.name}."
        return f"{holder}."

    def _place(self, at: str | None, role: str) -> str:
        if at is not None:
            return at
        if role in CONTACT_ROLES:
            return CONTACT.name
        if len(self.bodies) > 1:
            raise ModelError(f"model: at = one of {', '.join(self.bodies)} must be given")
        return next(iter(self.bodies))

    def _with_body(self, place: str, body: Body) -> Model:
        return replace(self, bodies=Frozen({**self.bodies, self.holder(place): body}))

    def __repr__(self) -> str:
        lines = []
        for name, value in self.parameters.items():
            mark = "  (fixed)" if value.fixed else ""
            best = with_standard_error(value.value, value.stderr)
            lines.append(f"  {name} = {best}{unit_after_number(self.unit(name))}{mark}")
        return "Model\n" + "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = []
        for name, v in self.parameters.items():
            error = f"{v.stderr:.2g}" if v.stderr == v.stderr else ""
            rows.append((name, f"{v.value:.5g}", error, self.unit(name), "yes" if v.fixed else ""))
        head = ("parameter", "value", "standard error", "unit", "fixed")
        return html_table("Model", head, rows)
