"""Friction drift: the level changes slowly as the device warms up.

    level = F_C (1 - d (1 - exp(-t / tau))),   t from the first row of each log, which starts cold

Causes are grease and seals. Only F_C drifts. Records shorter than tau show no more than a trend.
"""

from sympy import exp

from ._effect import Effect, FitSearch, Parameter

#: part of friction that no warm-up removes. Lower: refuses true drifts; higher: names false ones
ALL = 0.95


def law(now, p):
    return 1 - p.fraction * (1 - exp(-now.time / p.time_constant))


def plausible(p, facts):
    if p.fraction >= ALL and p.time_constant <= facts.duration:
        return "nearly all friction would be lost: friction falls with another quantity than time"
    if p.time_constant >= (cycle := 2 * facts.stroke) or cycle == float("inf"):
        return None
    return (
        f"a time constant of {p.time_constant:.3g} s is shorter than one cycle of the motion, "
        f"{cycle:.3g} s: the records do not distinguish so fast a warm-up from the "
        "motion; the effect imitates the beginning of the records"
    )


def undetermined(p, facts):
    if p.time_constant <= facts.duration:
        return None
    return (
        f"a warm-up of {p.time_constant:.3g} s outlasts the records, {facts.duration:.3g} s: only "
        f"the rate d / tau = {p.fraction / p.time_constant:.3g} 1/s of the level's change is known"
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
            "time", "tau: of the warm-up", search=FitSearch(starts=(0.2, 1.0), scale="duration")
        ),
    },
    absent={"fraction": 0.0},
    plausible=plausible,
    undetermined=undetermined,
    needs=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="first-order warm-up of a lubricant",
)
