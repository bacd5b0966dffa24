"""Figures 6 and 7 of Mahvash, Okamura, ICRA 2006: what a user feels of a slave's friction.

Shapes and laws, not digits: the machine is an example, the widths are those of the balance of
forces (P62, P63).
"""

import numpy as np
import pytest
import teleoperator_in_free_space
import teleoperator_in_soft_contact


@pytest.fixture(scope="module")
def free_space():
    return teleoperator_in_free_space.run()


@pytest.fixture(scope="module")
def contact():
    return teleoperator_in_soft_contact.run()


@pytest.mark.parametrize(("case", "share"), [("no compensation", 0.0), ("90 % cancelled", 0.9)])
def test_in_free_space_the_loop_falls_to_what_is_not_cancelled(free_space, case, share):
    damping = 2 * 4.0 * 2 * np.pi * 0.2 * 0.01  # two sides, both ways, at the peak speed
    assert free_space.loops[case].width == pytest.approx(2 * (1 - share) + damping, abs=0.02)


def test_cancellation_brings_no_oscillation(free_space):
    """Between reversals the force falls off smoothly, as without compensation."""
    for case in ("no compensation", "90 % cancelled"):
        one = free_space.data.sel(case=case)
        x, force = one["displacement"].values, one["force"].values
        sliding = np.abs(x) < 5e-3
        jerk = np.diff(force, 2)[sliding[1:-1]]
        # one sample's second difference of a smooth force of this size is below a micronewton
        assert np.abs(jerk).max() < 1e-4, case


@pytest.mark.slow
@pytest.mark.parametrize(("case", "share"), [("no compensation", 0.0), ("90 % cancelled", 0.9)])
def test_in_contact_the_loop_narrows_to_that_of_the_rubber(contact, case, share):
    rubber = contact.environment[case]
    series = 1 + rubber.stiffness / 2000.0
    loop = contact.loops[case]
    friction = 2 * (1 - share) / series
    # damping of both sides and the rubber's own loop come on top: 0.1 N each
    assert friction < loop.width < friction + 0.25
    assert loop.stiffness == pytest.approx(rubber.stiffness / series, rel=0.05)


@pytest.mark.slow
def test_the_rubber_keeps_a_small_loop(contact):
    for loop in contact.environment.values():
        assert 0.05 < loop.width < 0.2


@pytest.mark.slow
def test_the_force_felt_is_nearly_the_tips(contact):
    assert contact.rms["90 % cancelled"] < 0.15 * contact.rms["no compensation"]
