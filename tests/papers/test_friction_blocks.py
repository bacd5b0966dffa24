"""The blocks C, H and K of Bernstein, Lawrence, Pao, World Haptics 2005, eqs (1), (6) and (8)."""

import numpy as np
import pytest
import sympy as sp

from teleopdesign.controllers import controller
from teleopdesign.diagrams import read_open_number, world_haptics_2005
from teleopdesign.simulate import simulate

v = sp.Symbol("v", positive=True)  # all laws here are odd or even in velocity
a, b, k, F_C = sp.symbols("a b k F_C", positive=True)
S = sp.Symbol("s")


def renamed(expression, names):
    replacements = {
        s: new for s in expression.free_symbols for n, new in names.items() if s.name.endswith(n)
    }
    return expression.subs(replacements)


def test_the_lead_is_the_papers_lead():
    """Eq (8): K = g (s + z)/(s + p)."""
    g, z, p = sp.symbols("g z p", positive=True)
    form = controller("lead", {"gain": 1.0, "zero": 1.0, "pole": 1.0}).linear_form("K", S, v)
    form = renamed(form, {"gain": g, "zero": z, "pole": p})
    assert sp.simplify(form - g * (S + z) / (S + p)) == 0


@pytest.mark.parametrize(
    ("share", "moves"), [(0.8, False), pytest.param(2.0, True, marks=pytest.mark.slow)]
)
def test_the_rod_moves_only_if_the_loop_can_overcome_friction(share, moves):
    """abs(K(0)) A > F_C, or a slow reference does not move the rod at all."""
    diagram = world_haptics_2005(position_loop=True).without("H", "C")
    stiffness = (
        read_open_number("position_gain")
        * read_open_number("position_zero")
        / read_open_number("position_pole")
    )
    amplitude = share * read_open_number("coulomb_level") / stiffness
    width = 1e-5
    result = simulate(
        diagram,
        duration=2.0,
        inputs={"L_D": lambda t: amplitude * np.sin(2 * np.pi * 0.5 * t)},
        computer="continuous",
        give=width,
        jit=False,
        step=2e-4,
        long_step="refine",
    )
    travel = float(np.abs(result["L"]).max())
    # stuck: the bristle gives by give * log(1/(1 - share)), with the inertial force a little more
    assert (travel > 0.2 * amplitude) if moves else (travel < 5 * width)
