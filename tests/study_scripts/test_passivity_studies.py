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
    found = largest_compensation_without_growth.run(quick=True)
    for u, ratio in zip(found["u"].values, found["simulated"].values, strict=True):
        # 0.1 %: the bisection's last interval is 0.05 %, the contact gives by 0.01 % of the stroke
        assert ratio == pytest.approx(largest_ratio(float(u)), rel=1e-3)
        assert ratio > largest_ratio(float(u), motion="closed paths")


@pytest.mark.slow
def test_the_passive_region_is_the_wedge_for_proof_and_for_search():
    found = passive_region_with_presliding.run(quick=True)
    x, y = np.meshgrid(found["softness"].values, found["share"].values)
    wedge = (x**2 <= y) & (y <= 1)
    assert np.array_equal(found["status"].values == "proved", wedge)
    assert set(found["status"].values[~wedge]) == {"refuted"}
    assert found.attrs["contradictions"] == 0
    # the search of so few motions may miss points next to the boundary
    assert found.attrs["missed"] <= 4


@pytest.mark.slow  # the same search is in passivity/test_counterexample.py
def test_a_motion_is_found_outside_the_wedge_and_none_inside():
    tried = passive_region_with_presliding.motions(4)
    assert not passive_region_with_presliding.gives_out(0.8, 0.7, tried)  # 0.64 <= 0.7
    assert passive_region_with_presliding.gives_out(0.8, 0.4, tried)
    assert passive_region_with_presliding.gives_out(0.5, 1.1, tried)


def test_forward_euler_loses_the_bound_at_one_and_diverges_at_two():
    found = forward_euler_against_exact.run(quick=True)
    largest = found["largest_euler"]
    step = float(found["q_sweep"][1] - found["q_sweep"][0])
    # the first q of the sweep beyond the limit
    assert 1 < found.attrs["bound_lost_at"] <= 1 + step + 1e-9
    assert 2 < found.attrs["diverges_at"] <= 2 + step + 1e-9
    assert float(found["largest_exact"].max()) <= 1 + 1e-12
    between = largest.where((largest.q_sweep > 1) & (largest.q_sweep < 2), drop=True)
    assert between.values == pytest.approx(2 * between.q_sweep.values - 1, rel=1e-9)
    # "stable" at 1.5, and twice the level; 1.1 a sample at 2.1
    assert float(abs(found["euler"].sel(q=1.5)).max()) == pytest.approx(2.0)
    last = found["euler"].sel(q=2.1).values[-2:] - 1
    assert last[1] / last[0] == pytest.approx(-1.1)


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
    found = passive_walls.run(quick=True)
    k = found["stiffness"].values
    for name in ("period", "damping"):
        status, limit = found[f"over_{name}"].values, found[f"limit_over_{name}"].values
        expected = np.where(k[None, :, None] <= limit[:, None, :], "proved", "refuted")
        assert np.array_equal(status, expected)
