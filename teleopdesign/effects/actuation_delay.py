"""Actuation delay: the commanded force acts a fixed time later.

    acting force(t) = command(t - tau)

Causes are computation, buses and drives. Commands with content above 1/tau distinguish a delay from
`actuator_lag`. Below 1/tau both are a phase in proportion to frequency.
"""

from ._effect import Effect, FitSearch, Parameter, delayed


def law(now, p):
    return delayed(now.command, p.delay)


def undetermined(p, facts):
    return (
        f"a position that is logged {1e3 * p.delay:.3g} ms later than the forces looks the same: "
        "check the clocks of the log"
    )


EFFECT = Effect(
    role="actuation",
    energy="supplies",
    law=law,
    linear=True,
    parameters={
        "delay": Parameter(
            "time",
            "tau: time from command to force",
            upper=0.2,
            search=FitSearch(starts=(0.05, 0.5, 2.0)),
        )
    },
    absent={"delay": 0.0},
    undetermined=undetermined,
    source="dead time in the sense of any control text",
)
