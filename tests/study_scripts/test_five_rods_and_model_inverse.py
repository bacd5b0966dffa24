"""Five rods: isotropy of the inverse, simulation against response, friction within its zonotope."""

import five_rods_and_model_inverse as study
import numpy as np
import pytest

from teleopdesign.diagrams import felt_friction


def test_a_rod_moves_by_what_the_hand_moves_its_point_along_it():
    five = study.five
    step = 1e-6
    moved = np.array([2.0, -1.0, 0.5, 3.0, -2.0]) * step
    turn = np.array([*moved[3:], 0.0]) / five.LEVER
    unit = five.DIRECTIONS / np.linalg.norm(five.DIRECTIONS, axis=1)[:, None]
    points = five.POINTS + moved[:3] + np.cross(turn, five.POINTS)
    along = ((points - five.POINTS) * unit).sum(axis=1)
    assert five.G @ moved == pytest.approx(along, rel=1e-9)


@pytest.fixture(scope="module")
def values():
    """Singular values from 0.1 to 300 Hz."""
    frequencies = np.concatenate([np.geomspace(0.1, 20.0, 9), np.geomspace(30.0, 300.0, 5)])
    return study.singular_values(np.append(frequencies, 10.0))


def test_the_inverse_answers_alike_in_every_direction_at_every_frequency(values):
    inverse = values.sel(response="inverse").values
    w = abs(study.low_pass(values["frequency"].values))
    # products of 5 x 5 matrices of condition below 100, in double precision
    assert np.abs(inverse / w[:, None] - 1).max() < 1e-10
    assert (values.sel(response="no compensation", order=1) > 1.5).any()


def test_force_feedback_narrows_the_band_up_to_its_bandwidth(values):
    slow = values[:, values["frequency"].values <= 20.0]
    band = slow.isel(order=0) / slow.isel(order=-1)
    assert (band.sel(response="force feedback") <= band.sel(response="no compensation")).all()


def test_the_inverse_depends_on_the_hand_it_was_made_for(values):
    for firmness in study.OTHER_HANDS:
        slow, medium = (
            values.sel(response=f"inverse, hand x {firmness:g}", frequency=f).values
            for f in (0.1, 10.0)
        )
        assert slow == pytest.approx(1.0, abs=0.01)  # the stiffness of any hand holds slow forces
        assert np.abs(medium / abs(study.low_pass(10.0)) - 1).max() > 0.3


@pytest.mark.slow  # five coupled rods compile in some ten seconds
@pytest.mark.parametrize("inverted", [False, True])
def test_without_friction_the_simulation_is_the_response(inverted):
    wanted, frequency = np.array([1.0, -0.5, 0.3, 0.8, -0.2]), 5.0
    made = study.driven(
        wanted, frequency, gain=study.five.GAIN, share=0.0, inverted=inverted, friction=False
    )
    time, rods = study.last_cycles(made, "R_M{}", frequency)
    wave = np.exp(-2j * np.pi * frequency * time)
    amplitudes = 2j * (wave @ rods @ study.five.G) / len(time)  # phasor of the sine
    response = study.five.rod_response(np.array([frequency]), gain=study.five.GAIN)[0]
    due = study.five.at_hand(response) @ wanted
    if inverted:
        due = study.low_pass(frequency) * wanted
    # 0.1 %: what is left of the start after SETTLED, e^-6 of it
    assert np.linalg.norm(amplitudes - due) < 1e-3 * np.linalg.norm(due)


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [2.0, 4.0])
def test_the_inverse_needs_friction_compensation_first(frequency):
    wanted = study.WANTED * np.eye(5)[3]  # rotation about x: resonates first

    def error(compensation, inverted):
        gain, share = study.COMPENSATIONS[compensation]
        made = study.driven(wanted, frequency, gain=gain, share=share, inverted=inverted)
        return study.force_error(made, wanted, frequency)

    plain, alone, both = error("none", False), error("none", True), error("hybrid", True)
    assert alone > 0.6 * plain
    assert both < 0.1 * alone
    assert both < 0.5 * error("hybrid", False)


@pytest.mark.slow
def test_simulated_friction_lies_in_its_zonotope():
    five = study.five
    whole = felt_friction(five.G, [five.FRICTION] * five.RODS)
    forces = study.friction_at_hand(0.0)
    assert whole.holds(forces).all()
    sizes = np.linalg.norm(forces, axis=1)
    assert sizes.max() <= whole.largest[0]
    # a force that turns past all directions of the plane moves every rod: the edge is reached
    assert sizes.max() > whole.smallest[0]


@pytest.mark.slow
def test_cancellation_shrinks_the_zonotope_to_what_is_left_of_each_level():
    five = study.five
    left = felt_friction(five.G, [(1 - five.SHARE) * five.FRICTION] * five.RODS)
    forces = study.friction_at_hand(five.SHARE)
    # more is felt only while a rod turns back: the sampled bristle is up to a sample late
    assert np.mean(left.holds(forces, tolerance=0.01)) > 0.9
    assert left.largest[0] == pytest.approx(
        (1 - five.SHARE) * felt_friction(five.G, [five.FRICTION] * five.RODS).largest[0]
    )
