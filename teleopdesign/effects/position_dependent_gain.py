"""Position-dependent gain: the force per command falls to both sides of a position.

    acting force = command (1 - k (x - x_0)^2)

Examples are voice coils, solenoids and torque motors of limited angle, whose coil leaves the field.
The effect looks like `hardening_spring` and `position_dependent_friction`. But without a command
this effect makes no force.
"""

from ._effect import Effect, FitSearch, Parameter
from ._facts import speeds_vary_by_place

ELSE = "the effect imitates something else that varies along the travel"


def law(now, p):
    return now.command * (1 - p.fall * (now.position - p.centre) ** 2)


def plausible(p, facts):
    if not len(facts.places):
        return None
    lowest, highest = float(facts.places.min()), float(facts.places.max())
    if not lowest <= p.centre <= highest:
        centre = facts.text(p.centre, "position")
        return (
            f"a gain that is largest at {centre} falls to one side only within the travel: {ELSE}"
        )
    if p.fall * max(p.centre - lowest, highest - p.centre) ** 2 < 1:
        return speeds_vary_by_place(lambda x: (x - p.centre) ** 2, facts)
    end = facts.text(p.fall**-0.5, "position")
    return f"the gain would be zero {end} from the centre, and negative beyond: {ELSE}"


EFFECT = Effect(
    role="actuation",
    energy="supplies",
    law=law,
    parameters={
        "fall": Parameter(
            "per_square_of_position",
            "k: part of the gain that is lost, per square of the distance from x_0",
            # of more, nothing would be left of the gain at the ends of any travel
            search=FitSearch(starts=(0.05,), within=1.0),
        ),
        "centre": Parameter(
            "position",
            "x_0: position of the largest gain",
            lower=-float("inf"),
            optional=True,
            search=FitSearch(starts=(-1.0, 0.0, 1.0)),
        ),
    },
    absent={"fall": 0.0},
    plausible=plausible,
    source="force factor Bl(x) of a moving coil; Klippel, J. Audio Eng. Soc. 54 (2006) 907",
)
