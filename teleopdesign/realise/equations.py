"""A diagram as explicit equations on sympy symbols: the start of every simulated form.

Bodies and their connections are continuous ("analog"). The parts between sensors and commands
belong to the computer: they are sampled, with held commands, or, in the continuous approximation,
part of the same set of equations. All equations are linear in accelerations and forces and are
solved for them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy as sp

from ..base.errors import ModelError, UnknownSignal, did_you_mean
from ..blocks import Body, solve_carried_force
from ..controllers import parameter_symbol
from ..diagrams import Attached, Control, Diagram, Junction, Kinematics, Linked, Moving
from ..effects import SIGNALS
from ._linear import Steps, solve_linear
from .bristle import WITHIN_LEVEL
from .computer import (
    ComputerEquations,
    computer_signals,
    held_signals,
    solve_computer,
    write_computer,
)
from .signal_symbols import (
    NO_VELOCITY,
    TIME,
    LateSignals,
    acceleration,
    check_inputs,
    motion_of,
    parameter_names,
    place_controller,
    refuse_unsimulated,
    replace_delays,
    signal,
    sum_inputs,
    velocity,
)

_NO_COMMAND = sp.Symbol("no_command", real=True)


@dataclass(frozen=True)
class Equations:
    """Explicit equations of a diagram.

    rates: state -> rate;  inputs: analog inputs
    signals: analog signal -> expression, and the friction of each body as "Z_M_friction"
    commands: signal -> held command (sampled);  late: symbol -> (expression, delay)
    computer: the sampled part;  sampled_inputs: outside signals that the computer reads
    motions: motions that are simulated;  prescribed: prescribed motions
    parameters: symbol -> name in `Diagram.values`
    joined: quantities that the other expressions are written in, in an order of computation
    """

    rates: Mapping[sp.Symbol, sp.Expr]
    signals: Mapping[str, sp.Expr]
    inputs: tuple[sp.Symbol, ...]
    commands: Mapping[str, sp.Symbol]
    late: Mapping[sp.Symbol, tuple[sp.Expr, sp.Expr]]
    computer: ComputerEquations
    sampled_inputs: tuple[str, ...]
    motions: tuple[str, ...]
    prescribed: tuple[str, ...]
    parameters: Mapping[sp.Symbol, str]
    joined: Mapping[sp.Symbol, sp.Expr]

    @property
    def delays(self) -> tuple[sp.Expr, ...]:
        """Delay (s) of each late signal, by parameters: analog ones first, then the computer's."""
        return tuple(d for _, d in (*self.late.values(), *self.computer.late.values()))


def build_equations(
    diagram: Diagram, *, prescribed: Iterable[str] = (), sampled: bool = True
) -> Equations:
    """Explicit equations of a diagram whose blocks all have laws.

    prescribed: prescribed motions; the outside force that drives each is then a result
    sampled: True: commands are held inputs, with separate equations of the computer; False: one set
        of continuous equations
    raises ModelError: a prescribed motion is no motion, or equations cannot be solved
    """
    return _Builder(diagram, tuple(prescribed), sampled).build()


def affine_slopes(equations: Equations) -> dict[sp.Symbol, sp.Expr]:
    """Hidden state -> A, for states with a rate A z + B where A does not depend on the state z."""
    moving = {f(m) for m in equations.motions for f in (signal, velocity)}
    by_state = {}
    for state, rate in equations.rates.items():
        # not simplified: exp(-u) could become 1/exp(u), which overflows
        slope = sp.diff(rate, state) if state not in moving else sp.S(0)
        if slope != 0 and not slope.has(state):
            by_state[state] = slope
    return by_state


class _Builder:
    def __init__(self, diagram: Diagram, prescribed: tuple[str, ...], sampled: bool) -> None:
        self.diagram, self.prescribed, self.sampled = diagram, prescribed, sampled
        self.moving = diagram.moving
        motions = [b.motion for b in self.moving]
        for motion in prescribed:
            if motion not in motions:
                raise UnknownSignal(
                    f'{diagram.name}: "{motion}" is no motion, has {", ".join(motions)}'
                    f"{did_you_mean(motion, motions)}"
                )
        self.motions = tuple(m for m in motions if m not in prescribed)
        check_inputs(diagram, motions)
        driven = {b.driver for b in self.moving if b.motion in prescribed}
        self.outside = [s for s in diagram.outside if s not in driven]
        computed = computer_signals(diagram)
        self.digital = computed - set(diagram.outside)
        self.sampled_inputs = tuple(s for s in self.outside if s in computed)
        self.rates: dict[sp.Symbol, sp.Expr] = {}
        self.late: LateSignals = {}
        self.friction: dict[str, sp.Expr] = {}
        self.acting: dict[sp.Symbol, sp.Expr] = {}

    def build(self) -> Equations:
        rows, unknown = self._analog_rows()
        computer = ComputerEquations({}, {}, frozenset(), {})
        commands: dict[str, sp.Symbol] = {}
        inputs = [s for s in self.outside if s not in self.sampled_inputs or self._feeds_analog(s)]
        if self.sampled:
            held = held_signals(self.diagram, self.digital, self.sampled_inputs)
            commands = {s: signal(s) for s in held}
            computer = solve_computer(self.diagram, self.digital)
        else:
            more = write_computer(
                self.diagram, self.digital, signal, velocity, velocity, late=self.late
            )
            rows += more.rows
            self.rates |= more.rates
            unknown += [signal(s) for s in more.outputs]
            inputs = list(self.outside)
        solved, joined = self._place_acting_forces(*solve_linear(rows, unknown, self.diagram.name))
        for motion in self.motions:
            self.rates[signal(motion)] = velocity(motion)
            self.rates[velocity(motion)] = solved[acceleration(motion)]
        rates = {x: rate.xreplace(solved) for x, rate in self.rates.items()}
        late = {s: (e.xreplace(solved), d) for s, (e, d) in self.late.items()}
        signals = {s.name: e for s, e in solved.items() if s.name in self.diagram.signals}
        signals |= {n: e.xreplace(solved) for n, e in self.friction.items()}
        prescribed = [f(m) for m in self.prescribed for f in (signal, velocity, acceleration)]
        return Equations(
            rates=rates,
            signals=signals,
            inputs=(*(signal(s) for s in inputs), *prescribed),
            commands=commands,
            late=late,
            computer=computer,
            sampled_inputs=self.sampled_inputs,
            motions=self.motions,
            prescribed=self.prescribed,
            parameters=parameter_names(self.diagram),
            joined=joined,
        )

    def _place_acting_forces(
        self, solved: dict[sp.Symbol, sp.Expr], joined: Steps
    ) -> tuple[dict[sp.Symbol, sp.Expr], Steps]:
        """The solution with the forces behind nonlinear actuators inserted, and the named steps.

        raises ModelError: such a force depends on itself at once
        """
        forces = {s: e.xreplace(solved) for s, e in self.acting.items()}
        if any(e.free_symbols & set(forces) for e in forces.values()):
            raise ModelError(
                f"{self.diagram.name}: a command depends at once on the force behind a nonlinear "
                "actuator: a filter in the force feedback, or sampling, parts them"
            )
        known = {s: e.xreplace(forces) for s, e in solved.items()} | forces
        return known, {s: e.xreplace(forces) for s, e in joined.items()}

    def _feeds_analog(self, name: str) -> bool:
        """Whether an analog part uses this outside signal directly, as a load of a body does."""
        for part in self.diagram.parts:
            if isinstance(part, Moving) and name in part.loads:
                return True
            if isinstance(part, Control) and part.analog and name in (part.input, *part.others):
                return True
            if isinstance(part, Junction) and name in part.terms:
                if part.output not in self.digital:
                    return True
        return False

    def _analog_rows(self) -> tuple[list[sp.Expr], list[sp.Symbol]]:
        rows: list[sp.Expr] = []
        unknown = [acceleration(m) for m in self.motions]
        unknown += [signal(b.driver) for b in self.moving if b.motion in self.prescribed]
        for part in self.diagram.parts:
            if isinstance(part, Moving):
                load = sum(g * signal(s) for s, g in part.loads.items())
                rows.append(self._balance_body(part, signal(part.command)) - load)
            elif isinstance(part, Attached):
                rows.append(signal(part.force) - part.sign * self._balance_body(part, _NO_COMMAND))
                unknown.append(signal(part.force))
            elif isinstance(part, Linked):
                rows += self._link_bodies(part)
                unknown += [signal(s) for s in part.forces]
            elif isinstance(part, Control) and part.analog:
                v = motion_of(self.diagram, part.motion)[1] if part.motion else NO_VELOCITY
                known = self.diagram.is_position(part.input)
                source = self.diagram.position(part.input) if known else signal(part.input)
                others = tuple(map(signal, part.others))
                equation = place_controller(part, source, v, v, others=others, late=self.late)
                rows.append(signal(part.output) - equation.output)
                unknown.append(signal(part.output))
                self.rates |= equation.rates
            elif isinstance(part, Junction | Kinematics) and part.output not in self.digital:
                rows.append(signal(part.output) - sum_inputs(part, signal))
                unknown.append(signal(part.output))
        return rows, unknown

    def _link_bodies(self, part: Linked) -> list[sp.Expr]:
        forces = part.body.forces(
            [motion_of(self.diagram, m) for m in part.motions],
            lambda name: parameter_symbol(part.name, name),
        )
        pairs = zip(part.forces, forces, strict=True)
        return [signal(s) - part.sign * force for s, force in pairs]

    def _balance_body(self, part: Moving | Attached, command: sp.Symbol) -> sp.Expr:
        """inertia a + force + friction - acting: the force that the body needs from other parts."""
        assert isinstance(part.body, Body)
        refuse_unsimulated(part, self.diagram.name)
        equation = solve_carried_force(part.body.equation(), part.body.effects)
        position, speed, change = motion_of(self.diagram, part.motion)
        names = {s: parameter_symbol(part.name, n) for n, s in part.body.symbols().items()}
        hidden = {x: sp.Symbol(f"{part.name}_{x.name}", real=True) for x in equation.rates}
        here: dict[sp.Expr, sp.Expr] = {
            **names,
            **hidden,
            SIGNALS["position"]: position,
            SIGNALS["velocity"]: speed,
            SIGNALS["acceleration"]: change,
            SIGNALS["direction"]: sp.sign(speed),
            SIGNALS["time"]: TIME,
            SIGNALS["command"]: command,
        }
        acting = replace_delays(part.name, equation.acting.xreplace(here), self.late)
        if sp.diff(acting, command).has(command):  # known once the command is
            force = sp.Symbol(f"{part.name}_acting", real=True)
            self.acting[force], acting = acting, force
        here[SIGNALS["acting_force"]] = acting
        held = _held_at_stops(part.body, equation.level)
        friction = equation.friction.xreplace(held)
        if any(WITHIN_LEVEL in effect.always for effect in part.body.effects):
            friction = _limit_each_way(friction, equation.level)
        total = equation.inertia * SIGNALS["acceleration"] + equation.force.xreplace(held)
        total += friction
        for state, rate in equation.rates.items():
            self.rates[hidden[state]] = replace_delays(part.name, rate.xreplace(here), self.late)
        if equation.friction != 0:
            self.friction[f"{part.name}_friction"] = friction.xreplace(here)
        return (total.xreplace(here) - acting).xreplace({_NO_COMMAND: sp.S(0)})


def _limit_each_way(value: sp.Expr, level: sp.Expr) -> sp.Expr:
    """The value within the level of its direction: a bristle that turns within one step may end
    far beyond. At rest, friction that holds has the level of the motion that it prevents.
    """
    ahead, back = (level.xreplace({SIGNALS["direction"]: sp.Integer(way)}) for way in (1, -1))
    # not evaluated: sympy would compare the two at length, and cannot decide
    return sp.Max(-back, sp.Min(value, ahead, evaluate=False), evaluate=False)


def _held_at_stops(body: Body, level: sp.Expr) -> dict[sp.Symbol, sp.Expr]:
    """Hidden state -> the state within its stop: a step may carry it beyond, its force never.

    level: of the body's friction, its carried force solved for
    """
    held = {}
    for effect in body.effects:
        for name, (_, stop) in effect.stops().items():
            z = effect.state_symbols()[name]
            held[z] = _limit_each_way(z, stop.xreplace({SIGNALS["level"]: level}))
    return held


@dataclass(frozen=True)
class Layout:
    """Order of all arguments and results of the loop, as names.

    columns: of a row of the result
    exponential: hidden states whose affine part is integrated exactly; they are the last states
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
