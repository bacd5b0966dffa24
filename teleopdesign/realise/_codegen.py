"""Source of the laws of a diagram: its equations as functions on rows of numbers.

The loop around them is written by hand (`integrator.py`). A generated module consists of these
functions, of constants that say which row of the loop's memory holds which quantity, and of that
loop.
"""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp

from ..controllers import calls_in
from .equations import Equations, Layout, affine_slopes
from .laws import (
    LawWriter,
    list_inverses,
    locate_entry,
    locate_symbols,
    write_function,
    write_reader,
)
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

#: arguments of laws in continuous time: index of the first of each kind in the memory of the loop
ANALOG = "time states bristles inputs late memory".split()
#: arguments of the computer's laws
DIGITAL = "n period sampled memory".split()


class Generator:
    """Names and source for the equations of one diagram.

    observer: order of the observer that estimates velocities, 2 or 3; 0: a filtered difference
    """

    def __init__(self, equations: Equations, *, observer: int = 0) -> None:
        e = self.equations = equations
        self.observer = observer
        self.slopes = affine_slopes(e)
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
        #: what is divided by that does not change, computed once
        laws = (*self._expressions(), *self.slopes.values())
        self.inverses = {
            power: sp.Symbol(f"inverse {i}")
            for i, power in enumerate(list_inverses(laws, self.parameters))
        }
        self.sensors = sorted(
            {s for x in self._computer_expressions() for s in x.free_symbols}
            & {reading_symbol(s) for s in (*e.signals, *self.motions)},
            key=str,
        )
        self.motion_signals = [f(m) for m in self.motions for f in (signal, velocity, acceleration)]
        self.names = self._name_symbols()

    def _name_symbols(self) -> dict[sp.Symbol, str]:
        """Symbol of the equations -> its private name."""
        e = self.equations
        names = {p: f"p{i}" for i, p in enumerate(self.parameters)}
        names |= {s: f"i{i}_" for i, s in enumerate(self.inverses.values())}
        names |= {s: f"j{i}_" for i, s in enumerate(e.joined)} | {TIME: "time", PERIOD: "period"}
        read = {*self.states, *self.computer_states, *e.inputs, *e.commands.values(), *self.late}
        read |= {*self.sensors, *self.sampled_inputs, *self.motion_signals, *self.sampled_late}
        read |= {f(m) for m in self.motions for f in (travel_rate, estimate)}
        # "_": no such name begins another one
        return names | {s: f"v{i}_" for i, s in enumerate(sorted(read - names.keys(), key=str))}

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
        """Functions of systems that are known as code, by their names in the source."""
        return calls_in(self._expressions())

    def layout(self) -> Layout:
        """The order of states, inputs, commands, parameters and columns."""
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
        functions = (self._write_analog(), self._write_signals(), self._write_computer())
        return f"{self._write_constants()}\n\n{''.join(functions)}"

    def _write_constants(self) -> str:
        """Source of the constants: first row of each group in the loop's memory, group sizes."""
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
            **{
                f"{group}_{stage}": many
                for stage in range(4)
                for group, many in (("RATES", states), ("RESTS", bristles))
            },
            **dict.fromkeys(("SLOPES", "LAST_SLOPES", "WORST"), bristles),
            **dict.fromkeys(("E_HALF", "G_HALF", "E_STEP"), bristles),
            **dict.fromkeys(("WEIGHT_0", "WEIGHT_1", "WEIGHT_3"), bristles),
            **dict.fromkeys(("POSITIONS", "VELOCITIES", "LAST_READING", "TRAVEL"), motions),
            **dict.fromkeys(("KNOWN", "OBSERVED", "BEND"), motions),
            "NOW": len(self._analog_signals()),
            "MADE": len(self._computer_signals()),
            "COLUMNS": len(self.layout().columns),
            "SPOILED": 1,
            "PARAMETERS": len(self.parameters),
            "INVERSES": len(self.inverses),
        }
        lines, first = [], 0
        for name, count in rows.items():
            lines.append(f"{name} = {first} * LANES")
            first += count
        counted = {"MOTIONS": motions} | {
            name: rows[name]
            for name in "STATES BRISTLES COMMANDS LATE SAMPLED_LATE COLUMNS PARAMETERS".split()
        }
        lines += [f"MANY_{name} = {count}" for name, count in counted.items()]
        lines.append(f"ROWS = {first}")
        lines.append(f"SMOOTH = ({''.join(f'{x}, ' for x in [*self._mark_smooth(), True])})")
        lines.append(f"COMPUTER = {bool(self.commands)}")
        lines.append(f"OBSERVER = {self.observer}")
        return "\n".join(lines)

    def _mark_smooth(self) -> list[bool]:
        """For each late signal, whether it changes within a step instead of being held over it."""
        e = self.equations
        moving = {*e.rates, *e.joined, *e.inputs}
        if not self.commands:
            return [True] * len(e.late)
        for _ in e.late:  # once for each late signal: one may be the delay of another
            moving |= {s for s, (x, _) in e.late.items() if x.free_symbols & moving}
        return [bool(x.free_symbols & moving) for x, _ in e.late.values()]

    def _analog_signals(self) -> dict[sp.Symbol, sp.Expr]:
        """Accelerations and signals in continuous time, by their symbols."""
        e = self.equations
        accelerations = {acceleration(m): e.rates[velocity(m)] for m in e.motions}
        return accelerations | {signal(name): x for name, x in e.signals.items()}

    def _computer_signals(self) -> dict[str, sp.Expr]:
        """Signals of the computer, by name; empty without commands."""
        return dict(self.equations.computer.signals) if self.commands else {}

    def _analog_places(self) -> dict[sp.Symbol, str]:
        e = self.equations
        rows = {"states": self.moving, "bristles": self.bristles, "late": self.late}
        places = locate_symbols({**rows, "COMMANDS": [e.commands[c] for c in self.commands]})
        places |= {x: f"inputs[{i}]" for i, x in enumerate(e.inputs)}
        return places | self._parameter_places()

    def _parameter_places(self) -> dict[sp.Symbol, str]:
        return locate_symbols(
            {"PARAMETERS": self.parameters, "INVERSES": list(self.inverses.values())}
        )

    def _write_inverses(self) -> str:
        """Source of the function that computes constant inverses once, before the steps."""
        writer = LawWriter(("memory",), locate_symbols({"PARAMETERS": self.parameters}), self.names)
        lines = writer.lines({f"out{i}": power for i, power in enumerate(self.inverses)})
        ends = [f"{locate_entry('INVERSES', i)} = out{i}" for i in range(len(self.inverses))]
        return write_function("find_inverses", writer.arguments, [*lines, *ends])

    def _write_analog(self) -> str:
        e = self.equations
        places, arguments = self._analog_places(), tuple(ANALOG)
        write = LawWriter(arguments, places, self.names, e.joined, self.inverses).function
        moving, bristles = ([e.rates[s] for s in g] for g in (self.moving, self.bristles))
        parts = [
            write_reader("inputs_at", len(e.inputs)),
            write_reader("sampled_inputs_at", len(self.sampled_inputs)),
            self._write_inverses(),
            write("rates", to_states=moving, to_bristles=bristles),
            write("slopes", to=[self.slopes[s] for s in self.bristles]),
            write("signals", to=self._analog_signals().values()),
            write("late_values", to=[x for x, _ in e.late.values()]),
        ]
        return "".join(parts)

    def _write_signals(self) -> str:
        """Source of the motions that a computer reads, and of the columns of a result row."""
        places = {x.name: place for x, place in self._analog_places().items()}
        read = self.motions if self.commands else []
        lines = [
            f"{locate_entry(to, i)} = {places[of(m).name]}"
            for to, of in (("to_positions", signal), ("to_velocities", velocity))
            for i, m in enumerate(read)
        ]
        arguments = ["states", "inputs", "memory", "to_positions", "to_velocities"]
        motions = write_function("motions", arguments, lines)
        places = {
            name: text.replace("[states", "[STATES").replace("[bristles", "[BRISTLES")
            for name, text in places.items()
        }
        places |= {x.name: locate_entry("NOW", i) for i, x in enumerate(self._analog_signals())}
        places |= {name: locate_entry("MADE", i) for i, name in enumerate(self._computer_signals())}
        columns = enumerate(self.layout().columns)
        lines = [f"{locate_entry('to', i)} = {places[name]}" for i, name in columns]
        return motions + write_function("record", ["inputs", "memory", "to"], lines)

    def _write_computer(self) -> str:
        """Source of the computer's signals, and of its states' steps before and after these."""
        motions, made = self.motions, self._computer_signals()
        rows = {
            "NOW": [reading_symbol(x.name) for x in self._analog_signals()],
            "LAST_READING": [reading_symbol(m) for m in motions],
            "TRAVEL": [travel_rate(m) for m in motions],
            "KNOWN": [estimate(m) for m in motions],
            "COMPUTER_STATES": self.computer_states,
            "SAMPLED_LATE": self.sampled_late,
        }
        kept = (x for x, _ in self.equations.computer.late.values()) if self.commands else ()
        read = {x: f"sampled[{i}]" for i, x in enumerate(self.sampled_inputs)}
        places = locate_symbols(rows) | read | self._parameter_places()
        names = {**self.names, TIME: "(n * period)"}
        writer = LawWriter(tuple(DIGITAL), places, names, inverses=self.inverses)
        sources = {x.name: text for x, text in read.items()}
        sources |= {name: locate_entry("MADE", i) for i, name in enumerate(made)}
        commands = [f"{locate_entry('to', i)} = {sources[c]}" for i, c in enumerate(self.commands)]
        parts = [
            self._write_steps(writer, "computer_before", True),
            writer.function("computer_signals", to=made.values()),
            writer.function("computer_late", to=kept),
            self._write_steps(writer, "computer_after", False),
            write_function("held_commands", ["n", "sampled", "memory", "to"], commands),
        ]
        return "".join(parts)

    def _write_steps(self, writer: LawWriter, name: str, before: bool) -> str:
        """Source of a function that advances states by a sample: exactly, or by their law."""
        computer = self.equations.computer
        results: dict[str, sp.Expr] = {}
        ends: list[str] = []
        for i, s in enumerate(self.computer_states):
            if (s in computer.before) is not before or not self.commands:
                continue
            state = locate_entry("COMPUTER_STATES", i)
            if s in computer.steps:
                results[f"out{i}"] = computer.steps[s]
                ends.append(f"{state} = out{i}")
                continue
            results[f"a{i}"] = sp.diff(computer.rates[s], s)
            results[f"b{i}"] = computer.rates[s].xreplace({s: sp.S(0)})
            ends.append(f"e, f, _, _ = phi(period * a{i})")
            ends.append(f"{state} = e * {state} + period * f * b{i}")
        return write_function(name, writer.arguments, [*writer.lines(results), *ends])
