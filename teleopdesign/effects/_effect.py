"""Effects, and how effects of different roles combine into the equation of one body.

A body is a chain of roles:

    command -> actuation -> acting force
    inertia * a = acting force + interaction force - force - friction
    friction    = friction_shape (sgn v by default) of the friction level
    level       = sum of the friction_level laws, each times the friction_factor laws that need
                  it (a factor that needs no effect scales all); where a friction_speed law is
                  there, at that speed instead of the body's
    tip         = of a structure: held by dry friction of the sum of the tip_level laws
    contact     = sum of the contact laws where the environment is touched, and no pull: among the
                  forces; a contact_shape law takes the place of the penetration in them

An effect file states its law once, with sympy, on the symbols of `now`; every form of it (transfer
function, python-control system, compiled kernel, residual along a measured motion, catalogue page)
is derived from that law.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from types import SimpleNamespace
from typing import Any

import sympy as sp

from ..base.arguments import check_types
from ..base.recipes import recipe
from ..base.shown import html_table
from ..base.units import unit_of
from ._derived import channels, fix_at_zero, led_momentum, linear_form, phase, strength
from ._facts import RecordFacts
from ._parameter import PERIOD, FitSearch, Parameter, positive_amplitude
from ._roles import ACTUATION_ORDER, CONTACT_ROLES, ENERGIES, ROLES, Energy, Role
from ._signals import FURTHER, INERTIA, SIGNALS, UNEXPLAINED, delayed, parameter_symbol
from ._state import State

#: names that the file of an effect may import; some are defined in separate files
__all__ = [
    "ACTUATION_ORDER",
    "CONTACT_ROLES",
    "ENERGIES",
    "FURTHER",
    "INERTIA",
    "PERIOD",
    "ROLES",
    "SIGNALS",
    "UNEXPLAINED",
    "Effect",
    "Energy",
    "FitSearch",
    "Parameter",
    "Role",
    "State",
    "are_alike",
    "delayed",
    "sort_by_action",
    "parameter_symbol",
    "positive_amplitude",
]


@check_types
@dataclass(frozen=True, repr=False)
class Effect:
    """A physical effect: one law in one role. Each file of the package's folder has an example.

    law(now, p) returns, by role:
        force: the force that the effect adds
        structure: the same, with the interaction force in it, which acts on a separate tip
        friction_level, tip_level: a share of the friction level, of the body or of the tip
        friction_factor: a factor of the levels that the effect needs
        friction_speed: the speed that the friction level follows
        friction_shape: the friction force
        actuation: the output of the stage
        contact: a share of the force that a modelled environment takes
        contact_shape: the penetration that the spring of an environment feels
    block: "" for an effect of a body; else the block it is for, such as "hand" or "environment":
        a diagnosis does not try it
    energy: effect on energy, together with the effects that it needs, for all parameters within
        their bounds. "stores": returns all of it on a closed path; "dissipates": never returns more
        than it took; "supplies": may return more, or nothing is known. Claims of passivity rest on
        it
    linear: declares that the law is linear in the motion (or in the command), so that the LTI form
    is that law at (position, velocity, acceleration) = (1, s, s^2); False: the LTI form leaves the
    effect out, and says so. It never comes from differentiating sgn.
    absent: parameter values at which the effect is absent
    canonical: of equivalent parameter values, those to report
    free: whether the law is a curve through values, which no named law describes: a diagnosis does
        not try it, for it would do better than any law
    order: order(p, body): equivalent values with interchangeable parts sorted by their numbers;
        body: the numbers of the body by their names, "coulomb.level"; None: no such parts
    after: effects that a search adds first, because without them this one may imitate them
    needs: effects that the model must have with this one; for a role that only one effect of a body
        can have, any effect of this role is enough
    counts_as: needed effects that it can replace, for effects whose laws hold no parameter of these
    always: properties for any values of its parameters, such as "even in velocity"
    commoner: name of the effect that gives nearly the same force where `undetermined` says so, and
        acts on far more machines; "" for none
    counterparts: axis where the law does not hold ("prismatic" or "revolute") -> the effect of the
        same physics there
    led: inertia(p) of a hidden body whose position is corrected; the force of this correction is
        left unexplained as well
    coupling: of a structure, coupling(now, p), from which `make_structure` makes law and states
    plausible: plausible(p, facts): None, or one sentence that says why the parameters do not
        deserve the effect's name. A diagnosis then does not name the effect
    undetermined: undetermined(p, facts): None, or one sentence on parameters that the records do
        not determine, such as a level that was never reached. The effect keeps its name
    """

    role: Role
    law: Callable[[Any, Any], sp.Expr]
    parameters: Mapping[str, Parameter]
    absent: Mapping[str, float]
    block: str = ""
    energy: Energy = "supplies"
    states: Mapping[str, State] = field(default_factory=dict)
    linear: bool = False
    needs: frozenset[str] = frozenset()
    counts_as: frozenset[str] = frozenset()
    counterparts: Mapping[str, str] = field(default_factory=dict)
    always: frozenset[str] = frozenset()
    commoner: str = ""
    free: bool = False
    canonical: Callable[[Mapping[str, float]], dict[str, float]] = dict
    order: Callable[[Mapping[str, float], Mapping[str, float]], dict[str, float]] | None = None
    after: frozenset[str] = frozenset()
    led: Callable[[Any], sp.Expr] | None = None
    coupling: Callable[[Any, Any], sp.Expr] | None = None
    plausible: Callable[[Any, RecordFacts], str | None] | None = None
    undetermined: Callable[[Any, RecordFacts], str | None] | None = None
    source: str = ""
    name: str = ""
    text: str = ""

    def __hash__(self) -> int:
        return self._hashed

    @cached_property
    def _hashed(self) -> int:
        return hash((self.name, self.role, self.law))  # what is equal has these in common

    def __copy__(self) -> Effect:
        return self  # frozen: a copy could never differ

    def __deepcopy__(self, memo: object) -> Effect:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return recipe(self)

    def __repr__(self) -> str:
        return f"Effect {self.name or '(no name)'}, {self.role}: {', '.join(self.parameters)}"

    def _repr_html_(self) -> str:
        rows = [
            (n, p.meaning, unit_of(p.quantity, "prismatic"), unit_of(p.quantity, "revolute"))
            for n, p in self.parameters.items()
        ]
        head = ("parameter", "meaning", "prismatic", "revolute")
        return html_table(f"{self.name}: {self.title}", head, rows, note=self.source)

    def named(self, name: str, text: str) -> Effect:
        """The effect with the name of its file, and the file's docstring as its text."""
        return replace(self, name=name, text=text)

    @property
    def strength(self) -> str | None:
        """The parameter in which the law is linear and that is zero where the effect is absent.

        None where there is no such parameter, or where hidden states depend on it.
        """
        return strength(self)

    @property
    def phase(self) -> str | None:
        """Name of the angle phi in a law strength * sin(... + phi); None for other laws."""
        return phase(self)

    def parameters_of_others(self) -> frozenset[str]:
        """Names of the needed effects whose parameters appear in its laws."""
        laws = (self.expression(), *self.rates().values())
        ours = set(self.symbols().values()) | set(self.state_symbols().values())
        symbols = {s.name for law in laws for s in law.free_symbols - ours}
        return frozenset(n for n in self.needs if any(s.startswith(f"{n}_") for s in symbols))

    def channels(self) -> frozenset[str]:
        """Additional channels of a record that its laws need: "temperature", "other_position"."""
        return channels(self)

    @property
    def title(self) -> str:
        """First line of the file's docstring."""
        return self.text.strip().split("\n")[0]

    def default(self, parameter: str) -> float:
        """Value of a parameter that the user leaves out: that of absence, if there is one."""
        plain = 0.0 if self.parameters[parameter].optional else 1.0
        return self.absent.get(parameter, plain)

    def without(self, parameter: str) -> Effect:
        """The effect without an optional parameter, which is zero everywhere in the law."""
        return fix_at_zero(self, parameter)

    def symbols(self) -> dict[str, sp.Symbol]:
        """Parameter name -> sympy symbol NAME_PARAMETER, one per effect."""
        return {p: parameter_symbol(self.name, p) for p in self.parameters}

    def state_symbols(self) -> dict[str, sp.Symbol]:
        """State name -> sympy symbol."""
        return {s: parameter_symbol(self.name, s) for s in self.states}

    def _now(self, signals: Mapping[str, Any] | None) -> SimpleNamespace:
        more = {"inertia": INERTIA, "unexplained": UNEXPLAINED}
        symbols = {**SIGNALS, **more, **self.state_symbols()}
        return SimpleNamespace(**{**symbols, **(signals or {})})

    def _parameters(self, values: Mapping[str, Any] | None) -> SimpleNamespace:
        return SimpleNamespace(**{**self.symbols(), **(values or {})})

    def expression(
        self, signals: Mapping[str, Any] | None = None, values: Mapping[str, Any] | None = None
    ) -> sp.Expr:
        """The law on symbols, or with these signals and values in place of symbols."""
        if signals is None and values is None:
            return _expression(self)
        return sp.sympify(self.law(self._now(signals), self._parameters(values)), strict=True)

    def rates(
        self, signals: Mapping[str, Any] | None = None, values: Mapping[str, Any] | None = None
    ) -> dict[str, sp.Expr]:
        """Hidden state -> its rate of change, on symbols or with signals in place of symbols."""
        if signals is None and values is None:
            return dict(_rates(self))
        now, p = self._now(signals), self._parameters(values)
        rates = {name: s.rate_with_stop(now, p, name) for name, s in self.states.items()}
        return {name: sp.sympify(rate, strict=True) for name, rate in rates.items()}

    def stops(self) -> dict[str, tuple[sp.Expr, sp.Expr]]:
        """Hidden state -> its rate within its stop, and the stop, on symbols; {}: none has one."""
        now, p = self._now(None), self._parameters(None)
        return {
            name: (sp.sympify(s.rate(now, p), strict=True), sp.sympify(s.stop(now, p), strict=True))
            for name, s in self.states.items()
            if s.stop is not None
        }

    def corrections(self) -> dict[str, sp.Expr]:
        """Hidden state -> rate of its correction, on symbols; {} where no state is corrected."""
        return dict(_corrections_of_states(self, "correction"))

    def dry_bounds(self) -> dict[str, sp.Expr]:
        """Hidden state -> largest rate by which dry friction slows it, on symbols; {}: none."""
        return dict(_corrections_of_states(self, "dry"))

    def led_momentum(self) -> sp.Expr:
        """Momentum of the body that corrections move, on symbols; 0 without corrections."""
        return led_momentum(self)

    def is_absent(self, values: Mapping[sp.Symbol, float]) -> bool:
        """Whether the effect is absent with these parameter values (by symbol)."""
        symbols = self.symbols()
        return all(values[symbols[name]] == value for name, value in self.absent.items())

    def linear_form(self, s: sp.Symbol, values: Mapping[str, Any] | None = None) -> sp.Expr | None:
        """Declared linear part at the Laplace variable s; None where the effect declares none.

        roles force and structure: complex stiffness (force per position, added to the impedance
        relative to position); role actuation: transfer function from command to its output.
        """
        return linear_form(self, s, values) if self.linear else None


# laws on symbols are asked for at every evaluation of a residual: they are built once


@lru_cache(maxsize=256)
def _expression(effect: Effect) -> sp.Expr:
    return effect.expression({}, {})


@lru_cache(maxsize=256)
def _rates(effect: Effect) -> dict[str, sp.Expr]:
    return effect.rates({}, {})


@lru_cache(maxsize=256)
def _corrections_of_states(effect: Effect, what: str) -> dict[str, sp.Expr]:
    """Hidden state -> its "correction" or "dry" law, for the states that have one."""
    now, p = effect._now(None), effect._parameters(None)
    laws = {name: getattr(state, what) for name, state in effect.states.items()}
    return {n: sp.sympify(law(now, p), strict=True) for n, law in laws.items() if law is not None}


def are_alike(one: Effect, other: Effect) -> bool:
    """Whether one of two effects is the commoner one, by the file of the other."""
    return one.name == other.commoner or other.name == one.commoner


def sort_by_action(effects: tuple[Effect, ...], role: Role) -> list[Effect]:
    """Effects of one role, in the order in which they act on the signal."""
    chosen = [e for e in effects if e.role == role]
    rank = {name: i for i, name in enumerate(ACTUATION_ORDER)}
    if role != "actuation":
        return chosen
    return sorted(chosen, key=lambda e: rank.get(e.name, len(rank)))
