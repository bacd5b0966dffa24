"""Apparent impedance against frequency: figure 7 of Bernstein, Lawrence, Pao 2005."""

import amplitude_dependence
import impedance_against_frequency
import nonlinear_force_feedback_gain
import numpy as np
import pytest

pytestmark = pytest.mark.slow  # simulations at many frequencies


@pytest.fixture(scope="module")
def sweep():
    return impedance_against_frequency.run(quick=True)[0]


def slope(sweep, case, low, high):
    """dB per decade between two frequencies."""
    size = sweep.decibel.sel(case=case)
    return float(size.sel(frequency=high) - size.sel(frequency=low)) / np.log10(high / low)


@pytest.mark.parametrize("case", ["none", "FF"])
def test_coulomb_friction_climbs_by_16_db_a_decade_near_90_degrees(sweep, case):
    """20 times the exponent 0.8 of the profile; the mass adds 1 dB/decade from 2 to 5 Hz."""
    assert slope(sweep, case, 1.0, 2.0) == pytest.approx(16.0, abs=0.8)
    # mass and friction weigh as (f/20)^1.2: 10 degrees at 5 Hz; the filter of 20 Hz adds as much
    assert float(sweep.phase.sel(case=case, frequency=1.0)) == pytest.approx(90, abs=4)
    assert float(sweep.phase.sel(case=case, frequency=5.0)) == pytest.approx(90, abs=20)


@pytest.mark.parametrize("case", ["none", "MBC"])
def test_mass_climbs_by_40_db_a_decade_above_20_hz(sweep, case):
    # at 50 Hz friction is still a third of the mass: 1.2 dB/decade less
    assert slope(sweep, case, 50.0, 200.0) == pytest.approx(40.0, abs=1.0)
    assert float(sweep.phase.sel(case=case, frequency=200.0)) == pytest.approx(180, abs=5)


@pytest.mark.parametrize("case", ["FF", "hybrid"])
def test_force_feedback_lets_go_only_a_decade_above_its_bandwidth(sweep, case):
    """Its first-order filter of 20 Hz: steeper than the mass at first, which it meets at 200 Hz."""
    assert slope(sweep, case, 50.0, 100.0) > 50
    assert slope(sweep, case, 200.0, 400.0) == pytest.approx(40.0, abs=2.0)


def test_all_cases_merge_far_above_the_bandwidth(sweep):
    far, middle = (sweep.decibel.sel(frequency=f) for f in (400.0, 5.0))
    assert float(far.max() - far.min()) < 0.3
    assert float(middle.max() - middle.min()) > 15


def test_in_slow_motion_the_hybrid_is_lightest(sweep):
    low = sweep.decibel.sel(frequency=[1.0, 2.0, 5.0])
    assert (low.idxmin("case") == "hybrid").all()


def test_the_profile_puts_the_corner_at_20_hz(sweep):
    # 135 degrees by its definition; the contact's give turns friction by 0.2
    assert float(sweep.phase.sel(case="none", frequency=20.0)) == pytest.approx(135, abs=0.5)


def test_the_papers_two_claims_on_figure_7_conflict_whatever_its_amplitude_reads():
    """A corner at 20 Hz, and cancellation mass-like (180 degrees) down to 4 Hz."""
    phases = impedance_against_frequency.phases_of_cancellation()
    small, large = sorted(phases)
    assert (1e3 * small, 1e3 * large) == pytest.approx((2.95, 10.0), rel=1e-3)
    # half a degree: the digits that are stated
    assert phases[small] == pytest.approx(107, abs=0.5)
    assert phases[large] == pytest.approx(157, abs=0.5)
    corners = [impedance_against_frequency.corner_of(x) for x in (small, large)]
    assert corners == pytest.approx([20.0, 7.2], rel=0.01)


@pytest.fixture(scope="module")
def grid():
    return amplitude_dependence.run(quick=True)[0]


def test_amplitude_dependence_falls_with_frequency_but_stays_in_every_case(grid):
    spread = grid.spread()["size"]
    assert (spread.diff("frequency") < 0).all()
    assert (spread.isel(frequency=0) > 30).all()  # two decades of 20 dB each, less the schedule
    assert (spread.isel(frequency=-1) > 3).all()


def test_cancellation_makes_slow_motion_less_linear(grid):
    slow = grid.spread()["size"].isel(frequency=0)
    assert float(slow.sel(case="MBC")) > float(slow.sel(case="none")) + 5


@pytest.fixture(scope="module")
def trade_off():
    return nonlinear_force_feedback_gain.run(quick=True).data


def test_gain_alone_sets_the_friction_at_rest(trade_off):
    """F_C/(1 + k), whatever b; 0.1 mm/s of a = 15 mm/s lets it fall by 0.7 % with cancellation."""
    rest = trade_off["residual_friction"].sel(speed=1e-4)
    expected = 0.5 / (1 + trade_off["gain"])
    assert float(np.abs(rest / expected - 1).max()) < 0.015


def test_residual_friction_rises_with_speed_below_its_bound_on_b(trade_off):
    """Falls throughout if and only if b (1 + k) >= a k (P13); a = 15 mm/s, k = 5: 12.5 mm/s."""
    hybrid = trade_off["residual_friction"].sel(case="hybrid", gain=5.0)
    rise = hybrid.sel(speed=0.01) - hybrid.sel(speed=1e-4)
    assert float(rise.sel(scheduling_velocity=0.008)) > 0
    assert float(rise.sel(scheduling_velocity=0.08)) < 0


def test_delay_margin_falls_as_gain_grows(trade_off):
    margin = trade_off["delay_margin"].isel(bandwidth=0)
    assert (margin.diff("gain_at_rest") < 0).all()
    # 1/(4 bandwidth k m_H/(m + m_H)) for a large gain, k = 50; 2 % short of it
    assert float(margin[-1]) == pytest.approx(1 / (4 * 20 * 50 * 0.5 / 0.65), rel=0.03)


def test_a_larger_b_is_paid_for_in_linearity(trade_off):
    spread = trade_off["spread"].sel(case="hybrid", gain=5.0).isel(bandwidth=0)
    assert float(spread[-1] - spread[0]) > 2
