"""A diagram as a nonlinear python-control system: interchange and reference.

Its laws are those of the simulation with controllers in continuous time, as plain Python; their
integration is python-control's, which cannot mix sampled and continuous blocks. With its computer
the diagram is a system in discrete time (`sampled_iosystem.py`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..controllers import Controller, Stage, from_control
from ..diagrams import Diagram, with_shared_states
from .kernel import first_memory
from .program import Program, program
from .sampled_iosystem import sampled_iosystem
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

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> td.to_iosystem(td.haptic_interface(device)).input_labels
        ['R_V', 'R_D']
    """
    diagram = prepare_for_simulation(diagram, give, prescribed)
    if dt is not None:
        return _build_sampled(diagram, prescribed, delay_order, dt, step)
    return _build_continuous(
        with_shared_states(_approximate_delays(diagram, delay_order)), prescribed
    )


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


def _build_continuous(diagram: Diagram, prescribed: tuple[str, ...]) -> control.NonlinearIOSystem:
    from ..base import python_control as control

    made = program(diagram, prescribed=prescribed, sampled=False, jit=False)
    layout = made.layout
    if layout.late:
        raise ModelError(
            f"{diagram.name}: actuation_delay has no python-control form: use `simulate` instead"
        )
    values = diagram.values
    driven = sorted(set(layout.inputs) - set(diagram.outside))
    inputs = [name for name in (*diagram.outside, *driven) if name in layout.inputs]
    laws = _Laws(made, np.array([inputs.index(name) for name in layout.inputs], dtype=int))
    outputs = [name for name in layout.columns if name not in inputs]
    shown = [i for i, name in enumerate(layout.columns) if name in outputs]
    return control.nlsys(
        laws.rates if layout.states else None,
        lambda t, x, u, params: laws.columns(t, x, u, params)[shown],
        inputs=inputs,
        outputs=outputs,
        states=list(layout.states) or None,
        params={name: values[name] for name in made.equations.parameters.values()},
        name=diagram.name.replace(" ", "_"),
    )


@dataclass(frozen=True)
class _Laws:
    """The laws of a program in continuous time, with the arguments of python-control.

    order: place of each input of the program among those of the system
    """

    made: Program
    order: np.ndarray

    def rates(self, *now: Any) -> np.ndarray:
        """Rates of the states."""
        at, first = self.made.functions, self.made.functions["RATES_0"]
        memory = self._evaluate("rates", (first, at["RESTS_0"]), *now)
        return memory[first : first + len(self.made.layout.states)]

    def columns(self, *now: Any) -> np.ndarray:
        """Columns of the layout."""
        at, first = self.made.functions, self.made.functions["COLUMNS"]
        memory = self._evaluate("signals", (at["NOW"],), *now)
        at["record"](now[2][self.order], memory, first, 0)
        return memory[first : first + len(self.made.layout.columns)]

    def _evaluate(
        self,
        law: str,
        to: tuple[int, ...],
        t: float,
        x: np.ndarray,
        u: np.ndarray,
        params: Mapping[str, float],
    ) -> np.ndarray:
        """The memory after a law has written its results;  to: first rows of these."""
        at = self.made.functions
        parameters = np.array([params[name] for name in self.made.layout.parameters], dtype=float)
        memory = first_memory(self.made, 1, parameters, {})
        memory[: len(x)] = x  # the first rows
        with np.errstate(all="ignore"):  # the law of a contact is also evaluated without contact
            at["find_inverses"](memory, 0)
            place = (t, at["STATES"], at["BRISTLES"], u[self.order], at["LATE"])
            at[law](*place, memory, *to, 0)
        return memory
