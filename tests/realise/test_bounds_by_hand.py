"""Bounds of acting forces and of damping where the law is simple enough to say them by hand."""

from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.effects import EFFECTS, Effect, Parameter
from teleopdesign.realise.acting_bound import largest_acting_force
from teleopdesign.realise.damping_interval import damping_interval
from teleopdesign.realise.friction_along import _bound_sliding
from teleopdesign.realise.friction_interval import Interval
from teleopdesign.realise.traced import Traced


def with_law(law, role, size=0.5, **more):
    """A body with an effect of a user, whose one parameter is `size`."""
    parameters = {"size": Parameter("force", "size")}
    made = Effect(role=role, law=law, parameters=parameters, absent={"size": 0.0}, **more)
    body = td.Body("prismatic", {"inertia": td.Value(0.1)})
    return body.with_effect(made.named("own", "Own."), {"size": size})


@pytest.mark.parametrize("way", [1, -1])
def test_a_stage_that_is_stronger_one_way_acts_with_the_stronger(way):
    body = with_law(lambda now, p: now.command + way * p.size * abs(now.command), "actuation")
    assert largest_acting_force(body, 2.0, errors=2.0) == pytest.approx(3.0, rel=1e-3)


def test_what_an_actuation_without_a_bound_makes_is_unbounded():
    body = with_law(lambda now, p: now.command / (now.command - p.size), "actuation")
    assert largest_acting_force(body, 2.0, errors=2.0) == inf
    assert largest_acting_force(body, 0.25, errors=2.0) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_where_no_damping_is_known_it_is_zero_and_what_may_push_is_named(damping):
    """A force that pushes harder than the damper brakes, and that says nothing of its energy."""
    body = with_law(lambda now, p: -p.size * now.velocity, "force")
    if damping:
        body = body.with_effect(EFFECTS["viscous"], {"damping": damping})
    interval = damping_interval(body, errors=0.0)
    assert interval.least == Interval(damping, damping, damping)
    assert interval.supplying == ("own",)
    if not damping:
        body = body.with_effect(EFFECTS["viscous"], {"damping": 0.0})
    braked = body.with_values({"viscous.damping": td.Value(0.7)})
    interval = damping_interval(braked, errors=0.0)
    assert interval.least.low == pytest.approx(0.2) and interval.supplying == ()


@pytest.mark.parametrize("is_even", [True, False])
def test_sliding_friction_is_against_the_motion_and_at_rest_anything_between(is_even):
    """With its tangents: those of the level that bounds it."""
    random = np.random.default_rng(0)
    forward = Traced(np.arange(1.0, 7.0), random.normal(size=(2, 6)))
    backward = forward if is_even else Traced(np.arange(6.0, 0.0, -1.0), random.normal(size=(2, 6)))
    direction = np.array([1, 0, -1, 0, 1, -1])
    low, high = _bound_sliding(SimpleNamespace(direction=direction), forward, backward)
    for k, way in enumerate(direction):
        least = forward.rows()[:, k] if way > 0 else -backward.rows()[:, k]
        most = -backward.rows()[:, k] if way < 0 else forward.rows()[:, k]
        assert (low.rows()[:, k] == least).all() and (high.rows()[:, k] == most).all()
        assert (least == most).all() == bool(way)
