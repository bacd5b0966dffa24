"""A diagram as an interconnected nonlinear python-control system: interchange and reference.

Bodies and their connections are one system. Each controller and each of its junctions is another
one; they are connected by the names of their signals. Controllers act in continuous time:
python-control cannot mix sampled and continuous blocks. With its computer the diagram is one system
in discrete time (`sampled_iosystem.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..controllers import Controller, Stage, from_control
from ..diagrams import Control, Diagram, Junction, Kinematics, with_shared_states
from .equations import Equations, build_equations
from .laws import PrivateNames, needed_steps, private_names
from .sampled_iosystem import sampled_iosystem
from .signal_symbols import TIME, motion_of, signal, sum_inputs, velocity
from .simulated import prepare_for_simulation

if TYPE_CHECKING:
    import control

MECHANICS = "mechanics"


@dataclass(frozen=True)
class SymbolValues:
    """Values of symbols in the equations: parameters, with the user's names, and fixed values."""

    parameters: dict[sp.Symbol, tuple[str, float]]
    fixed: dict[sp.Symbol, float]


@check_types
def to_iosystem(
    diagram: Diagram,
    *,
    prescribed: tuple[str, ...] = (),
    give: float = 1e-5,
    delay_order: int | None = None,
    dt: float | None = None,
    step: float = 1e-4,
) -> control.NonlinearIOSystem:
    """The diagram as a python-control system, in continuous time or sampled.

    prescribed: motions that are inputs ("L", "L_velocity", "L_acceleration") instead of results
    give: m or rad, as in `simulate`
    delay_order: order of the Pade approximation of each delay block, as python-control has no
        delays; `simulate` and all responses compute them exactly
    dt: s; None: controllers act in continuous time. Otherwise the system is in discrete time with
        this step: the diagram with its computer of this period, as in `simulate` (velocity by the
        difference of readings, no delay of commands, no encoder). All inputs are held over a step.
        Outputs are the signals at the sample; measured ones just before the command changes
    step: longest inner step of bodies and analog blocks between samples, s
    Inputs are the signals from outside, outputs all others; states are those of `simulate`.
        Parameters are its `params`, by their names in `Diagram.values`. They can change without
        building it anew: `input_output_response(..., params={"Z_M.inertia": 0.2})`. With dt,
        `params` are those of the diagram as its computer realises it, and states are also the held
        commands ("u_held"), the last position readings ("L_read") and the samples of delay blocks.
    raises ModelError: a block has no laws, a delay block has no `delay_order` (with dt: an analog
        one), an actuator has a dead time, or, with dt, a motion is prescribed, which cannot be held

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> td.to_iosystem(td.haptic_interface(device)).input_labels
        ['R_V', 'R_D']
    """
    diagram = prepare_for_simulation(diagram, give, prescribed)
    if dt is not None:
        return _build_sampled(diagram, prescribed, delay_order, dt, step)
    diagram = with_shared_states(_approximate_delays(diagram, delay_order))
    blocks = tuple(
        replace(b, analog=False) if isinstance(b, Control) else b for b in diagram.blocks
    )
    names = private_names(replace(diagram, blocks=blocks))
    with names.in_errors():
        return _join_parts(names, tuple(names.private.get(motion, motion) for motion in prescribed))


def _build_sampled(
    diagram: Diagram, prescribed: tuple[str, ...], order: int | None, dt: float, step: float
) -> control.NonlinearIOSystem:
    for name, value in (("dt", dt), ("step", step)):
        if not 0 < value < float("inf"):
            raise ModelError(f"to_iosystem: {name}: found {value:g} s, expected more than 0")
    if prescribed:
        raise ModelError(
            f"to_iosystem: {prescribed[0]} cannot be prescribed with dt: a motion that is held "
            "over a step has no velocity; leave dt away"
        )
    return sampled_iosystem(_approximate_delays(diagram, order, analog_alone=True), dt, step)


def _approximate_delays(
    diagram: Diagram, order: int | None, *, analog_alone: bool = False
) -> Diagram:
    """The diagram with a Pade approximation of this order in place of each delay block.

    analog_alone: delays of the computer stay, because it keeps samples
    raises ModelError: a dead time without an order of at least 1
    """
    from ..base import python_control as control

    for part in diagram.controls:
        if analog_alone and not part.analog:
            continue
        assert isinstance(part.controller, Controller)
        stages: list[Stage] = []
        for stage in part.controller.stages:
            time = stage.value_of("dead_time")
            if time is None:
                stages.append(stage)
                continue
            if order is None or order < 1:
                raise ModelError(
                    f"{diagram.name}: {part.name}: python-control holds no dead time: "
                    "delay_order=4 puts a Pade approximation in its place, `simulate` is exact"
                )
            stages += from_control(control.tf(*control.pade(time, order)), name="pade").stages
        if stages != list(part.controller.stages):
            diagram = diagram.with_block(part.name, Controller(tuple(stages)))
    return diagram


def _join_parts(names: PrivateNames, prescribed: tuple[str, ...]) -> control.InterconnectedSystem:
    """The parts of the diagram, built on private names, connected by the user's names."""
    from ..base import python_control as control

    diagram = names.diagram
    parts = build_equations(_replace_code_by_wires(diagram), prescribed=prescribed)
    if parts.late:
        raise ModelError(
            f"{diagram.name}: actuation_delay has no python-control form: use `simulate` instead"
        )
    values = diagram.values
    numbers = SymbolValues(
        {s: (names.public_name(n), values[n]) for s, n in parts.parameters.items()}, {}
    )
    every: tuple[Junction | Kinematics, ...] = (*diagram.kinematics, *diagram.junctions)
    static = [p for p in every if p.output in parts.computer.signals]
    # python-control has no system without inputs: constant sums are outputs of the mechanics
    idle = {signal(p.output): float(sum_inputs(p, signal)) for p in static if not p.inputs}
    numbers.fixed.update(idle)
    systems = [_mechanics(parts, numbers, idle, names)]
    for part in diagram.controls:
        systems.append(_controller(part, numbers, names))
    systems += [_static(p, names) for p in static if p.inputs]
    driven = {f"{m}{end}" for m in parts.prescribed for end in ("", "_velocity", "_acceleration")}
    outside = [s for s in diagram.outside if s not in parts.signals]
    outside_names = names.public_names(*outside, *sorted(driven))
    read = {s for system in systems for s in system.input_labels}
    made = [s for system in systems for s in system.output_labels]
    labels = [*parts.inputs, *parts.signals, *parts.computer.signals, *parts.rates]
    names.public_names(*map(str, labels))
    return control.interconnect(
        systems,
        inputs=[s for s in outside_names if s in read],
        outputs=made,
        name=names.public_name(diagram.name).replace(" ", "_"),
        params=dict(numbers.parameters.values()),
    )


def _mechanics(
    parts: Equations,
    numbers: SymbolValues,
    idle: Mapping[sp.Symbol, float],
    names: PrivateNames,
) -> Any:
    moved = [s for m in parts.motions for s in (signal(m), velocity(m))]
    inputs = [s for s in (*parts.inputs, *parts.commands.values()) if s not in idle]
    states = sorted(parts.rates, key=lambda state: names.public_name(str(state)))
    # a signal that the system takes and returns under one name would be wired to itself
    outputs = {str(s): s for s in moved} | {n: e for n, e in parts.signals.items()}
    outputs |= {str(s): s for s in idle}
    rates = [parts.rates[s] for s in states]
    return _nlsys(
        MECHANICS, states, inputs, rates, outputs, names, numbers=numbers, joined=parts.joined
    )


def _replace_code_by_wires(diagram: Diagram) -> Diagram:
    """The diagram with a wire in place of each system known as code; the mechanics are the same."""
    for part in diagram.controls:
        if _code(part) is not None:
            diagram = diagram.with_block(part.name, Controller(()))
    return diagram


def _code(part: Control) -> Any:
    """The continuous-time system that a controller consists of; None where it is a law."""
    assert isinstance(part.controller, Controller)
    stages = part.controller.stages
    system = stages[0].law.system if len(stages) == 1 and not part.others else None
    return None if system is None or system.isdtime(strict=True) else system


def _controller(part: Control, numbers: SymbolValues, names: PrivateNames) -> Any:
    if (system := _code(part)) is not None:
        return _rename_signals(system, part, names)
    assert isinstance(part.controller, Controller)
    v = motion_of(names.diagram, part.motion)[1] if part.motion else sp.S(0)
    signals = {"input": signal(part.input), "velocity": v, "speed": sp.Abs(v), "travel_rate": v}
    others = tuple(map(signal, part.others))
    signals |= {"period": sp.S(0)} | ({"command": others[0]} if others else {})
    equation = part.controller.equation(part.name, signals, others=others, code=True)
    states = sorted(equation.rates, key=str)
    rates = [equation.rates[s] for s in states]
    used = set().union(*(e.free_symbols for e in (equation.output, *rates)))
    inputs = sorted(
        used - set(states) - set(numbers.parameters) - set(numbers.fixed) - {TIME}, key=str
    )
    outputs = {part.output: equation.output}
    return _nlsys(
        names.public_name(part.name), states, inputs, rates, outputs, names, numbers=numbers
    )


def _static(part: Junction | Kinematics, names: PrivateNames) -> Any:
    """A system without states: a sum or a position."""
    inputs = [signal(s) for s in part.inputs]
    value = sum_inputs(part, signal)
    name = f"sum_{names.public_name(part.output)}"
    return _nlsys(name, [], inputs, [], {part.output: value}, names, numbers=SymbolValues({}, {}))


def _rename_signals(system: Any, part: Control, names: PrivateNames) -> Any:
    """A python-control system with the block's name and signals."""
    from ..base import python_control as control

    return control.nlsys(
        (lambda t, x, u, params: system.dynamics(t, x, u)) if system.nstates else None,
        lambda t, x, u, params: system.output(t, x, u),
        inputs=[names.public_name(part.input)],
        outputs=[names.public_name(part.output)],
        states=list(system.state_labels) or None,
        name=names.public_name(part.name),
    )


def _nlsys(
    name: str,
    states: Sequence[sp.Symbol],
    inputs: Sequence[sp.Symbol],
    rates: Sequence[sp.Expr],
    outputs: dict[str, sp.Expr],
    names: PrivateNames,
    *,
    numbers: SymbolValues,
    joined: Mapping[sp.Symbol, sp.Expr] = MappingProxyType({}),
) -> Any:
    from ..base import python_control as control

    def function(expressions: Sequence[sp.Expr]) -> Callable[..., Any]:
        printed = [sp.sympify(e, strict=True).subs(numbers.fixed) for e in expressions]
        needed = needed_steps(expressions, joined)
        steps = [(s, e.subs(numbers.fixed)) for s, e in needed.items()]

        def shared(results: list[sp.Expr]) -> tuple[list[Any], list[sp.Expr]]:
            common, out = sp.cse(results)
            return [*steps, *common], out

        used = set().union(*(e.free_symbols for e in (*printed, *(e for _, e in steps))))
        symbols = [s for s in numbers.parameters if s in used]
        defaults = [numbers.parameters[s] for s in symbols]
        arguments = [TIME, list(states), list(inputs), symbols]
        call = sp.lambdify(arguments, printed, "math", cse=shared)

        def values(
            t: float, x: np.ndarray, u: np.ndarray, params: Mapping[str, float]
        ) -> np.ndarray:
            return np.array(call(t, x, u, [params.get(n, v) for n, v in defaults]), dtype=float)

        # the law of a contact is also evaluated without contact
        one_sided = any(e.has(sp.Piecewise) for e in (*printed, *(e for _, e in steps)))
        return np.errstate(all="ignore")(values) if one_sided else values

    return control.nlsys(
        function(rates) if states else None,
        function(list(outputs.values())),
        inputs=[names.public_name(str(s)) for s in inputs],
        outputs=[names.public_name(s) for s in outputs],
        states=[names.public_name(str(s)) for s in states] or None,
        params=dict(numbers.parameters.values()),
        name=name,
    )
