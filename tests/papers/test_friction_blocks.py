"""The blocks C, H and K of Bernstein, Lawrence, Pao, World Haptics 2005, eqs (1), (6) and (8)."""

import numpy as np
import pytest
import sympy as sp

from teleopdesign.controllers import SIGNALS, controller, scheduled_force_feedback
from teleopdesign.diagrams import read_open_number, world_haptics_2005
from teleopdesign.effects import EFFECTS
from teleopdesign.simulate import simulate

v = sp.Symbol("v", positive=True)  # all laws here are odd or even in velocity
a, b, k, F_C = sp.symbols("a b k F_C", positive=True)
S = sp.Symbol("s")


def smoothed(speed):
    """The law of the cancellation, on paper's symbols."""
    made = controller("smoothed_coulomb", {"level": 1.0, "smoothing_velocity": 1.0})
    output = made.equation("C", {**SIGNALS, "velocity": speed, "speed": sp.Abs(speed)}).output
    return renamed(output, {"level": F_C, "smoothing_velocity": a})


def gain_at_rest_of_time(speed):
    """H at zero frequency and frozen speed: the low-pass drops out."""
    made = scheduled_force_feedback(gain=1.0, scheduling_velocity=1.0, bandwidth=1.0)
    return sp.simplify(
        renamed(made.linear_form("H", S, speed).subs(S, 0), {"gain": k, "scheduling_velocity": b})
    )


def renamed(expression, names):
    replacements = {
        s: new for s in expression.free_symbols for n, new in names.items() if s.name.endswith(n)
    }
    return expression.subs(replacements)


def coulomb(speed):
    effect = EFFECTS["coulomb"]
    return effect.expression(values={"level": F_C}) * sp.sign(speed)


def test_smoothed_coulomb_is_odd_increasing_and_below_its_level():
    """Eq (6): slope at 0 and greatest slope F_C/a."""
    up = smoothed(v)
    assert sp.simplify(smoothed(-v) + up) == 0
    slope = sp.simplify(sp.diff(up, v))
    assert sp.simplify(slope - F_C * a / (a + v) ** 2) == 0
    assert sp.limit(slope, v, 0) == F_C / a
    assert sp.simplify(F_C - up - F_C * a / (a + v)) == 0


def test_what_cancellation_leaves_has_the_shape_of_the_schedule():
    """Eqs (1) and (6): F_C sgn(v) a/(a + v) is left; the schedule of H is k b/(b + v)."""
    left = sp.simplify((coulomb(v) - smoothed(v)) / F_C)
    schedule = sp.simplify(gain_at_rest_of_time(v) / k)
    assert sp.simplify(left.subs(a, b) - schedule) == 0


def test_residual_friction_of_the_hybrid():
    """Quasi-static: r(v) = F_C a (b + v)/((a + v)(b + v + k b)), r(0) = F_C/(1 + k).

    It falls with speed throughout iff b (1 + k) >= a k.
    """
    r = (coulomb(v) - smoothed(v)) / (1 + gain_at_rest_of_time(v))
    assert sp.simplify(r - F_C * a * (b + v) / ((a + v) * (b + v + k * b))) == 0
    assert sp.limit(r, v, 0) == F_C / (1 + k)
    above = sp.fraction(sp.together(sp.diff(r, v)))[0]
    rising = sp.Poly(sp.expand(sp.simplify(above / (F_C * a))), v)
    signs = rising.all_coeffs()
    # -(v^2 + 2 b v + b^2 (1 + k) - a b k) times a positive factor: negative iff the last term is
    ratio = sp.simplify(signs[0])
    assert ratio == -1 or sp.ask(sp.Q.negative(ratio))
    assert sp.simplify(signs[-1] / ratio - (b**2 * (1 + k) - a * b * k)) == 0
    assert sp.simplify(signs[1] / ratio - 2 * b) == 0


def test_schedule_before_and_after_the_filter_agree_only_at_constant_speed():
    """The paper does not say which; at frozen speed both are k b/(b + v)/(tau s + 1)."""
    before, after = (
        scheduled_force_feedback(gain=5, scheduling_velocity=0.08, bandwidth=20, schedule=order)
        for order in ("before", "after")
    )
    assert sp.simplify(before.linear_form("H", S, v) - after.linear_form("H", S, v)) == 0
    assert before.equation("H", SIGNALS).output != after.equation("H", SIGNALS).output


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
