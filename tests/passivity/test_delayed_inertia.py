"""Cancelling inertia late: what it gives out, and how much the damping pays for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.passivity import (
    cancelled_inertia,
    damping_given_out,
    largest_passive_inertia,
)
from teleopdesign.passivity.theorems.quantised_spring import stiffest_spring

DEVICE = {"inertia": 0.15, "damping": 1.0}
times = st.floats(1e-4, 1e-1)


@given(frequency=st.floats(0.1, 1e3), delay=times)
def test_without_low_pass_it_is_the_energy_of_p48(frequency, delay):
    amplitude, inertia = 2e-3, 0.1
    w = 2 * np.pi * frequency
    g = damping_given_out(np.array([frequency]), delay=delay)[0]
    # rounding of a phase of up to 600 rad
    scale = inertia * np.pi * amplitude**2 * w**2
    expected = scale * np.sin(w * delay)
    assert inertia * np.pi * amplitude**2 * w * g == pytest.approx(expected, abs=1e-12 * scale)


@pytest.mark.parametrize("part", [0.3, 0.9, 1.1])
def test_between_the_proof_and_the_limit_the_margin_is_the_least_real_part(part):
    """By a fine grid of frequencies; beyond the limit a growing wave refutes."""
    delay, constant = 0.004, 0.01
    limit = largest_passive_inertia(damping=1.0, delay=delay, time_constant=constant, order=2)
    proved = 2.0 * constant
    cancelled = proved + part * (limit - proved)
    claim = cancelled_inertia(
        **DEVICE, cancelled=cancelled, delay=delay, time_constant=constant, order=2
    )
    s = 1j * np.linspace(1.0, 2000.0, 400_001)
    real = 1.0 - (cancelled * s * np.exp(-s * delay) / (1.0 + s * constant) ** 2).real
    if part < 1.0:
        assert (claim.status, claim.holds) == ("evidence", True)
        assert claim.verdict.margin == pytest.approx(real.min(), abs=1e-6)
    else:
        assert claim.status == "refuted" and real.min() < 0.0


@pytest.mark.parametrize(
    ("delay", "time_constant", "order", "expected"),
    [
        (0.0, 0.0, 2, np.inf),
        (0.01, 0.0, 2, 0.0),
        (0.0, 0.02, 1, 3.0 * 0.02),
        (0.01, 0.02, 1, 3.0 * 0.02),
        (0.0, 0.02, 2, 2 * 3.0 * 0.02),
    ],
)
def test_the_largest_inertia_is_that_of_its_closed_form(delay, time_constant, order, expected):
    limit = largest_passive_inertia(
        damping=3.0, delay=delay, time_constant=time_constant, order=order
    )
    assert limit == pytest.approx(expected, rel=1e-9)


# --- encoder steps ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("damping", "step", "level", "compensator", "expected"),
    [
        (1.0, 1e-5, 0.5, 0.0, 2000.0),  # 2 b/T
        (100.0, 1e-5, 0.5, 0.0, 1e5),  # 2 f_C/Delta
        (100.0, 1e-5, 0.5, 0.3, 4e4),  # what the compensator leaves of it
        (100.0, 1e-5, 0.5, 0.6, 0.0),
        (100.0, 0.0, 0.5, 0.0, 2e5),  # no steps
        (0.0, 1e-5, 0.5, 0.0, 0.0),
    ],
)
def test_the_stiffest_spring_is_the_least_that_damping_and_friction_pay_for(
    damping, step, level, compensator, expected
):
    stiffest = stiffest_spring(
        damping=damping,
        sample_time=1e-3,
        step=step,
        coulomb_level=level,
        compensator_level=compensator,
    )
    assert stiffest == pytest.approx(expected)
