"""Derivatives of laws along a motion: almost everywhere; a jump has the slope of its sides."""

import numpy as np
import sympy as sp

from teleopdesign.effects import SIGNALS
from teleopdesign.realise.traced import slope


def test_a_jump_has_the_slope_of_its_sides():
    command, dead = SIGNALS["command"], sp.Symbol("dead", positive=True)
    law = command - dead * sp.sign(command)
    assert slope(law, command) == 1
    assert slope(law, dead) == -sp.sign(command)


def test_without_a_jump_it_is_the_derivative():
    command, k = SIGNALS["command"], sp.Symbol("k")
    law = command / (1 + k * command**2)
    numbers = {command: 0.7, k: 0.3}
    step = 1e-6
    difference = law.subs({command: 0.7 + step, k: 0.3}) - law.subs({command: 0.7 - step, k: 0.3})
    # the central difference errs by step^2 and rounding by 1e-16 / step
    assert np.isclose(
        float(slope(law, command).subs(numbers)), float(difference / (2 * step)), rtol=1e-8
    )
