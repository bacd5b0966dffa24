"""The studies of onset, run quickly, against the features that their figures must show."""

import numpy as np
import passive_delay_and_stiffness as coupling
import pytest
import stiffest_late_compensator as stiffest
import teleoperator_onset as swing_up


@pytest.mark.slow
def test_simulated_onset_of_the_teleoperator_is_the_balance_of_energy():
    result = swing_up.run(quick=True)
    assert result.attrs["grown_within_bound"] == 0
    assert result.attrs["worst_difference"] < 0.05
    share = result["share"].values
    for name in ("damping", "contact"):
        grown = result[f"growth_over_{name}"].values > 0
        onset = result[f"onset_over_{name}"].values
        assert np.all(np.diff(onset[~np.isnan(onset)]) > 0)
        assert not grown[share < result.attrs["cycles"]].any()  # P40 alone, without the dampers
        assert np.all(np.diff(grown.astype(int), axis=0) >= 0)  # once it grows, more grows too


@pytest.mark.parametrize("kind", ["delay", pytest.param("period", marks=pytest.mark.slow)])
def test_a_late_coupling_swings_up_beyond_its_bound_and_not_below(kind):
    late = 16 * coupling.TICK
    bound = coupling.limit(kind, late)
    claim = coupling.delayed if kind == "delay" else coupling.held
    assert claim(late, 0.999 * bound).status == "proved"
    assert claim(late, 1.001 * bound).status == "refuted"
    free, heavy = coupling.ends(kind)
    for masses in (free, heavy):
        assert not coupling.grows(kind, late, 0.99 * bound, masses)
    assert coupling.grows(kind, late, 1.01 * bound, heavy)
    assert coupling.grows(kind, late, 1.2 * bound, free)


@pytest.mark.slow
def test_proved_region_and_simulated_onset_of_late_couplings_agree():
    result = coupling.run(quick=True)
    assert result.attrs["contradictions"] == 0
    stiffness = result["stiffness"].values
    for name in ("delay", "period"):
        limit = result[f"limit_over_{name}"].values
        expected = np.where(stiffness[:, None] <= limit, "proved", "refuted")
        assert np.array_equal(result[f"status_over_{name}"].values, expected)
        times = result[f"{name}_simulated"].values
        over = result[f"onset_over_{name}"].values / [coupling.limit(name, t) for t in times]
        # the last interval of seven bisections is 2.2 %
        assert np.all(over >= 1) and np.all(over[1] < 1.03) and np.all(over[0] < 1.2)


@pytest.mark.parametrize("late", stiffest.LATE)
def test_a_late_compensator_swings_up_beyond_its_bound_and_not_below(late):
    period = 1.7e-3  # where the damping bounds it
    bound = stiffest.damping_limit(late, period)
    assert bound == pytest.approx(stiffest.DAMPING / (stiffest.SHARES[late] * period))
    assert bound < stiffest.PRESLIDING
    assert stiffest.claim(late, period, 0.999 * bound).status == "proved"
    assert stiffest.claim(late, period, 1.001 * bound).status == "refuted"
    assert not stiffest.grows(late, period, bound)
    assert stiffest.grows(late, period, 1.4 * bound)
    # held by its own contact alone it swings where a late negative spring damps
    assert not stiffest.grows(late, period, 0.99 * stiffest.PRESLIDING, free=True)
    assert stiffest.grows(late, period, 1.01 * stiffest.PRESLIDING, free=True)


@pytest.mark.slow
def test_sinusoids_at_half_the_sample_rate_grow_from_pi_squared_over_eight_on():
    result = stiffest.run(quick=True)
    assert result.attrs["contradictions"] == 0
    over = result["over"].sel(late=1, ends="worst hand").values
    assert len(over) >= 2
    # the last interval of seven bisections is 1.1 %
    assert over == pytest.approx(np.full(len(over), np.pi**2 / 8), rel=0.012)
