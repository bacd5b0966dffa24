"""Free force: any force of the position, where no named law describes it.

    F = S(x),   S: cubic spline through value_1 ... value_8, constant beyond both ends

The values belong to places at equal distances from x_1 to x_8. A fit takes the ends of the recorded
travel for these two; they belong to the law and are never estimated. With eight values the curve
follows most forces that vary slowly along the travel. It explains nothing: it has no named law, so
a diagnosis never tries it. It serves to go on working where no effect of the catalogue fits.
"""

from sympy import Matrix, Max, Min, Rational

from ._effect import Effect, FitSearch, Parameter

COUNT = 8
#: m or rad: a range far below any travel, which keeps the law defined where no range is stated
NO_RANGE = 1e-9
VALUES = tuple(f"value_{i + 1}" for i in range(COUNT))


def cubes(place):
    """Functions of a spline over 0 to 7 without a bend at the second and the last but one place."""
    inside = Max(0, Min(COUNT - 1, place))
    bends = (Max(0, Min(COUNT - 1 - k, place - k)) ** 3 for k in range(2, COUNT - 2))
    return [1, inside, inside**2, inside**3, *bends]


def law(now, p):
    place = (COUNT - 1) * (now.position - p.lower) / Max(p.upper - p.lower, NO_RANGE)
    values = Matrix([getattr(p, name) for name in VALUES])
    factors = Matrix([cubes(Rational(i)) for i in range(COUNT)]).inv() * values
    return factors.dot(cubes(place))


def end(meaning, scale):
    search = FitSearch(starts=(1.0,), scale=scale, chosen=True, held=True)
    return Parameter("position", meaning, -float("inf"), optional=True, search=search)


def value(number):
    search = FitSearch(starts=(0.0,))
    return Parameter("force", f"force at x_{number}", -float("inf"), search=search)


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        **{name: value(name[-1]) for name in VALUES},
        "lower": end("x_1: place of the first value", "lowest_position"),
        "upper": end("x_8: place of the last value", "highest_position"),
    },
    absent=dict.fromkeys(VALUES, 0.0),
    free=True,
    source="interpolating cubic spline, not-a-knot ends",
)
