"""A controller along recorded signals: its output at each row, as the computer would have made it.

The steps are those of the simulation's computer: over a sample, a state is integrated exactly by
its rate with all other signals held, or its law states the next value; a state that uses the travel
rate is stepped ahead of the output. A delayed signal is read from its rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..controllers import SIGNALS, ControlLaw, Controller, Stage, parameter_symbol
from ..measurement.filtering import Array
from .compiled import PHI, compile_source, head
from .laws import assignments, indent
from .signal_symbols import LateSignals, delay_in_samples, without_delays
from .simulated import without_no_delay

_PERIOD = SIGNALS["period"]
_ROWS = ("input", "velocity", "travel_rate", "command")


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
    made = without_no_delay(controller).sampled(period)
    laws = tuple((stage.name, stage.law) for stage in made.stages)
    source, names, delays = _source(laws)
    values = {
        f"{stage.name}.{n}": float(v) for stage in made.stages for n, v in stage.values.items()
    }
    at = {parameter_symbol("law", n): v for n, v in values.items()}
    late = np.array(
        [delay_in_samples(float(d.subs(at)), period, what="controller") for d in delays],
        dtype=float,
    )
    beside = np.zeros_like(velocity) if command is None else command
    known = np.ascontiguousarray([input, velocity, travel_rate, beside], dtype=float)
    out = np.empty(known.shape[1])
    past = np.zeros((len(late), known.shape[1]))
    compile_source(source, "follow")(
        known, np.array([values[n] for n in names], dtype=float), period, late, past, out
    )
    return out


@lru_cache(maxsize=64)
def _source(
    laws: tuple[tuple[str, ControlLaw], ...],
) -> tuple[str, tuple[str, ...], tuple[sp.Expr, ...]]:
    """Source of the loop over rows, the order of its parameters, and the delays of late signals.

    laws: (name, law) of each stage
    """
    stages = tuple(Stage(law, _any_values(law), name) for name, law in laws)
    late: LateSignals = {}
    equation = without_delays(Controller(stages).equation("law", SIGNALS), "law", late)
    names = tuple(f"{name}.{n}" for name, law in laws for n in law.parameters)
    states = sorted({*equation.rates, *equation.steps}, key=str)
    known = {SIGNALS[n]: f"u_{i}" for i, n in enumerate(_ROWS)} | {SIGNALS["speed"]: "speed"}
    known |= {x: f"x_{i}" for i, x in enumerate(states)} | {_PERIOD: "period"}
    known |= {parameter_symbol("law", n): f"p_{i}" for i, n in enumerate(names)}
    known |= {x: f"late_{i}" for i, x in enumerate(late)}

    def stepped(group: Sequence[sp.Symbol]) -> list[str]:
        lines = []
        for x in group:
            i = states.index(x)
            if x in equation.steps:
                lines += assignments({f"n_{i}": equation.steps[x]}, known)
                continue
            rate = equation.rates[x]
            slope, rest = sp.diff(rate, x), rate.xreplace({x: sp.S(0)})
            if sp.diff(slope, x) != 0:
                raise ModelError(f"{x}: the rate of this state is not affine in it")
            lines += assignments({"slope": slope, "rest": rest}, known)
            lines += ["e, phi_1, _, _ = phi(slope * period)"]
            lines += [f"n_{i} = e * x_{i} + period * phi_1 * rest"]
        return lines + [f"x_{states.index(x)} = n_{states.index(x)}" for x in group]

    body = [f"u_{i} = known[{i}, k]" for i in range(len(_ROWS))] + ["speed = abs(u_1)"]
    body += [f"late_{i} = recall(past[{i}], k, late[{i}])" for i in range(len(late))]
    body += stepped([x for x in states if x in equation.before])
    body += assignments({"out[k]": equation.output}, known)
    kept = {f"past[{i}, k]": e for i, (e, _) in enumerate(late.values())}
    body += assignments(kept, known) + stepped([x for x in states if x not in equation.before])
    start = [f"p_{i} = parameters[{i}]" for i in range(len(names))]
    start += [f"x_{i} = 0.0" for i in range(len(states))]
    source = (
        f"{head('A controller along recorded signals.')}{PHI}{_RECALL}"
        "\n\n@jitted\ndef follow(known, parameters, period, late, past, out):\n"
        f"{indent(start, 4)}\n    for k in range(known.shape[1]):\n{indent(body, 8)}\n"
    )
    return source, names, tuple(delay for _, delay in late.values())


def _any_values(law: ControlLaw) -> dict[str, float]:
    """Values within the bounds: the equation holds parameters as symbols."""
    return {n: min(max(1.0, p.lower), p.upper) for n, p in law.parameters.items()}


_RECALL = '''

@jitted
def recall(row, k, samples):
    """The value of so many samples ago, between two samples by a straight line; zero before."""
    whole = int(samples)
    part = samples - whole
    value = (1.0 - part) * row[k - whole] if k >= whole else 0.0
    return value + (part * row[k - whole - 1] if k > whole else 0.0)
'''
