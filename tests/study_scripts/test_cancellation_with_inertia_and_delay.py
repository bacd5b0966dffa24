"""Cancelled inertia: what it gives out, and limits that simulations confirm from both sides."""

import cancellation_with_inertia_and_delay as study
import numpy as np
import pytest

from teleopdesign.passivity import cancelled_inertia


@pytest.fixture(scope="module")
def trials():
    return study.trials()


@pytest.mark.slow  # the same loop grows beyond its limit in the plain run
def test_simulated_motion_gives_out_what_the_formula_says():
    energies = study.given_out()["given_out_simulated"]
    half = study.late.INERTIA / 2
    for name, bandwidth in (("fast", study.FAST), ("slow", study.SLOW)):
        expected = half * study.damping_given_out(
            np.array(study.DRIVEN), delay=study.DELAY, time_constant=1 / study.late.pole(bandwidth)
        )
        # 1e-3 of the inertia's own force: fourth order, 10 to 16 steps in a cycle of 625 Hz
        scale = half * 2 * np.pi * np.array(study.DRIVEN)
        measured = energies.sel(simulated_filter=name).values
        assert (np.abs(measured - expected) < 1e-3 * scale).all()
    # half a turn late the sign turns: P48 is about w tau < pi
    assert (np.sign(energies.sel(simulated_filter="fast").values) == [1, 1, 1, -1]).all()


@pytest.mark.slow
@pytest.mark.parametrize("hand", ["any", "hand, low-pass 30 Hz", "fingertip, low-pass 100 Hz"])
def test_motion_decays_within_the_limit_and_grows_beyond_it(trials, hand):
    chosen = trials.isel(trial=(trials["hand"] == hand).values)
    assert chosen.sizes["trial"] >= 6
    assert ((chosen["rate"] > 0) == (chosen["over_limit"] > 1)).all()


@pytest.mark.slow
def test_growth_against_the_worst_hand_is_the_damping_that_lacks(trials):
    """Near the limit the envelope grows at (share/limit - 1) b over twice the moving mass."""
    chosen = trials.isel(trial=(trials["hand"] == "any").values)
    expected = (chosen["over_limit"] - 1) * study.late.DAMPING / (2 * study.late.INERTIA)
    # the device alone moves, lightened or burdened by a few percent of its inertia
    assert chosen["rate"].values == pytest.approx(expected.values, rel=0.15)


def test_delay_alone_is_refuted_and_no_delay_is_proved():
    device = {"inertia": study.late.INERTIA, "damping": study.late.DAMPING}
    whole = cancelled_inertia(**device, cancelled=study.late.INERTIA, delay=0)
    a_percent = cancelled_inertia(**device, cancelled=study.late.INERTIA / 100, delay=1e-3)
    assert (whole.status, a_percent.status) == ("proved", "refuted")


def test_with_a_known_hand_delay_costs_share():
    for hand in study.late.HANDS.values():
        shares = [study.late.stable_share(hand, bandwidth=30.0, delay=t) for t in (1e-3, 1e-2)]
        assert shares[0] > shares[1] > study.passive_share(30.0)


def test_inertia_that_may_be_cancelled_for_any_hand_changes_little():
    """At 10 Hz less than a fifth of the impedance goes; what is not passive takes most of it."""
    felt = study.felt()
    least = felt["felt"].min("felt_frequency")
    passive = [str(c) for c in least["case"].values if "10 Hz, passive" in str(c)]
    assert 0.8 < float(least.sel(case=passive[0])) < 1
    assert float(least.sel(case="90 %, low-pass 30 Hz")) < 0.2
    slow = felt["apparent_mass"].isel(felt_frequency=0)  # 0.1 Hz: 5e-5 of the low-pass's poles off
    assert float(slow.sel(case="90 %, low-pass 30 Hz")) == pytest.approx(0.1, abs=1e-3)
