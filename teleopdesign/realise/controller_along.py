"""A controller along recorded signals: its output at each row, as the computer would have made it.

It is a computer of the simulation (`computer.py`) whose signals are records in place of sensors:
the equations become the same source, and the same functions of the loop step it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..controllers import ControlLaw, Controller, Stage, parameter_symbol
from ..measurement.filtering import Array
from .computer import ComputerEquations
from .equations import Equations
from .kernel import first_memory
from .program import Program, write_program
from .signal_symbols import PERIOD, LateSignals, delay_in_samples, signal, without_delays
from .simulated import without_no_delay

_RECORDED = ("input", "velocity", "travel_rate", "command")


def controller_along(
    controller: Controller,
    *,
    input: Array,
    velocity: Array,
    travel_rate: Array,
    period: float,
    command: Array | None = None,
) -> Array:
    """Output of a controller at the rows of its recorded signals, all states zero at first.

    input: of the block, SI;  velocity, travel_rate: of its motion, as the computer knows them, m/s
        or rad/s;  period: of the computer and of the rows, s
    command: force commanded without this controller, N or N m, for a law that reads it; None: 0
    returns: (n,), in the unit of the output
    raises ModelError: a law is known as code only, or only in continuous time
    """
    stages = without_no_delay(controller).sampled(period).stages
    made = _program(tuple((stage.name, stage.law) for stage in stages))
    values = {f"{s.name}.{n}": float(v) for s in stages for n, v in s.values.items()}
    at = {symbol: values[name] for symbol, name in made.equations.parameters.items()}
    late = [
        delay_in_samples(float(delay.subs(at)), period, what="controller")
        for delay in made.equations.delays
    ]
    parameters = np.array([values[name] for name in made.layout.parameters])
    beside = np.zeros_like(velocity) if command is None else command
    slots = int(max(late, default=0.0)) + 2
    out = np.empty(len(velocity))
    made.loop.follow(
        float(period),
        np.ascontiguousarray([input, velocity, travel_rate, beside], dtype=float),
        np.array(late, dtype=float),
        np.zeros(slots * len(late)),
        slots,
        first_memory(made, 1, parameters, {}),
        out,
    )
    return out


@lru_cache(maxsize=64)
def _program(laws: tuple[tuple[str, ControlLaw], ...]) -> Program:
    """The loop of a computer with these laws, (name, law) of each stage, one after the other."""
    stages = tuple(Stage(law, _any_values(law), name) for name, law in laws)
    late: LateSignals = {}
    signals = {name: signal(name) for name in _RECORDED}
    signals |= {"speed": abs(signals["velocity"]), "period": PERIOD}
    law = without_delays(Controller(stages).equation("law", signals), "law", late)
    computer = ComputerEquations(law.rates, law.steps, law.before, {"output": law.output}, late)
    names = {f"{name}.{n}" for name, law in laws for n in law.parameters}
    return write_program(
        Equations(
            rates={},
            signals={},
            inputs=(),
            commands={"output": signal("output")},
            late={},
            computer=computer,
            sampled_inputs=_RECORDED,
            motions=(),
            prescribed=(),
            parameters={parameter_symbol("law", name): name for name in names},
            joined={},
        )
    )


def _any_values(law: ControlLaw) -> dict[str, float]:
    """Values within the bounds: the equation holds parameters as symbols."""
    return {n: min(max(1.0, p.lower), p.upper) for n, p in law.parameters.items()}
