"""Position-dependent friction: the level varies along the travel.

    level = F_C (1 + e sin(2 pi x / p + phi))

Bent rails, eccentric gears, uneven preload; with a period beyond the travel, a slope. It turns
round with the direction, which tells it from `cogging` and `spring`. What other effects add to the
level stays as it is.
"""

from dataclasses import replace

import numpy as np
from sympy import pi, sin

from ._effect import PERIOD, Effect, FitSearch, Parameter, positive_amplitude
from ._facts import speeds_vary_by_place

#: correlation with the size of the gravity torque, over the places, from which the two look alike:
#: a half wave of a sine over a quarter turn to each side reaches 0.97. Lower: said of uneven rails
ALIKE = 0.9


def law(now, p):
    return 1 + p.amplitude * sin(2 * pi * now.position / p.period + p.phase)


def pattern(x, p):
    return np.sin(2 * np.pi * x / p.period + p.phase)


def plausible(p, facts):
    if p.period == 0.0:
        return None
    return speeds_vary_by_place(lambda x: pattern(x, p), facts)


def untold(p, facts):
    if "gravity.phase" not in facts.body or len(facts.places) < 3 or p.period == 0.0:
        return None
    load = np.abs(np.sin(facts.places + facts.body["gravity.phase"]))
    level = p.amplitude * pattern(facts.places, p)
    if not (np.ptp(load) > 0.0 and np.ptp(level) > 0.0):
        return None
    if not np.corrcoef(load, level)[0, 1] >= ALIKE:
        return None
    return (
        "friction is largest where the torque of gravity is: friction that grows with the load "
        "(load_dependent_friction) looks much the same. Another load on the link tells them"
    )


EFFECT = Effect(
    role="friction_factor",
    energy="dissipates",
    law=law,
    parameters={
        "amplitude": Parameter(
            "dimensionless",
            "e: half of its range over the mean",
            lower=-1.0,
            upper=1.0,
            search=FitSearch(starts=(0.05,)),
        ),
        # half a wave over the travel is a friction that grows along it
        "period": replace(
            PERIOD,
            search=replace(PERIOD.search, starts=(3.0, *PERIOD.search.starts), within=float("inf")),
        ),
        "phase": Parameter(
            "angle", "phi: phase at x = 0", lower=-float("inf"), search=FitSearch(starts=(0.0,))
        ),
    },
    absent={"amplitude": 0.0},
    canonical=positive_amplitude,
    plausible=plausible,
    untold=untold,
    needs=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
