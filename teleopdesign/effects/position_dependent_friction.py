"""Position-dependent friction: the level varies along the travel.

    level = F_C (1 + e sin(2 pi x / p + phi))

Causes are bent rails, eccentric gears and uneven preload. With a period longer than the travel the
variation is a slope. The force changes sign with the direction of motion, unlike `cogging` and
`spring`. Levels of other effects do not vary with this one.
"""

from dataclasses import replace

import numpy as np
from sympy import pi, sin

from ._effect import PERIOD, Effect, FitSearch, Parameter, positive_amplitude
from ._facts import follows_gravity, period_is_visible, speeds_vary_by_place


def law(now, p):
    return 1 + p.amplitude * sin(2 * pi * now.position / p.period + p.phase)


def along(p):
    return lambda x: np.sin(2 * np.pi * x / (p.period or np.inf) + p.phase)


def plausible(p, facts):
    return speeds_vary_by_place(along(p), facts) or period_is_visible(p.period, facts)


EFFECT = Effect(
    role="friction_factor",
    energy="dissipates",
    law=law,
    parameters={
        "amplitude": Parameter(
            "dimensionless",
            "e: half of the range of the level, over its mean",
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
    undetermined=lambda p, facts: follows_gravity(along(p), facts),
    needs=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
