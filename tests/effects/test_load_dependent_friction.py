"""Friction of the load: it opposes the motion, and is told by who drives whom and how fast."""

import math

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.effects import EFFECTS, SIGNALS

EFFECT = EFFECTS["load_dependent_friction"]
USED = ("acting_force", "carried_force", "velocity", "direction")
PARTS = st.floats(-1.0, 1.0)
SPEEDS = st.floats(1e-6, 5.0)
PARAMETERS = ("coefficient", "driving_difference", "extra_at_rest", "stribeck_velocity")
LAW = sp.lambdify(
    [*(SIGNALS[n] for n in USED), *(EFFECT.symbols()[n] for n in (*PARAMETERS, "output_share"))],
    EFFECT.expression(),
    "math",
)


def level(force, velocity, *, mu, d=0.0, e=0.0, slow=0.1, carried=math.nan):
    """Level under an acting force; under a carried one instead, where it is given."""
    at_output = not math.isnan(carried)
    way = math.copysign(1.0, velocity)
    return float(
        LAW(force, carried if at_output else 0.0, velocity, way, mu, d, e, slow, at_output)
    )


@given(force=st.floats(-50, 50), v=SPEEDS, mu=st.floats(0, 1), d=PARTS, e=st.floats(0, 5))
def test_the_force_at_the_output_makes_what_the_same_acting_force_makes(force, v, mu, d, e):
    assert level(7.0, v, mu=mu, d=d, e=e, carried=force) == level(force, v, mu=mu, d=d, e=e)


@given(force=st.floats(-50, 50), v=SPEEDS, mu=st.floats(0, 1), d=PARTS, e=st.floats(0, 5))
def test_a_machine_viewed_from_the_other_side_has_the_same_level(force, v, mu, d, e):
    """Even where force and motion both turn round."""
    here, there = (level(s * force, s * v, mu=mu, d=d, e=e) for s in (1, -1))
    assert here == pytest.approx(there)


@given(force=st.floats(0.1, 50), v=SPEEDS, mu=st.floats(0.01, 1), d=PARTS)
def test_the_difference_of_the_directions_is_odd_in_who_drives(force, v, mu, d):
    driving, driven = level(force, v, mu=mu, d=d), level(force, -v, mu=mu, d=d)
    assert driving + driven == pytest.approx(2 * mu * force)
    assert driving - driven == pytest.approx(2 * mu * d * force, abs=1e-9)
