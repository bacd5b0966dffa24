"""Cogging harmonic: a second period of the force that repeats along the travel.

    F = A_2 sin(2 pi x / p_2 + phi_2), beside `cogging`

The cogging of a motor is seldom one sine. The poles give one wave, slots and poles together give
another wave, and each wave has harmonics. The largest wave is `cogging`, the next largest is
`cogging_harmonic`.
"""

from dataclasses import replace

from ._effect import PERIOD, Effect, FitSearch, Parameter, positive_amplitude
from ._facts import repeats_within_travel
from .cogging import law

#: twice as many starts as `cogging` has, so that half of its shortest period is also searched
STARTS = tuple(4.0 / 3.0 / k for k in range(1, 2 * len(PERIOD.search.starts) + 1))
EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        "amplitude": Parameter(
            "force", "A_2: amplitude", lower=-float("inf"), search=FitSearch(starts=(0.03,))
        ),
        "period": replace(PERIOD, search=replace(PERIOD.search, starts=STARTS)),
        "phase": Parameter(
            "angle", "phi_2: phase at x = 0", lower=-float("inf"), search=FitSearch(starts=(0.0,))
        ),
    },
    absent={"amplitude": 0.0},
    canonical=positive_amplitude,
    plausible=repeats_within_travel,
    needs=frozenset({"cogging"}),
    source="periodic detent force of a slotted machine, further harmonic",
)
