"""A controller as difference equations in a C header: the same law in simulation and robot.

The steps are those of the simulation's computer. Over a sample, a state is integrated exactly by
its rate, with all other signals held, or its law states the next value. A delayed signal is kept in
a ring buffer of samples. Double precision, no memory but the struct, C99.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import sympy as sp
from sympy.printing.c import C99CodePrinter

from ..base.errors import ModelError
from ..controllers import SIGNALS, Controller, parameter_symbol, require_exact_steps
from .signal_symbols import LateSignals, delay_in_samples, without_delays
from .simulated import without_no_delay

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_COMMAND = "the force commanded without this law"
_TEXT = """/* {title}
 * Period {period!r} s. Call {name}_start once, then {name}_step once each sample, which returns the
 * output. input: signal of the block;  velocity: of its motion, as the computer estimates it;
 * travel_rate: travel of the last sample over the period. SI units.
 */
#ifndef {guard}
#define {guard}

#include <math.h>

typedef struct {{
{fields}
}} {name}_state;

static inline void {name}_start({name}_state *s) {{
{zeros}
}}

/* (exp(z) - 1)/z, accurate through zero */
static inline double {name}_phi(double z) {{
    return fabs(z) < 1e-12 ? 1.0 + z / 2.0 : expm1(z) / z;
}}

static inline double {name}_step(
    {name}_state *s, double input, double velocity, double travel_rate{command}) {{
    const double speed = fabs(velocity);
    const double T = {period!r};
    (void)s, (void)input, (void)velocity, (void)travel_rate, (void)speed, (void)T;
{body}
}}

#endif
"""


@dataclass(frozen=True)
class _Ring:
    """A ring buffer of a delayed signal;  kept: the signal;  samples: its delay in samples."""

    number: int
    kept: sp.Expr
    samples: float

    @property
    def size(self) -> int:
        # the sample so many whole periods ago, the one before it, between which a part of a period
        # is interpolated, and the one that is written now
        return int(self.samples) + 2

    def field(self) -> str:
        return f"    double d{self.number}[{self.size}]; int at{self.number}; /* what is late */"

    def zeros(self) -> str:
        i = self.number
        return f"    s->at{i} = 0;\n    for (int k = 0; k < {self.size}; k++) s->d{i}[k] = 0.0;"

    def recall(self) -> str:
        i, whole = self.number, int(self.samples)
        part = self.samples - whole
        ends = (f"s->d{i}[(s->at{i} + {self.size - n}) % {self.size}]" for n in (whole, whole + 1))
        first, second = ends
        return f"    const double late{i} = {1.0 - part!r} * {first} + {part!r} * {second};"

    def retain(self, code: str) -> str:
        i = self.number
        return f"    s->d{i}[s->at{i}] = {code};\n    s->at{i} = (s->at{i} + 1) % {self.size};"


class _Code(C99CodePrinter):
    """C code with the fewest digits that give each number again: 0.4, not 0.40000000000000002."""

    def _print_Float(self, expr: sp.Float) -> str:
        return repr(float(expr))


def as_c_header(controller: Controller, *, period: float, name: str = "controller") -> str:
    """The controller's difference equations in a computer of that period, as text of a C header.

    period: s;  name: begins every name in it: lower case letters, digits, underscores
    Values are constants of the text. States start at zero, as in the simulation.
    raises ModelError: the name is invalid, the period is not positive, a law is known as code only,
        or a dead time is below the period
    """
    if not _NAME.fullmatch(name):
        raise ModelError(f'as_c_header: name: found "{name}", expected such as "observer_2"')
    if not 0 < period < float("inf"):
        raise ModelError(f"as_c_header: period: expected a time > 0 s, found {period:g}")
    made = without_no_delay(controller).sampled(period)
    require_exact_steps(made.stages)
    signals = {n: SIGNALS[n] for n in SIGNALS} | {"period": sp.Float(period)}
    late: LateSignals = {}
    equation = without_delays(made.equation("law", signals), "law", late)
    values = {parameter_symbol("law", n): sp.Float(v) for n, v in made.names().items()}
    states = sorted({*equation.rates, *equation.steps}, key=str)
    fields = {x: sp.Symbol(f"s->x{i}") for i, x in enumerate(states)}
    fields |= {x: sp.Symbol(f"late{i}") for i, x in enumerate(late)}
    rings = [
        _Ring(i, code_of, delay_in_samples(float(delay.subs(values)), period, what="as_c_header"))
        for i, (code_of, delay) in enumerate(late.values())
    ]

    def code(expression: sp.Expr) -> str:
        numbers = sp.sympify(expression).subs(values).xreplace({sp.pi: sp.Float(math.pi)})
        return str(_Code().doprint(numbers.xreplace(fields)))

    def stepped(group: list[sp.Symbol]) -> list[str]:
        lines = []
        for i, x in enumerate(states):
            if x not in group:
                continue
            if x in equation.steps:
                lines.append(f"    const double n{i} = {code(equation.steps[x])};")
                continue
            rate = equation.rates[x]  # stepped exactly: its inputs are held over the period
            slope, rest = code(sp.diff(rate, x)), code(rate.xreplace({x: sp.S(0)}))
            exact = f"exp(a{i} * T) * s->x{i} + T * {name}_phi(a{i} * T) * ({rest})"
            lines += [f"    const double a{i} = {slope};", f"    const double n{i} = {exact};"]
        return lines + [f"    s->x{i} = n{i};" for i, x in enumerate(states) if x in group]

    ahead = [x for x in states if x in equation.before]
    later = [x for x in states if x not in equation.before]
    body = [*(ring.recall() for ring in rings), *stepped(ahead)]
    body += [f"    const double output = {code(equation.output)};"]
    body += [*(ring.retain(code(ring.kept)) for ring in rings), *stepped(later)]
    rows = [f"    double x{i}; /* {x} */" for i, x in enumerate(states)]
    zeros = [f"    s->x{i} = 0.0;" for i in range(len(states))] + [r.zeros() for r in rings]
    return _TEXT.format(
        title=re.sub(r"[^ -~]|\*/", " ", repr(controller)),
        period=period,
        name=name,
        command=f", double command /* {_COMMAND} */" * made.reads_command,
        guard=f"{name.upper()}_H",
        fields="\n".join([*rows, *(r.field() for r in rings)] or ["    char none; /* no state */"]),
        zeros="\n".join(zeros or ["    s->none = 0;"]),
        body="\n".join([*body, "    return output;"]),
    )
