"""What an effect is, and how effects of different roles combine into the equation of one body.

A body is a chain of roles:

    command -> actuation -> acting force
    inertia * a = acting force + interaction force - force - friction
    friction    = friction_shape (sgn v unless one is given) of the friction level
    level       = sum of the friction_level laws, each times the friction_factor laws that need
                  it (a factor that needs no effect scales all); where a friction_speed law is
                  there, at that speed instead of the body's own
    tip         = of a structure: held by dry friction of the sum of the tip_level laws
    contact     = sum of the contact laws where the environment is touched, and no pull: among the
                  forces; a contact_shape law takes the place of the penetration in them

An effect file states its law once, with sympy, on the symbols of `now`; every form of it (transfer
function, python-control system, compiled kernel, residual along a measured motion, catalogue page)
is derived from that law.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, Literal, get_args

import sympy as sp

from ..arguments import checked
from ..errors import ModelError, did_you_mean
from ..notebook import html_table
from ..quantity import QUANTITIES, unit_of
from ..recipes import recipe, remember
from ._facts import RecordFacts

Role = Literal[
    "actuation",
    "structure",
    "force",
    "friction_level",
    "friction_factor",
    "friction_speed",
    "friction_shape",
    "tip_level",
    "contact",
    "contact_shape",
]
ROLES: tuple[Role, ...] = get_args(Role)
Energy = Literal["stores", "dissipates", "supplies"]
ENERGIES: tuple[Energy, ...] = get_args(Energy)
#: the order in which actuation stages act, where an effect of that name is there; others come last
ACTUATION_ORDER = (
    "actuator_gain",
    "torque_ripple",
    "actuator_lag",
    "actuation_delay",
    "actuator_saturation",
)

#: roles of what belongs to a modelled environment, not to the body that touches it
CONTACT_ROLES = frozenset({"contact", "contact_shape"})


def parameter_symbol(effect: str, parameter: str) -> sp.Symbol:
    """Symbol of a parameter of an effect, by the names of both: for laws that need another one."""
    return sp.Symbol(f"{effect}_{parameter}", real=True)


def positive_amplitude(values: Mapping[str, float]) -> dict[str, float]:
    """The same sinusoid with an amplitude >= 0 and a phase in [0, 2 pi)."""
    turned = values["phase"] + (math.pi if values["amplitude"] < 0 else 0.0)
    return {
        **values,
        "amplitude": abs(values["amplitude"]),
        "phase": turned % (2 * math.pi),
    }


#: symbols that a law may use; `direction` is sgn(velocity), `command` the input of an actuation
#: stage, `acting_force` the output of the last, `level` the friction level, `interaction_force`
#: the force of hand or environment on the body, `penetration` the depth in a modelled environment
SIGNALS = {
    name: sp.Symbol(name, real=True)
    for name in (
        "time position velocity acceleration direction command acting_force interaction_force "
        "level penetration temperature other_position other_velocity other_acceleration".split()
    )
}
#: signal -> the further channel of a record that it is made from; without the channel it is unknown
FURTHER = {
    "temperature": "temperature",
    "other_position": "other_position",
    "other_velocity": "other_position",
    "other_acceleration": "other_position",
}
#: what corrections may use besides: the inertia of the effect's body, and the force that is left
#: unexplained along a measured motion
INERTIA, UNEXPLAINED = sp.symbols("inertia unexplained", real=True)
#: delayed(signal, delay): the signal a fixed time earlier
delayed = sp.Function("delayed", real=True)


@checked
@dataclass(frozen=True)
class FitSearch:
    """How a fit searches a parameter whose value nobody gives.

    starts: where the search begins, as multiples of the record's own scale
    scale: "": the scale of the parameter's quantity; "duration": of the record; "travel": the whole
        travel; "resonance_stiffness" and the like: of a resonance within the bandwidth
    within: upper bound in that scale, where a larger value would mean something else
    chosen: set at the first start and not estimated: other parameters are relative to this one
    essential: must be surely more than zero, for at zero the effect would be another one
    """

    starts: tuple[float, ...] = (0.01, 0.1)
    scale: str = ""
    within: float = float("inf")
    chosen: bool = False
    essential: bool = False


@checked
@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect: its quantity (a key of `quantity`), meaning and bounds (SI).

    optional: may be zero, and is by default
    search: how a fit searches it
    """

    quantity: str
    meaning: str
    lower: float = 0.0
    upper: float = float("inf")
    optional: bool = False
    search: FitSearch = FitSearch()

    def __post_init__(self) -> None:
        if self.quantity not in QUANTITIES:
            raise ModelError(
                f'Parameter: no quantity "{self.quantity}", has {", ".join(QUANTITIES)}'
                f"{did_you_mean(self.quantity, QUANTITIES)}"
            )

    @property
    def scale(self) -> str:
        """Unit of the search: a scale of the record, by default the scale of the quantity."""
        return self.search.scale or self.quantity


#: period of something that repeats along the travel. Searches start evenly in 1/period, three
#: quarters of a cycle over the whole travel from one to the next: where two are a cycle apart, what
#: lies between them is orthogonal to both for a motion that stays at its ends. From two travels on
#: it is no longer seen to repeat: a bias, or a spring
PERIOD = Parameter(
    "position",
    "p: travel of one period",
    search=FitSearch(
        starts=tuple(4.0 / 3.0 / k for k in range(1, 151)), scale="travel", within=2.0
    ),
)


#: of a stop: a state that it holds rests up to here, or it would chatter between two rates
HELD = 1.001


@checked
@dataclass(frozen=True)
class State:
    """A hidden state: its quantity and rate law(now, p), where `now` also carries the states.

    start: the signal that it equals when a record starts; "": it starts settled, or at rest
    correction: correction(now, p), the rate by which the force that is left unexplained, also in
        `now`, leads the state back along a measured motion; None: it runs free
    dry: dry(now, p), the largest rate by which dry friction slows the state down; at zero it holds
        it where no more is needed. None: no such friction
    stop: stop(now, p), the size that the state is held at, as by a spring that slips
    """

    quantity: str
    rate: Callable[[Any, Any], sp.Expr]
    start: str = ""
    correction: Callable[[Any, Any], sp.Expr] | None = None
    dry: Callable[[Any, Any], sp.Expr] | None = None
    stop: Callable[[Any, Any], sp.Expr] | None = None

    def rate_with_stop(self, now: Any, p: Any, name: str) -> sp.Expr:
        """The rate, none at the stop; where the stop itself has moved in, back to it."""
        rate = sp.sympify(self.rate(now, p), strict=True)
        if self.stop is None or rate == 0:
            return rate
        z, stop = sp.Abs(getattr(now, name)), self.stop(now, p)
        at_stop = sp.And(z >= stop, getattr(now, name) * rate > 0)
        return sp.Piecewise(
            (rate * sp.Min((HELD * stop - z) / (stop + z), 0), at_stop), (rate, True)
        )


@checked
@dataclass(frozen=True, repr=False)
class Effect:
    """A physical effect: one law in one role; see the package's folder for examples.

    law(now, p) returns the force it adds (role force; role structure: the same, the interaction
    force with it, for that acts on a tip of its own), its share of the friction level
    (friction_level; tip_level: of the tip of a structure), a factor of the levels it needs
    (friction_factor), the speed that the level
    follows (friction_speed), the friction force (friction_shape), the stage's output (actuation), a
    share of the force that a modelled environment takes (contact), or the penetration that its
    spring feels (contact_shape).
    block: what it belongs to, such as "hand" or "environment"; then it is wanted there and is no
        candidate of a diagnosis;  "": a body
    energy: what it does with energy, beside no more than the effects that it needs, for parameters
        within their bounds: "stores": gives all of it back on a closed path; "dissipates": never
        gives back more than it took; "supplies": may, or nothing is known. It is what claims of
        passivity ask for, and "supplies" where an effect does not say
    linear: declares that the law is linear in the motion (or in the command), so that the LTI form
    is that law at (position, velocity, acceleration) = (1, s, s^2); False: the LTI form leaves the
    effect out, and says so. It is never found by differentiating sgn.
    absent: parameter values at which the effect is not there at all.
    canonical: of parameter values that mean the same, those to report.
    order: order(p, body), of parts that may change places, the same law with its parts in the order
        that their numbers say; body: the numbers of the body by their names, "coulomb.level". None:
        no parts do
    after: effects that a search tries first: without them this one stands for them
    needs: effects that the model must have for this one to mean anything; where a body has one of a
        role at most, another of that role will do.
    counts_as: effects that it takes the place of for those that need them, where their laws hold
        none of these effects' own parameters
    elsewhere: an axis that the law does not hold on ("prismatic" or "revolute") -> the effect that
        says the same there
    coupling: of a structure, coupling(now, p), which its law and states are made from
        (`make_structure`)
    plausible: plausible(p, facts), what its parameters must obey to deserve the effect's name: None
        where they do, else one sentence that says what they stand for instead. A diagnosis names no
        effect that its own file does not believe
    untold: untold(p, facts), what records cannot tell of the parameters though the name stands,
        such as a level that they never carried; one sentence, or None
    led: inertia(p) of a body among the hidden states whose position is corrected: the force that it
        would take to lead it so is left unexplained as well
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
    elsewhere: Mapping[str, str] = field(default_factory=dict)
    always: frozenset[str] = frozenset()
    canonical: Callable[[Mapping[str, float]], dict[str, float]] = dict
    order: Callable[[Mapping[str, float], Mapping[str, float]], dict[str, float]] | None = None
    after: frozenset[str] = frozenset()
    led: Callable[[Any], sp.Expr] | None = None
    coupling: Callable[[Any, Any], sp.Expr] | None = None
    plausible: Callable[[Any, RecordFacts], str | None] | None = None
    untold: Callable[[Any, RecordFacts], str | None] | None = None
    source: str = ""
    name: str = ""
    text: str = ""

    def __hash__(self) -> int:
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
        """The effect under the name of its file, with the file's docstring as its text."""
        return replace(self, name=name, text=text)

    @property
    def strength(self) -> str | None:
        """The parameter in which the law is linear and that is zero where the effect is absent.

        None where there is no such parameter, or where hidden states depend on it.
        """
        return _strength(self)

    @property
    def phase(self) -> str | None:
        """Name of the angle phi in a law strength * sin(... + phi); None for other laws."""
        return _phase(self)

    def parameters_of_others(self) -> frozenset[str]:
        """Names of the needed effects whose own parameters its laws hold."""
        laws = (self.expression(), *self.rates().values())
        ours = set(self.symbols().values()) | set(self.state_symbols().values())
        symbols = {s.name for law in laws for s in law.free_symbols - ours}
        return frozenset(n for n in self.needs if any(s.startswith(f"{n}_") for s in symbols))

    def channels(self) -> frozenset[str]:
        """Further channels of a record that its laws need: "temperature", "other_position"."""
        return _channels(self)

    @property
    def title(self) -> str:
        """First line of the file's docstring."""
        return self.text.strip().split("\n")[0]

    def default(self, parameter: str) -> float:
        """Value of a parameter that the user leaves out: where the effect is absent, if known."""
        plain = 0.0 if self.parameters[parameter].optional else 1.0
        return self.absent.get(parameter, plain)

    def without(self, parameter: str) -> Effect:
        """The effect without an optional parameter, which is zero everywhere in the law."""
        return _without(self, parameter)

    def symbols(self) -> dict[str, sp.Symbol]:
        """Parameter name -> sympy symbol NAME_PARAMETER, one per effect."""
        return {p: parameter_symbol(self.name, p) for p in self.parameters}

    def state_symbols(self) -> dict[str, sp.Symbol]:
        """State name -> sympy symbol."""
        return {s: sp.Symbol(f"{self.name}_{s}", real=True) for s in self.states}

    def _now(self, signals: Mapping[str, Any] | None) -> SimpleNamespace:
        more = {"inertia": INERTIA, "unexplained": UNEXPLAINED}
        symbols = {**SIGNALS, **more, **self.state_symbols()}
        return SimpleNamespace(**{**symbols, **(signals or {})})

    def _parameters(self, values: Mapping[str, Any] | None) -> SimpleNamespace:
        return SimpleNamespace(**{**self.symbols(), **(values or {})})

    def expression(
        self, signals: Mapping[str, Any] | None = None, values: Mapping[str, Any] | None = None
    ) -> sp.Expr:
        """The law on symbols, or on the signals and values in their place."""
        if signals is None and values is None:
            return _expression(self)
        return sp.sympify(self.law(self._now(signals), self._parameters(values)), strict=True)

    def rates(
        self, signals: Mapping[str, Any] | None = None, values: Mapping[str, Any] | None = None
    ) -> dict[str, sp.Expr]:
        """Hidden state -> its rate of change, on symbols or on the signals in their place."""
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
        return dict(_corrections(self))

    def dry_bounds(self) -> dict[str, sp.Expr]:
        """Hidden state -> largest rate by which dry friction slows it, on symbols; {}: none."""
        return dict(_dry_bounds(self))

    def led_momentum(self) -> sp.Expr:
        """Momentum of the body that corrections lead, on symbols; 0 without corrections."""
        if self.led is None:
            return sp.S(0)
        return self.led(self._parameters(None)) * sum(self.corrections().values(), sp.S(0))

    def is_absent(self, values: Mapping[sp.Symbol, float]) -> bool:
        """Whether these parameter values (by symbol) mean that the effect is not there."""
        symbols = self.symbols()
        return all(values[symbols[name]] == value for name, value in self.absent.items())

    def linear_form(self, s: sp.Symbol, values: Mapping[str, Any] | None = None) -> sp.Expr | None:
        """Declared linear part at the Laplace variable s; None where the effect declares none.

        roles force and structure: complex stiffness (force per position, added to the impedance
        relative to position); role actuation: transfer function from command to its output.
        """
        if not self.linear:
            return None
        drive = sp.Symbol("drive")
        signals = dict(position=drive, velocity=s * drive, acceleration=s**2 * drive, command=drive)
        signals |= dict(interaction_force=sp.S(0))
        states = self.state_symbols()
        law, rates = self.expression(signals, values), self.rates(signals, values)
        states_in_s = sp.solve(
            [s * states[n] - rate for n, rate in rates.items()], *states.values()
        )
        law = law.subs(states_in_s) if rates else law
        law = law.replace(delayed, lambda signal, delay: signal * sp.exp(-s * delay))
        return sp.simplify(law / drive)


# laws on symbols are asked for at every evaluation of a residual: they are built once


@lru_cache(maxsize=256)
def _expression(effect: Effect) -> sp.Expr:
    return effect.expression({}, {})


@lru_cache(maxsize=256)
def _rates(effect: Effect) -> dict[str, sp.Expr]:
    return effect.rates({}, {})


@lru_cache(maxsize=256)
def _corrections(effect: Effect) -> dict[str, sp.Expr]:
    now, p = effect._now(None), effect._parameters(None)
    return {
        name: sp.sympify(state.correction(now, p), strict=True)
        for name, state in effect.states.items()
        if state.correction is not None
    }


@lru_cache(maxsize=256)
def _channels(effect: Effect) -> frozenset[str]:
    laws = (effect.expression(), *effect.rates().values())
    used = {n for n in FURTHER if any(law.has(SIGNALS[n]) for law in laws)}
    return frozenset(FURTHER[n] for n in used)


@lru_cache(maxsize=256)
def _dry_bounds(effect: Effect) -> dict[str, sp.Expr]:
    now, p = effect._now(None), effect._parameters(None)
    return {
        name: sp.sympify(state.dry(now, p), strict=True)
        for name, state in effect.states.items()
        if state.dry is not None
    }


@lru_cache(maxsize=256)
def _strength(effect: Effect) -> str | None:
    if len(effect.absent) != 1 or effect.states:
        return None
    ((name, value),) = effect.absent.items()
    linear = sp.diff(effect.expression(), effect.symbols()[name], 2) == 0
    return name if value == 0.0 and linear else None


@lru_cache(maxsize=256)
def _phase(effect: Effect) -> str | None:
    angles = [n for n, p in effect.parameters.items() if p.quantity == "angle"]
    if effect.strength is None or len(angles) != 1:
        return None
    wave = sp.diff(effect.expression(), effect.symbols()[effect.strength])
    turned = sp.diff(wave, effect.symbols()[angles[0]], 2)
    return angles[0] if sp.simplify(wave + turned) == 0 else None


@lru_cache(maxsize=64)
def _without(effect: Effect, parameter: str) -> Effect:
    def at_zero(law: Callable[[Any, Any], sp.Expr]) -> Callable[[Any, Any], sp.Expr]:
        return lambda now, p: law(now, SimpleNamespace(**{**vars(p), parameter: sp.S(0)}))

    def if_any(law: Callable[[Any, Any], sp.Expr] | None) -> Callable[[Any, Any], sp.Expr] | None:
        return None if law is None else at_zero(law)

    less = replace(
        effect,
        law=at_zero(effect.law),
        coupling=if_any(effect.coupling),
        states={
            n: replace(
                s,
                rate=at_zero(s.rate),
                correction=if_any(s.correction),
                dry=if_any(s.dry),
                stop=if_any(s.stop),
            )
            for n, s in effect.states.items()
        },
        parameters={n: p for n, p in effect.parameters.items() if n != parameter},
    )
    return remember(less, _without, effect, parameter)


def ordered(effects: tuple[Effect, ...], role: Role) -> list[Effect]:
    """The effects of one role in the order in which they act."""
    chosen = [e for e in effects if e.role == role]
    rank = {name: i for i, name in enumerate(ACTUATION_ORDER)}
    if role != "actuation":
        return chosen
    return sorted(chosen, key=lambda e: rank.get(e.name, len(rank)))
