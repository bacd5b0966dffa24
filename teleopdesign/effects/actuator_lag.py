"""Actuator lag: the commanded force acts through a first-order lag.

    tau dw/dt = command - w,   acting force = w

Causes are a current loop or the inductance of a motor. Commands with content above 1/tau
distinguish a lag from `actuation_delay`: a lag also weakens these commands.
"""

from ._effect import Effect, FitSearch, Parameter, State


def law(now, p):
    return now.output


def output(now, p):
    return (now.command - now.output) / p.time_constant


EFFECT = Effect(
    role="actuation",
    energy="supplies",
    law=law,
    states={"output": State("force", output)},
    linear=True,
    parameters={
        "time_constant": Parameter(
            "time", "tau: lag", upper=0.2, search=FitSearch(starts=(0.05, 0.5, 2.0))
        )
    },
    absent={"time_constant": 0.0},
    source="first-order lag in the sense of any control text",
)
