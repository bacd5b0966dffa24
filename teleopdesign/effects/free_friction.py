"""Free friction: any friction level over the speed, where no named law describes it.

    level = L(abs(v)),   L: straight lines through value_1 ... value_8, constant beyond

Value k belongs to the speed v_8 ((k - 1)/7)^2: finer at low speeds, where friction changes most. A
fit takes the largest recorded speed for v_8; it belongs to the law and is never estimated. The
curve includes `coulomb`, `viscous` and `stribeck`: state it in place of these. It explains nothing:
it has no named law, so a diagnosis never tries it.
"""

from sympy import Max, Min

from ._effect import Effect, FitSearch, Parameter

COUNT = 8
#: m/s or rad/s: far below any measured speed; keeps the law defined where no range is stated
NO_RANGE = 1e-9
VALUES = tuple(f"value_{i + 1}" for i in range(COUNT))


def hat(i, speed):
    """Share of value i at a speed: 1 at its own, 0 at its neighbours'; speed: 49 at v_8."""
    rising = (speed - (i - 1) ** 2) / (2 * i - 1)
    falling = ((i + 1) ** 2 - speed) / (2 * i + 1)
    return Max(0, falling if i == 0 else Min(rising, falling if i < COUNT - 1 else 1))


def law(now, p):
    speed = (COUNT - 1) ** 2 * abs(now.velocity) / Max(p.upper, NO_RANGE)
    return sum(getattr(p, name) * hat(i, speed) for i, name in enumerate(VALUES))


STRENGTH = FitSearch(starts=(0.1,))
TOP = FitSearch(starts=(1.0,), scale="largest_velocity", chosen=True, held=True)
EFFECT = Effect(
    role="friction_level",
    energy="dissipates",
    law=law,
    parameters={
        **{n: Parameter("force", f"level at v_{n[-1]}", search=STRENGTH) for n in VALUES},
        "upper": Parameter("velocity", "v_8: speed of value 8", optional=True, search=TOP),
    },
    absent=dict.fromkeys(VALUES, 0.0),
    counts_as=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    free=True,
    source="interpolation by straight lines",
)
