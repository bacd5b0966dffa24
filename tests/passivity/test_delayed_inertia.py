"""Cancelling inertia late: what it gives out, and how much the damping pays for."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    cancelled_inertia,
    damping_given_out,
    inertia_given_out,
    largest_passive_inertia,
)

DEVICE = {"inertia": 0.15, "damping": 1.0}
times = st.floats(1e-4, 1e-1)
orders = st.sampled_from([1, 2])


@given(frequency=st.floats(0.1, 1e3), delay=times)
def test_without_low_pass_it_is_the_energy_of_p48(frequency, delay):
    amplitude, inertia = 2e-3, 0.1
    w = 2 * np.pi * frequency
    g = damping_given_out(np.array([frequency]), delay=delay)[0]
    expected = inertia_given_out(
        inertia=inertia, amplitude=amplitude, frequency=frequency, delay=delay
    )
    # rounding of a phase of up to 600 rad
    scale = inertia * np.pi * amplitude**2 * w**2
    assert inertia * np.pi * amplitude**2 * w * g == pytest.approx(expected, abs=1e-12 * scale)


@settings(max_examples=50)
@given(delay=times, time_constant=times, order=orders)
def test_damping_pays_for_no_less_than_the_bound_of_any_delay(delay, time_constant, order):
    arguments = {"delay": delay, "time_constant": time_constant, "order": order}
    limit = largest_passive_inertia(damping=1.0, **arguments)
    assert limit >= order * time_constant * (1 - 1e-9)
    upper = 20 / (2 * np.pi * time_constant)
    frequency = np.linspace(0, upper, 20001)
    g = damping_given_out(frequency, **arguments)
    assert limit * g.max() <= 1 + 1e-9


@pytest.mark.slow
@settings(max_examples=30)
@given(delay=times, time_constant=times, order=orders)
def test_a_proof_within_the_bound_and_a_wave_beyond_the_limit(delay, time_constant, order):
    arguments = {"delay": delay, "time_constant": time_constant, "order": order}
    within = order * time_constant
    proved = cancelled_inertia(**DEVICE, cancelled=0.999 * within, **arguments)
    assert proved.status == "proved"
    proved.certificates[0].check()
    beyond = 1.01 * largest_passive_inertia(damping=DEVICE["damping"], **arguments)
    refuted = cancelled_inertia(**DEVICE, cancelled=beyond, **arguments)
    assert refuted.status == "refuted"
    assert refuted.record.energy > 0


def test_a_delay_with_a_low_pass_of_order_two_allows_a_little_more():
    """Where the acceleration is largest it comes late: only numbers say how much is gained."""
    late = {"delay": 0.005, "time_constant": 0.005}
    limit = largest_passive_inertia(damping=1.0, **late)
    assert limit > 1.1 * 2 * 0.005
    claim = cancelled_inertia(**DEVICE, cancelled=0.99 * limit, **late)
    assert (claim.status, claim.holds) == ("evidence", True)


def test_any_delay_without_low_pass_is_refuted_whatever_the_damping():
    claim = cancelled_inertia(inertia=0.15, damping=100, cancelled=0.01, delay=1e-4)
    assert claim.status == "refuted"
    assert claim.record.replay() > 0
    assert largest_passive_inertia(damping=100, delay=1e-4) == 0


@pytest.mark.parametrize(("cancelled", "status"), [(0.15, "proved"), (0.151, "refuted")])
def test_without_delay_all_of_the_inertia_may_go_and_no_more(cancelled, status):
    assert cancelled_inertia(**DEVICE, cancelled=cancelled, delay=0).status == status


@pytest.mark.parametrize("order", [1, 2])
def test_the_bound_is_exact_without_delay(order):
    low = {"time_constant": 0.01, "order": order, "delay": 0}
    limit = order * 0.01
    assert cancelled_inertia(**DEVICE, cancelled=limit, **low).status == "proved"
    assert cancelled_inertia(**DEVICE, cancelled=1.001 * limit, **low).status == "refuted"


def test_wrong_input_is_named():
    with pytest.raises(ModelError, match="cancelled: expected a number >= 0"):
        cancelled_inertia(**DEVICE, cancelled=-0.1, delay=0)
    with pytest.raises(ModelError, match="1 or 2, found 3"):
        cancelled_inertia(**DEVICE, cancelled=0.1, delay=0, time_constant=0.01, order=3)


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


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(("delay", "time_constant"), [(0.01, 0.02), (0.01, 0.0), (0.0, 0.0)])
def test_a_device_none_of_whose_inertia_is_cancelled_is_passive(delay, time_constant, order):
    claim = cancelled_inertia(
        **DEVICE, cancelled=0, delay=delay, time_constant=time_constant, order=order
    )
    assert claim.status == "proved"
    claim.certificates[0].check()


@pytest.mark.parametrize(("cancelled", "status"), [(0.149, "proved"), (0.151, "refuted")])
def test_without_delay_and_low_pass_all_inertia_may_be_cancelled(cancelled, status):
    assert cancelled_inertia(**DEVICE, cancelled=cancelled, delay=0).status == status
