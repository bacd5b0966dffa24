"""A controller as difference equations in a C header: what runs on a robot is what was judged.

The steps are those of the simulation's computer: a state is carried over a sample exactly for its
rate, all else held, or as its law says itself. Double precision, no memory but the struct, C99.
"""

from __future__ import annotations

import math
import re

import sympy as sp

from ..controllers import SIGNALS, Controller, parameter_symbol
from ..errors import ModelError

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_SIGNALS = ("input", "velocity", "travel_rate")
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
    {name}_state *s, double input, double velocity, double travel_rate) {{
    const double speed = fabs(velocity);
    (void)s, (void)input, (void)velocity, (void)travel_rate, (void)speed;
{body}
}}

#endif
"""


def as_c_header(controller: Controller, *, period: float, name: str = "controller") -> str:
    """The controller's difference equations in a computer of that period, as text of a C header.

    period: s;  name: begins every name in it: lower case letters, digits, underscores
    Values are constants of the text. States start at zero, as in the simulation.
    raises ModelError: a name that is none, a period that is not positive, a law known as code only
    """
    if not _NAME.fullmatch(name):
        raise ModelError(f'as_c_header: name: found "{name}", expected such as "observer_2"')
    if not 0 < period < float("inf"):
        raise ModelError(f"as_c_header: period: expected a time > 0 s, found {period:g}")
    made = controller.sampled(period)
    signals = {n: SIGNALS[n] for n in SIGNALS} | {"period": sp.Float(period)}
    equation = made.equation("law", signals)
    values = {parameter_symbol("law", n): sp.Float(v) for n, v in made.names().items()}
    states = sorted({*equation.rates, *equation.steps}, key=str)
    fields = {x: sp.Symbol(f"s->x{i}") for i, x in enumerate(states)}

    def code(expression: sp.Expr) -> str:
        numbers = sp.sympify(expression).subs(values).xreplace({sp.pi: sp.Float(math.pi)})
        return str(sp.ccode(numbers.xreplace(fields)))

    def stepped(group: list[sp.Symbol]) -> list[str]:
        lines = []
        for i, x in enumerate(states):
            if x not in group:
                continue
            if x in equation.steps:
                lines.append(f"    const double n{i} = {code(equation.steps[x])};")
                continue
            rate = equation.rates[x]
            slope, rest = code(sp.diff(rate, x)), code(rate.xreplace({x: sp.S(0)}))
            exact = f"exp(a{i} * T) * s->x{i} + T * {name}_phi(a{i} * T) * ({rest})"
            lines += [f"    const double a{i} = {slope};", f"    const double n{i} = {exact};"]
        return lines + [f"    s->x{i} = n{i};" for i, x in enumerate(states) if x in group]

    ahead = [x for x in states if x in equation.before]
    later = [x for x in states if x not in equation.before]
    body = [f"    const double T = {period!r};", "    (void)T;", *stepped(ahead)]
    body += [f"    const double output = {code(equation.output)};", *stepped(later)]
    rows = [f"    double x{i}; /* {x} */" for i, x in enumerate(states)]
    return _TEXT.format(
        title=re.sub(r"[^ -~]|\*/", " ", repr(controller)),
        period=period,
        name=name,
        guard=f"{name.upper()}_H",
        fields="\n".join(rows or ["    char none; /* no state */"]),
        zeros="\n".join(
            [f"    s->x{i} = 0.0;" for i in range(len(states))] or ["    s->none = 0;"]
        ),
        body="\n".join([*body, "    return output;"]),
    )
