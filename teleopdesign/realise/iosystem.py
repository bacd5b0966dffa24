"""A diagram as a nonlinear python-control system: interchange and reference.

Controllers act in continuous time: python-control cannot mix sampled and continuous blocks. With
its computer the diagram is a system in discrete time (`sampled_iosystem.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..controllers import Controller, Stage, from_control
from ..diagrams import Diagram, with_shared_states
from .equations import build_equations
from .laws import needed_steps
from .private_names import PrivateNames, private_names
from .sampled_iosystem import sampled_iosystem
from .signal_symbols import TIME, signal, velocity
from .simulated import prepare_for_simulation

if TYPE_CHECKING:
    import control


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
    """
    diagram = prepare_for_simulation(diagram, give, prescribed)
    if dt is not None:
        return _build_sampled(diagram, prescribed, delay_order, dt, step)
    names = private_names(with_shared_states(_approximate_delays(diagram, delay_order)))
    with names.in_errors():
        return _one_system(names, tuple(names.private.get(motion, motion) for motion in prescribed))


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


def _one_system(names: PrivateNames, prescribed: tuple[str, ...]) -> control.NonlinearIOSystem:
    """The system of a diagram with private names, with the user's names of its signals."""
    from ..base import python_control as control

    diagram = names.diagram
    parts = build_equations(diagram, prescribed=prescribed, sampled=False)
    if parts.late:
        raise ModelError(
            f"{diagram.name}: actuation_delay has no python-control form: use `simulate` instead"
        )
    states = sorted(parts.rates, key=lambda state: names.public_name(str(state)))
    moved = [s for m in parts.motions for s in (signal(m), velocity(m))]
    outputs = {str(s): s for s in moved} | dict(parts.signals)
    rates, results = [parts.rates[s] for s in states], list(outputs.values())
    values = diagram.values
    defaults = {s: (names.public_name(n), values[n]) for s, n in parts.parameters.items()}
    every = (*rates, *results, *parts.joined.values())
    read = set().union(*(sp.sympify(e).free_symbols for e in every))
    inputs = [s for s in parts.inputs if s in read]
    labels = names.public_names(*map(str, (*inputs, *states)), *outputs)
    arguments = _Arguments(states, inputs, defaults, parts.joined)
    return control.nlsys(
        arguments.function(rates) if states else None,
        arguments.function(results),
        inputs=list(labels[: len(inputs)]),
        outputs=[names.public_name(n) for n in outputs],
        states=[names.public_name(str(s)) for s in states] or None,
        params=dict(defaults.values()),
        name=names.public_name(diagram.name).replace(" ", "_"),
    )


@dataclass(frozen=True)
class _Arguments:
    """What the functions of a system of python-control take.

    parameters: symbol -> its name in `params`, and its value;  joined: named steps of the equations
    """

    states: Sequence[sp.Symbol]
    inputs: Sequence[sp.Symbol]
    parameters: Mapping[sp.Symbol, tuple[str, float]]
    joined: Mapping[sp.Symbol, sp.Expr]

    def function(self, expressions: Sequence[sp.Expr]) -> Callable[..., np.ndarray]:
        """The expressions as a function (t, x, u, params), as python-control calls it."""
        printed = [sp.sympify(e, strict=True) for e in expressions]
        steps = list(needed_steps(printed, self.joined).items())

        def shared(results: list[sp.Expr]) -> tuple[list[Any], list[sp.Expr]]:
            common, out = sp.cse(results)
            return [*steps, *common], out

        whole = (*printed, *(e for _, e in steps))
        used = set().union(*(e.free_symbols for e in whole))
        symbols = [s for s in self.parameters if s in used]
        defaults = [self.parameters[s] for s in symbols]
        arguments = [TIME, list(self.states), list(self.inputs), symbols]
        call = sp.lambdify(arguments, printed, "math", cse=shared)

        def values(
            t: float, x: np.ndarray, u: np.ndarray, params: Mapping[str, float]
        ) -> np.ndarray:
            return np.array(call(t, x, u, [params.get(n, v) for n, v in defaults]), dtype=float)

        # the law of a contact is also evaluated without contact
        one_sided = any(e.has(sp.Piecewise) for e in whole)
        return np.errstate(all="ignore")(values) if one_sided else values
