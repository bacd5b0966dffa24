"""Source of the generated loop `run` over inner steps and samples, line by line."""

from __future__ import annotations

import sympy as sp

from . import _velocity_estimate
from ._codegen import ARGUMENTS, Generator
from .equations import acceleration, estimate, signal, travel_rate, velocity


def loop_source(generator: Generator) -> str:
    """Source of `run`, to stand behind the functions of the generator."""
    return _Loop(generator).source()


#: of a motion: where it is, how fast, and what the computer knows of that
_MOTION = (signal, velocity, travel_rate, estimate)


class _Loop:
    """Source of `run`, line by line."""

    def __init__(self, generator: Generator) -> None:
        self.g = generator
        self.v = generator.variable
        self.lines: list[str] = []

    def add(self, depth: int, *lines: str) -> None:
        self.lines += ["    " * depth + line for line in lines if line]

    def source(self) -> str:
        g, v = self.g, self.v
        self.add(0, "@jitted")
        self.add(0, f"def run({', '.join(ARGUMENTS)}):")
        self.add(1, *(f"p{i} = parameters[{i}]" for i in range(len(g.parameters))))
        self.add(1, *(f"{v(s)} = start[{i}]" for i, s in enumerate(g.states)))
        self.add(1, *(f"{v(s)} = computer_start[{i}]" for i, s in enumerate(g.computer_states)))
        self.add(1, *(f"{v(s)} = 0.0" for s in (*g.commands, *g.late)))
        self.add(1, *(f"slope_{v(s)} = 0.0" for s in g.slopes), "worst = 0.0", "row = 0")
        computed = [f"{v(n)}_made" for n in g.equations.computer.signals] if g.commands else []
        for m in g.motions if g.commands else []:
            computed += [f"{v(m)}_before", v(travel_rate(m)), v(estimate(m))]
        computed += [v(n) for n in g.equations.signals]
        computed += [v(acceleration(m)) for m in g.equations.motions]
        self.add(1, *(f"{name} = 0.0" for name in computed))
        if g.commands and g.motions:
            self.add(1, *_velocity_estimate.gains(g.observer))
            for m in g.motions:
                self.add(1, *_velocity_estimate.start(g.observer, v(signal(m)), "0.0"))
        self.add(1, "for j in range(samples * inner + 1):")
        self.add(2, "time = j * h", *self._inputs("2 * j", ""))
        if g.commands:
            self.add(2, "if j % inner == 0:", "    n = j // inner")
            self._sample(3)
        if g.commands:
            self.add(2, "m = (j - lag) // inner")
            self.add(2, "if m >= 0:")
            self.add(3, *(f"{v(c)} = held[m, {i}]" for i, c in enumerate(g.commands)))
        self._late(2)
        self.add(2, "if every_step or j % inner == 0:")
        self._record(3)
        self.add(2, "if j == samples * inner:", "    break")
        self._step(2)
        self.add(1, "return worst")
        return "\n".join(self.lines) + "\n"

    def _inputs(self, index: str, suffix: str) -> list[str]:
        return [
            f"{self.v(s)}{suffix} = inputs[{i}, {index}]"
            for i, s in enumerate(self.g.equations.inputs)
        ]

    def _call(self, name: str, states: str = "", inputs: str = "", late: str = "") -> str:
        g, v = self.g, self.v
        arguments = [f"time{inputs}"]
        arguments += [f"{v(s)}{states}" for s in g.states]
        arguments += [f"{v(s)}{inputs}" for s in g.equations.inputs]
        arguments += map(v, g.commands)
        arguments += [f"{v(s)}{late}" for s in g.late]
        arguments += [f"p{i}" for i in range(len(g.parameters))]
        return f"{name}({', '.join(arguments)})"

    def _analog_now(self, depth: int) -> None:
        """Signals and accelerations at the node, under their names."""
        g = self.g
        names = [acceleration(m).name for m in g.equations.motions] + list(g.equations.signals)
        if names:
            self.add(depth, f"now = {self._call('signals')}")
            self.add(depth, *(f"{self.v(n)} = now[{i}]" for i, n in enumerate(names)))

    def _sample(self, depth: int) -> None:
        g = self.g
        self._analog_now(depth)  # what sensors see: just before the new command
        for m in g.motions:
            x, v, rate, known = map(self.v, (f(m) for f in _MOTION))
            seen = f"{x}_seen"
            self.add(depth, f"{seen} = {x}", "if encoder_step > 0.0:")
            self.add(depth + 1, f"{seen} = floor({x} / encoder_step + 0.5) * encoder_step")
            self.add(depth, "if n == 0:", f"    {rate} = {v}", f"    {known} = {v}")
            self.add(depth + 1, *_velocity_estimate.start(g.observer, x, seen))
            self.add(depth, "else:")
            self.add(depth + 1, f"{rate} = ({seen} - {x}_before) / period")
            update = _velocity_estimate.update(g.observer, x, seen, rate, known)
            self.add(depth + 1, *update)
            self.add(depth, f"{x}_before = {seen}")
        for s in g.sensors:
            name = s.name.removesuffix("_measured")
            seen = f"{self.v(name)}_seen" if name in g.motions else self.v(name)
            self.add(depth, f"{self.v(s)} = {seen}")
        self.add(depth, *(f"{self.v(s)} = sampled[{i}, n]" for i, s in enumerate(g.sampled_inputs)))
        reads = [g.names[s] for s in g.reads]
        given = ", ".join(reads)
        chosen = [s for s in g.computer_states if s in g.equations.computer.before]
        self.add(depth, "if n > 0:" if chosen else "")
        self._advance(depth + 1, "before", chosen, given)
        names = list(g.equations.computer.signals)
        self.add(depth, f"made = computer({given})" if names else "")
        self.add(depth, *(f"{self.v(n)}_made = made[{i}]" for i, n in enumerate(names)))
        for i, c in enumerate(g.commands):
            source = (
                f"{self.v(c)}_made"
                if c in names
                else f"sampled[{g.sampled_inputs.index(signal(c))}, n]"
            )
            self.add(depth, f"held[n, {i}] = {source}")
        rest = [s for s in g.computer_states if s not in g.equations.computer.before]
        self._advance(depth, "after", rest, given)

    def _advance(self, depth: int, name: str, states: list[sp.Symbol], given: str) -> None:
        """Carry states over a sample: exactly by their rates, or as they say."""
        computer = self.g.equations.computer
        exact = [s for s in states if s in computer.rates]
        stated = [s for s in states if s in computer.steps]
        self.add(depth, f"made_{name} = {name}_rates({given})" if exact else "")
        self.add(depth, f"next_{name} = {name}_steps({given})" if stated else "")
        for i, s in enumerate(exact):
            self.add(depth, f"e, f, _, _ = phi(period * made_{name}[{i}])")
            self.add(
                depth, f"{self.v(s)} = e * {self.v(s)} + period * f * made_{name}[{i + len(exact)}]"
            )
        self.add(depth, *(f"{self.v(s)} = next_{name}[{i}]" for i, s in enumerate(stated)))

    def _late(self, depth: int) -> None:
        g = self.g
        if not g.late:
            return
        self.add(depth, f"values = {self._call('late_values')}")
        for k, (symbol, (expression, _)) in enumerate(g.equations.late.items()):
            s = self.v(symbol)
            moving = {*g.equations.rates, *g.equations.joined}
            smooth = bool(expression.free_symbols & moving) or not g.commands
            self.add(depth, f"history[j, {k}] = values[{k}]", f"q = j - late_steps[{k}]")
            self.add(depth, f"{s} = history[q, {k}] if q >= 0 else 0.0")
            end = f"history[q + 1, {k}] if q >= -1 else 0.0" if smooth else f"{s}"
            self.add(depth, f"{s}_end = {end}", f"{s}_middle = 0.5 * ({s} + {s}_end)")

    def _record(self, depth: int) -> None:
        g = self.g
        if not g.commands:
            self._analog_now(depth)
        else:
            self.add(depth, "if j % inner != 0:")
            self._analog_now(depth + 1)
        columns = g.layout().columns
        made = {n: f"{self.v(n)}_made" for n in g.equations.computer.signals}
        for i, name in enumerate(columns):
            self.add(depth, f"out[row, {i}] = {made.get(name) or self.v(name)}")
        self.add(depth, "row += 1")

    def _step(self, depth: int) -> None:
        g = self.g
        self.add(depth, *self._inputs("2 * j + 1", "_middle"), *self._inputs("2 * j + 2", "_end"))
        self.add(depth, "time_middle = time + 0.5 * h", "time_end = time + h")
        if g.slopes:
            self.add(depth, f"c = {self._call('slopes')}")
            for i, s in enumerate(map(self.v, g.slopes)):
                self.add(depth, f"z = abs(c[{i}]) * h", f"y = abs(slope_{s}) * h")
                self.add(
                    depth, "if j > 0 and min(z, y) < 0.5:", "    worst = max(worst, abs(z - y))"
                )
                self.add(depth, f"slope_{s} = c[{i}]")
                self.add(depth, f"{s}_h, {s}_g, {s}_e, {s}_1, {s}_2, {s}_3 = weights(h * c[{i}])")
        for stage in range(4 if g.states else 0):
            self._stage(depth, stage)
        for i, state in enumerate(g.states):
            s = self.v(state)
            if state in g.slopes:
                self.add(
                    depth,
                    f"{s} = {s}_e * {s} + h * ({s}_1 * {s}_n0"
                    f" + {s}_2 * ({s}_n1 + {s}_n2) + {s}_3 * {s}_n3)",
                )
            else:
                self.add(
                    depth, f"{s} = {s} + h / 6.0 * (r0[{i}] + 2 * (r1[{i}] + r2[{i}]) + r3[{i}])"
                )
        self.add(depth, *(f"{s} = {s}_end" for s in map(self.v, g.late)))

    def _stage(self, depth: int, stage: int) -> None:
        """Rates at the stage, then the states at which the next one is taken."""
        g = self.g
        at = "" if stage == 0 else str(stage)
        when = ("", "_middle", "_middle", "_end")[stage]
        self.add(depth, f"r{stage} = {self._call('rates', at, when, when)}")
        for i, state in enumerate(g.states):
            s = self.v(state)
            if state in g.slopes:
                self.add(depth, f"{s}_n{stage} = r{stage}[{i}] - slope_{s} * {s}{at}")
            if stage == 3:
                continue
            if state not in g.slopes:
                length = "h" if stage == 2 else "0.5 * h"
                self.add(depth, f"{s}{stage + 1} = {s} + {length} * r{stage}[{i}]")
            elif stage < 2:
                new = f"{s}_h * {s} + 0.5 * h * {s}_g * {s}_n{stage}"
                self.add(depth, f"{s}{stage + 1} = {new}")
            else:
                new = f"{s}_h * {s}1 + 0.5 * h * {s}_g * (2 * {s}_n2 - {s}_n0)"
                self.add(depth, f"{s}3 = {new}")
