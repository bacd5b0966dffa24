"""Five rods: isotropy of the inverse, simulation against response, friction within its zonotope."""

import five_rods_and_model_inverse as study
import numpy as np
import pytest

from teleopdesign.diagrams import felt_friction


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
