"""Viscous friction that falls as the lubricant warms up, by a measured temperature.

    F = B v (exp(-b (T - T_0)) - 1) beside the B v of `viscous`,   T_0 = 293.15 K

The damping of gears and bearings with grease falls by some per cent per kelvin. The temperature is
a further channel of the record, `temperature`. Without this channel a slow change of friction is
`friction_drift`.
"""

from sympy import exp

from ._effect import Effect, FitSearch, Parameter, parameter_symbol

#: K; the damping of `viscous` is that at 20 degrees Celsius
REFERENCE = 293.15


def law(now, p):
    damping = parameter_symbol("viscous", "damping")
    change = exp(-p.coefficient * (now.temperature - REFERENCE)) - 1
    return damping * now.velocity * change


def plausible(p, facts):
    if p.coefficient >= 0.0:
        return None
    return (
        f"no lubricant has a damping that grows by {-p.coefficient:.2g} per kelvin: the effect "
        "imitates friction that grows with temperature, as from a preload of parts that expand"
    )


EFFECT = Effect(
    role="force",
    energy="supplies",
    law=law,
    parameters={
        "coefficient": Parameter(
            "temperature_coefficient",
            "b: part of the damping that is lost per kelvin",
            lower=-0.2,
            upper=0.2,
            search=FitSearch(starts=(-0.01, 0.01, 0.04)),
        )
    },
    absent={"coefficient": 0.0},
    plausible=plausible,
    needs=frozenset({"viscous"}),
    source="Bittencourt, Gunnarsson, J. Dyn. Sys. Meas. Control 134 (2012) 051013, with the "
    "exponential law of a lubricant's viscosity",
)
