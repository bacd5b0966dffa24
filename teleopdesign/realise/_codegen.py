"""Source of the laws of a diagram: its equations as functions on rows of numbers.

The loop around them is written by hand (`integrator.py`); a generated module is these functions,
the constants that say which row of the loop's memory holds what, and that loop.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

import sympy as sp

from ..controllers import calls_in
from .equations import Equations
from .laws import Names, assignments, indent
from .signal_symbols import (
    PERIOD,
    TIME,
    acceleration,
    estimate,
    reading_symbol,
    signal,
    travel_rate,
    velocity,
)

#: arguments of laws in continuous time: where what they take begins in the memory of the loop
ANALOG = "time states bristles inputs late memory".split()
#: arguments of the computer's laws
DIGITAL = "n period sampled memory".split()


@dataclass(frozen=True)
class Layout:
    """Order of everything that the loop takes and returns, as names.

    columns: of a row of the result;  exponential: states stepped exactly in their affine part, the
    last ones among the states
    """

    states: tuple[str, ...]
    computer_states: tuple[str, ...]
    inputs: tuple[str, ...]
    sampled_inputs: tuple[str, ...]
    commands: tuple[str, ...]
    late: tuple[str, ...]
    parameters: tuple[str, ...]
    columns: tuple[str, ...]
    exponential: tuple[str, ...]


def slopes(equations: Equations) -> dict[sp.Symbol, sp.Expr]:
    """Hidden state -> A, where its rate is A z + B with A free of the state."""
    moving = {f(m) for m in equations.motions for f in (signal, velocity)}
    by_state = {}
    for state, rate in equations.rates.items():
        # as it stands: simplified, exp(-u) may come out as 1/exp(u), which overflows
        slope = sp.diff(rate, state) if state not in moving else sp.S(0)
        if slope != 0 and not slope.has(state):
            by_state[state] = slope
    return by_state


def needed_steps(
    results: Iterable[sp.Expr], joined: Mapping[sp.Symbol, sp.Expr]
) -> dict[sp.Symbol, sp.Expr]:
    """Those of the named steps that the results are written in, in their order."""
    wanted = set().union(*(sp.sympify(r, strict=True).free_symbols for r in results))
    needed = {}
    for symbol, expression in reversed(list(joined.items())):
        if symbol in wanted:
            needed[symbol] = expression
            wanted |= expression.free_symbols
    return dict(reversed(list(needed.items())))


#: symbol -> the text that reads it
_Places = Mapping[sp.Symbol, str]


def _entry(first: str, i: int) -> str:
    """Entry of a lane in the row i of a group."""
    return f"memory[{first} + {f'{i} * LANES + ' if i else ''}lane]"


def _places(rows: Mapping[str, Iterable[sp.Symbol]]) -> dict[sp.Symbol, str]:
    """Where each symbol is read, by the beginning of its group in the memory."""
    return {x: _entry(row, i) for row, symbols in rows.items() for i, x in enumerate(symbols)}


def _function(name: str, arguments: Iterable[str], lines: Iterable[str]) -> str:
    body = indent(list(lines) or ["pass"], 4)
    return f"@jitted\ndef {name}({', '.join([*arguments, 'lane'])}):\n{body}\n\n\n"


def _reader(name: str, many: int) -> str:
    """Source of a function that returns a column of a table as numbers: see `integrator.py`.

    Behind the last column the table stays as it is there: one column is what is held throughout.
    """
    numbers = [*(f"table[{i}, column]" for i in range(many)), "0.0"]  # there may be no input
    held = "    column = min(column, table.shape[1] - 1)\n" if many else ""
    return f"@jitted\ndef {name}(table, column):\n{held}    return ({', '.join(numbers)},)\n\n\n"


@dataclass(frozen=True)
class _Writer:
    """What the source of some laws is written with: arguments, and names of what they hold."""

    arguments: tuple[str, ...]
    places: _Places
    names: Names
    joined: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)

    def lines(self, results: Mapping[str, sp.Expr]) -> list[str]:
        """Lines that compute the results under their private names, common parts once."""
        needed = needed_steps(results.values(), self.joined)
        expressions = (*results.values(), *needed.values())
        used = set().union(*(x.free_symbols for x in expressions))
        return [
            *(f"{self.names[x]} = {place}" for x, place in self.places.items() if x in used),
            *assignments({self.names[s]: e for s, e in needed.items()}, self.names),
            *assignments(results, self.names, shared="k"),
        ]

    def function(self, name: str, **rows: Iterable[sp.Expr]) -> str:
        """Source of a function that puts these into the memory, each group from a row on."""
        places = {
            _entry(to, i): sp.sympify(x, strict=True) for to in rows for i, x in enumerate(rows[to])
        }
        results = {f"out{i}": x for i, x in enumerate(places.values())}
        lines = [*self.lines(results), *map(" = ".join, zip(places, results, strict=True))]
        return _function(name, (*self.arguments, *rows), lines)


class Generator:
    """Names and source for one diagram's equations.

    observer: order of the observer that estimates velocities, 2 or 3; 0: a filtered difference
    """

    def __init__(self, equations: Equations, *, observer: int = 0) -> None:
        e = self.equations = equations
        self.observer = observer
        self.slopes = slopes(e)
        self.bristles = sorted(self.slopes, key=str)
        self.moving = sorted((x for x in e.rates if x not in self.slopes), key=str)
        self.states = [*self.moving, *self.bristles]
        self.computer_states = sorted((*e.computer.rates, *e.computer.steps), key=str)
        self.motions = [*e.motions, *e.prescribed]
        self.commands = list(e.commands)
        self.late = list(e.late)
        self.sampled_late = list(e.computer.late) if e.commands else []
        self.sampled_inputs = [signal(s) for s in e.sampled_inputs] if e.commands else []
        used = set().union(*(x.free_symbols for x in self._expressions()))
        self.parameters = sorted(used & set(e.parameters), key=str)
        self.sensors = sorted(
            {s for x in self._computer_expressions() for s in x.free_symbols}
            & {reading_symbol(s) for s in (*e.signals, *self.motions)},
            key=str,
        )
        self.motion_signals = [f(m) for m in self.motions for f in (signal, velocity, acceleration)]
        self.variables = self._variables()
        self.names = self._names()

    def _variables(self) -> dict[str, str]:
        """Variable of the source for each quantity by its name; no such name begins another one."""
        e = self.equations
        symbols = [*self.states, *self.computer_states, *e.inputs, *self.late, *self.sensors]
        symbols += self.sampled_late
        symbols += [f(m) for m in self.motions for f in (travel_rate, estimate)]
        symbols += [*self.sampled_inputs, *self.motion_signals]
        names = [*map(str, symbols), *self.commands, *e.signals, *e.computer.signals]
        return {name: f"v{i}_" for i, name in enumerate(dict.fromkeys(names))}

    def _names(self) -> dict[sp.Symbol, str]:
        """Private name of every symbol that the equations hold."""
        e = self.equations
        names = {p: f"p{i}" for i, p in enumerate(self.parameters)}
        names |= {s: f"j{i}_" for i, s in enumerate(e.joined)} | {TIME: "time", PERIOD: "period"}
        used = set().union(*(x.free_symbols for x in self._expressions()))
        used |= {*self.states, *self.computer_states, *e.inputs, *e.commands.values(), *self.late}
        used |= {*self.sensors, *self.sampled_inputs, *self.motion_signals, *self.sampled_late}
        used |= {f(m) for m in self.motions for f in (travel_rate, estimate)}
        return names | {s: self.variables[s.name] for s in used if s not in names}

    def _computer_expressions(self) -> list[sp.Expr]:
        computer = self.equations.computer
        steps = computer.steps.values()
        late = (expression for expression, _ in computer.late.values())
        return [*computer.rates.values(), *steps, *computer.signals.values(), *late]

    def _expressions(self) -> list[sp.Expr]:
        e = self.equations
        late = [expression for expression, _ in e.late.values()]
        analog = [*e.rates.values(), *e.signals.values(), *late, *e.joined.values()]
        return [*analog, *self._computer_expressions()]

    def calls(self) -> dict[str, Callable[..., float]]:
        """Functions of systems known as code, by their names in the source."""
        return calls_in(self._expressions())

    def layout(self) -> Layout:
        """The order of everything."""
        e = self.equations
        names = [s.name for s in self.motion_signals]
        names += [*e.signals, *e.computer.signals]
        names += [s.name for s in self.states if s.name not in names]
        return Layout(
            states=tuple(s.name for s in self.states),
            computer_states=tuple(s.name for s in self.computer_states),
            inputs=tuple(s.name for s in e.inputs),
            sampled_inputs=tuple(s.name for s in self.sampled_inputs),
            commands=tuple(self.commands),
            late=tuple(s.name for s in self.late),
            parameters=tuple(e.parameters[p] for p in self.parameters),
            columns=tuple(names),
            exponential=tuple(s.name for s in self.bristles),
        )

    def source(self) -> str:
        """The functions of the equations, and the constants of the loop over them."""
        return f"{self._constants()}\n\n{self._analog()}{self._signals()}{self._computer()}"

    def _constants(self) -> str:
        """First row of the loop's memory for each group of quantities, and their numbers."""
        motions = len(self.motions) if self.commands else 0
        states, bristles, late = len(self.moving), len(self.bristles), len(self.late)
        commands, sampled_late = len(self.commands), len(self.sampled_late)
        rows = {
            "STATES": states,
            "BRISTLES": bristles,
            "COMPUTER_STATES": len(self.computer_states),
            "COMMANDS": commands,
            "NEW_COMMANDS": commands,
            "LATE": late,
            "LATE_MIDDLE": late,
            "LATE_END": late,
            "LATE_VALUES": late,
            "SAMPLED_LATE": sampled_late,
            "SAMPLED_LATE_VALUES": sampled_late,
            "STAGE_STATES": states,
            "STAGE_BRISTLES": bristles,
            "FIRST_BRISTLES": bristles,
            **{f"RATES_{stage}": states for stage in range(4)},
            **{f"RESTS_{stage}": bristles for stage in range(4)},
            **dict.fromkeys(("SLOPES", "LAST_SLOPES", "WORST"), bristles),
            **dict.fromkeys(("E_HALF", "G_HALF", "E_STEP"), bristles),
            **dict.fromkeys(("WEIGHT_0", "WEIGHT_1", "WEIGHT_3"), bristles),
            **dict.fromkeys(("POSITIONS", "VELOCITIES", "SEEN", "TRAVEL"), motions),
            **dict.fromkeys(("KNOWN", "OBSERVED", "BEND"), motions),
            "NOW": len(self._now()),
            "MADE": len(self._made()),
            "COLUMNS": len(self.layout().columns),
            "SPOILED": 1,
            "PARAMETERS": len(self.parameters),
        }
        lines, first = [], 0
        for name, count in rows.items():
            lines.append(f"{name} = {first} * LANES")
            first += count
        counted = {"MOTIONS": motions} | {
            name: rows[name]
            for name in ("STATES", "BRISTLES", "COMMANDS", "LATE", "SAMPLED_LATE", "COLUMNS")
        }
        lines += [f"MANY_{name} = {count}" for name, count in counted.items()]
        lines.append(f"ROWS = {first}")
        lines.append(f"SMOOTH = ({''.join(f'{x}, ' for x in [*self._smooth(), True])})")
        lines.append(f"COMPUTER = {bool(self.commands)}")
        lines.append(f"OBSERVER = {self.observer}")
        return "\n".join(lines)

    def _smooth(self) -> list[bool]:
        """Whether a late signal changes within a step, in place of being held over it."""
        e = self.equations
        moving = {*e.rates, *e.joined, *e.inputs}
        if not self.commands:
            return [True] * len(e.late)
        for _ in e.late:  # a late signal that is late once more
            moving |= {s for s, (x, _) in e.late.items() if x.free_symbols & moving}
        return [bool(x.free_symbols & moving) for x, _ in e.late.values()]

    def _now(self) -> dict[sp.Symbol, sp.Expr]:
        """Accelerations and signals of continuous time, by their symbols."""
        e = self.equations
        accelerations = {acceleration(m): e.rates[velocity(m)] for m in e.motions}
        return accelerations | {signal(name): x for name, x in e.signals.items()}

    def _made(self) -> dict[str, sp.Expr]:
        """Signals of the computer."""
        return dict(self.equations.computer.signals) if self.commands else {}

    def _analog_places(self) -> dict[sp.Symbol, str]:
        e = self.equations
        rows = {"states": self.moving, "bristles": self.bristles, "late": self.late}
        places = _places({**rows, "COMMANDS": [e.commands[c] for c in self.commands]})
        places |= {x: f"inputs[{i}]" for i, x in enumerate(e.inputs)}
        return places | self._parameter_places()

    def _parameter_places(self) -> dict[sp.Symbol, str]:
        return _places({"PARAMETERS": self.parameters})

    def _analog(self) -> str:
        e = self.equations
        write = _Writer(tuple(ANALOG), self._analog_places(), self.names, e.joined).function
        moving, bristles = ([e.rates[s] for s in g] for g in (self.moving, self.bristles))
        parts = [
            _reader("inputs_at", len(e.inputs)),
            _reader("sampled_inputs_at", len(self.sampled_inputs)),
            write("rates", to_states=moving, to_bristles=bristles),
            write("slopes", to=[self.slopes[s] for s in self.bristles]),
            write("signals", to=self._now().values()),
            write("late_values", to=[x for x, _ in e.late.values()]),
        ]
        return "".join(parts)

    def _signals(self) -> str:
        """Which quantities are the motions that a computer reads, and the columns of a row."""
        places = {x.name: place for x, place in self._analog_places().items()}
        read = self.motions if self.commands else []
        lines = [
            f"{_entry(to, i)} = {places[of(m).name]}"
            for to, of in (("to_positions", signal), ("to_velocities", velocity))
            for i, m in enumerate(read)
        ]
        arguments = ["states", "inputs", "memory", "to_positions", "to_velocities"]
        motions = _function("motions", arguments, lines)
        places = {
            name: text.replace("[states", "[STATES").replace("[bristles", "[BRISTLES")
            for name, text in places.items()
        }
        places |= {x.name: _entry("NOW", i) for i, x in enumerate(self._now())}
        places |= {name: _entry("MADE", i) for i, name in enumerate(self._made())}
        columns = enumerate(self.layout().columns)
        lines = [f"{_entry('to', i)} = {places[name]}" for i, name in columns]
        return motions + _function("record", ["inputs", "memory", "to"], lines)

    def _computer(self) -> str:
        """Signals of the computer, and its states stepped before and after they are taken."""
        motions, made = self.motions, self._made()
        rows = {
            "NOW": [reading_symbol(x.name) for x in self._now()],
            "SEEN": [reading_symbol(m) for m in motions],
            "TRAVEL": [travel_rate(m) for m in motions],
            "KNOWN": [estimate(m) for m in motions],
            "COMPUTER_STATES": self.computer_states,
            "SAMPLED_LATE": self.sampled_late,
        }
        kept = (x for x, _ in self.equations.computer.late.values()) if self.commands else ()
        read = {x: f"sampled[{i}]" for i, x in enumerate(self.sampled_inputs)}
        places = _places(rows) | read | self._parameter_places()
        names = {**self.names, TIME: "(n * period)"}
        writer = _Writer(tuple(DIGITAL), places, names)
        sources = {x.name: text for x, text in read.items()}
        sources |= {name: _entry("MADE", i) for i, name in enumerate(made)}
        commands = [f"{_entry('to', i)} = {sources[c]}" for i, c in enumerate(self.commands)]
        parts = [
            self._stepped(writer, "computer_before", True),
            writer.function("computer_signals", to=made.values()),
            writer.function("computer_late", to=kept),
            self._stepped(writer, "computer_after", False),
            _function("held_commands", ["n", "sampled", "memory", "to"], commands),
        ]
        return "".join(parts)

    def _stepped(self, writer: _Writer, name: str, before: bool) -> str:
        """Source of a function that carries states over a sample: exactly, or as they say."""
        computer = self.equations.computer
        results: dict[str, sp.Expr] = {}
        ends: list[str] = []
        for i, s in enumerate(self.computer_states):
            if (s in computer.before) is not before or not self.commands:
                continue
            state = _entry("COMPUTER_STATES", i)
            if s in computer.steps:
                results[f"out{i}"] = computer.steps[s]
                ends.append(f"{state} = out{i}")
                continue
            results[f"a{i}"] = sp.diff(computer.rates[s], s)
            results[f"b{i}"] = computer.rates[s].xreplace({s: sp.S(0)})
            ends.append(f"e, f, _, _ = phi(period * a{i})")
            ends.append(f"{state} = e * {state} + period * f * b{i}")
        return _function(name, writer.arguments, [*writer.lines(results), *ends])
