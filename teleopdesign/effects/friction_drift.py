"""Friction drift: the level changes slowly as the device warms up.

    level = F_C (1 - d (1 - exp(-t / tau))),   t from the start of each record, which starts cold

Grease and seals. What other effects add to the level stays as it is. Records shorter than tau show
only a trend, from which d and tau cannot both be known.
"""

from sympy import exp

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return 1 - p.fraction * (1 - exp(-now.time / p.time_constant))


def plausible(p, facts):
    cycle = 2 * facts.stroke
    if cycle == float("inf") or p.time_constant >= cycle:
        return None
    return (
        f"a time constant of {p.time_constant:.3g} s is shorter than one cycle of the motion, "
        f"{cycle:.3g} s: so fast a warm-up is not distinguished from the motion; it "
        "stands for how the records begin"
    )


def untold(p, facts):
    if p.time_constant <= facts.duration:
        return None
    rate = p.fraction / p.time_constant
    return (
        f"warming up in {p.time_constant:.3g} s outlasts the records, {facts.duration:.3g} s: only "
        f"the rate d / tau = {rate:.3g} 1/s at which the level changes is known"
    )


EFFECT = Effect(
    role="friction_factor",
    energy="dissipates",
    law=law,
    parameters={
        "fraction": Parameter(
            "dimensionless", "d: part of the cold level that is lost", lower=-1.0, upper=1.0
        ),
        "time_constant": Parameter(
            "time", "tau: of warming up", search=FitSearch(starts=(0.2, 1.0), scale="duration")
        ),
    },
    absent={"fraction": 0.0},
    plausible=plausible,
    untold=untold,
    needs=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="first-order warm-up of a lubricant",
)
