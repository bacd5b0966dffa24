"""The studies of passivity, run quickly, against the features that their figures must show."""

import compensation_through_a_cable as cable
import forward_euler_against_exact
import largest_compensation_without_growth
import numpy as np
import passive_region_with_presliding
import passive_walls
import pytest

from teleopdesign.passivity import largest_ratio


def test_simulated_oscillations_stop_growing_on_the_curve():
    """Largest f_D/f_C = 1/(1 - tanh(u)/u), as the compiled kernel finds it by bisection."""
    result = largest_compensation_without_growth.run(quick=True)
    for u, ratio in zip(result["u"].values, result["simulated"].values, strict=True):
        # 0.1 %: the bisection's last interval is 0.05 %, the contact gives by 0.01 % of the stroke
        assert ratio == pytest.approx(largest_ratio(float(u)), rel=1e-3)
        assert ratio > largest_ratio(float(u), motion="closed paths")


@pytest.mark.slow
def test_the_passive_region_is_the_wedge_for_proof_and_for_search():
    result = passive_region_with_presliding.run(quick=True)
    x, y = np.meshgrid(result["softness"].values, result["share"].values)
    wedge = (x**2 <= y) & (y <= 1)
    assert np.array_equal(result["status"].values == "proved", wedge)
    assert set(result["status"].values[~wedge]) == {"refuted"}
    assert result.attrs["contradictions"] == 0
    # the search of so few motions may miss points next to the boundary
    assert result.attrs["missed"] <= 4


@pytest.mark.slow  # the same search is in passivity/test_counterexample.py
def test_a_motion_is_detected_outside_the_wedge_and_none_inside():
    motions = passive_region_with_presliding.motions(4)
    assert not passive_region_with_presliding.gives_out(0.8, 0.7, motions)  # 0.64 <= 0.7
    assert passive_region_with_presliding.gives_out(0.8, 0.4, motions)
    assert passive_region_with_presliding.gives_out(0.5, 1.1, motions)


def test_forward_euler_loses_the_bound_at_one_and_diverges_at_two():
    result = forward_euler_against_exact.run(quick=True)
    largest = result["largest_euler"]
    step = float(result["q_sweep"][1] - result["q_sweep"][0])
    # the first q of the sweep beyond the limit
    assert 1 < result.attrs["bound_lost_at"] <= 1 + step + 1e-9
    assert 2 < result.attrs["diverges_at"] <= 2 + step + 1e-9
    assert float(result["largest_exact"].max()) <= 1 + 1e-12
    between = largest.where((largest.q_sweep > 1) & (largest.q_sweep < 2), drop=True)
    assert between.values == pytest.approx(2 * between.q_sweep.values - 1, rel=1e-9)
    # "stable" at 1.5, and twice the level; 1.1 a sample at 2.1
    assert float(abs(result["euler"].sel(q=1.5)).max()) == pytest.approx(2.0)
    last = result["euler"].sel(q=2.1).values[-2:] - 1
    assert last[1] / last[0] == pytest.approx(-1.1)


@pytest.mark.slow
def test_cycles_through_a_cable_give_out_energy_where_the_plain_limit_says():
    """Just above P55 a cycle is found; at the floor f_1 none is, and the storage is finite."""
    friction = [
        cable.Coulomb(cable.MOTOR),
        cable.Spring(cable.LINK, cable.CABLE),
    ]
    for softness in (0.5, 3.0, 20.0):
        stiffness = softness * cable.CABLE
        limit = cable.plain_limit(stiffness)
        assert cable.gives_out(cable.Dahl(1.01 * limit, stiffness), friction)
        floor = cable.Dahl(cable.MOTOR, stiffness)
        assert not cable.gives_out(floor, friction)
        assert cable.available_storage(floor, friction, points=31).is_finite


@pytest.mark.slow
def test_walls_are_proved_up_to_the_limit_and_refuted_beyond():
    result = passive_walls.run(quick=True)
    k = result["stiffness"].values
    for name in ("period", "damping"):
        status, limit = result[f"over_{name}"].values, result[f"limit_over_{name}"].values
        expected = np.where(k[None, :, None] <= limit[:, None, :], "proved", "refuted")
        assert np.array_equal(status, expected)
