"""A nonlinear law takes what another block or a sum computes, as it takes what is measured."""

from dataclasses import replace

import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, haptic_interface
from teleopdesign.simulate import Sampling, simulate, sine

LIMIT = controller("karnopp", {"level": 0.3, "band": 10.0})
DOUBLED = controller("gain", {"gain": 2.0})


def moved(diagram, computer):
    simulation = simulate(
        diagram,
        duration=0.05,
        inputs={"R_D": lambda t: np.sin(60 * t)},
        motion={"L": sine(amplitude=0.01, frequency=5.0)},
        computer=computer,
        jit=False,
    )
    return simulation["R_MBC"].values


def in_two_blocks():
    made = haptic_interface(body(0.1), cancellation=LIMIT)
    blocks = [replace(b, input="doubled") if b.name == "C" else b for b in made.blocks]
    return replace(made, blocks=(*blocks, Control("G", DOUBLED, "R_D", "doubled")))


@pytest.mark.parametrize("computer", [Sampling(), "continuous"])
def test_two_blocks_are_the_series_of_their_laws(computer):
    """A limit of 0.3 N behind a gain of 2, which is reached."""
    series = haptic_interface(body(0.1), cancellation=DOUBLED.then(LIMIT))
    blocks = tuple(replace(b, input="R_D") if b.name == "C" else b for b in series.blocks)
    expected = moved(replace(series, blocks=blocks), computer)
    assert np.abs(expected).max() == pytest.approx(0.3)
    np.testing.assert_allclose(moved(in_two_blocks(), computer), expected, rtol=0, atol=1e-15)
