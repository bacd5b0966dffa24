"""Signals with their tangents: sums, products and filters by the rules of differentiation."""

import numpy as np
import pytest
import sympy as sp
from effects.along import body_of, motion_along, signals

from teleopdesign.effects import SIGNALS
from teleopdesign.realise.along_motion import residual_along
from teleopdesign.realise.traced import Along, Traced, constant, filter_traced

N, P = 12, 4
RNG = np.random.default_rng(7)


def signal(rows):
    """A signal whose tangents move in these rows; None: in any, and nothing is said of them."""
    tangent = RNG.standard_normal((P, N))
    if rows is not None:
        tangent[[j for j in range(P) if j not in rows]] = 0.0
    return Traced(RNG.standard_normal(N), tangent, rows)


KINDS = {"any": None, "some": (1, 3), "none": ()}


@pytest.fixture(params=[*KINDS, "constant"])
def one(request):
    if request.param == "constant":
        return constant(RNG.standard_normal(N), P)
    return signal(KINDS[request.param])


def moves_as_declared(traced):
    """The tangents that are not zero lie in the rows that are said to move."""
    moving = range(P) if traced.moving is None else traced.moving
    still = [j for j in range(P) if j not in moving]
    return not traced.tangent[still].any()


def test_a_signal_times_a_factor_has_tangents_times_that_factor(one):
    factor = RNG.standard_normal(N)
    product = one.times(factor)
    assert np.array_equal(product.value, one.value * factor)
    assert np.array_equal(product.tangent, one.tangent * factor)
    assert moves_as_declared(product)


@pytest.mark.parametrize("other", [None, (0,), ()])
def test_sums_and_differences_are_those_of_values_and_tangents(one, other):
    more = signal(other)
    for made, sign in ((one + more, 1.0), (one - more, -1.0), (one.subtract([more, more]), -2.0)):
        assert made.value == pytest.approx(one.value + sign * more.value)
        assert made.tangent == pytest.approx(one.tangent + sign * more.tangent)
        assert moves_as_declared(made)


def test_a_filter_acts_on_the_value_and_on_each_tangent(one):
    weights = RNG.standard_normal((N, N))
    made = filter_traced(lambda rows: rows @ weights, one)
    assert made.value == pytest.approx(one.value @ weights)
    assert made.tangent == pytest.approx(one.tangent @ weights)
    assert moves_as_declared(made) and made.is_constant == one.is_constant


def test_rows_and_spans_are_those_of_the_samples(one):
    assert np.array_equal(one.rows(), np.vstack([one.value[None], one.tangent]))
    assert np.array_equal(one.rows(slice(2, 5)), one.rows()[:, 2:5])
    assert np.array_equal(one.between(slice(2, 5)).rows(), one.rows()[:, 2:5])
    assert one.is_constant == (not one.tangent.any())


def test_a_law_looks_its_parameters_up_and_compares_no_symbols(monkeypatch):
    """Of many columns it has one: on a record of a hundred rows comparisons cost more than it."""
    level, *others = sp.symbols("level other_1:9")
    speed = constant(np.array([0.1, -0.2]), 9)
    along = Along({SIGNALS["velocity"]: speed}, {level: 3.0}, (*others, level), 1e-3)
    law = level * SIGNALS["velocity"]
    along.evaluate(law)  # derived once
    compared = []
    equal = sp.Symbol.__eq__
    monkeypatch.setattr(sp.Symbol, "__eq__", lambda a, b: compared.append(a) or equal(a, b))
    force = along.evaluate(law)
    assert not compared
    assert np.array_equal(force.value, 3.0 * speed.value)
    assert np.array_equal(force.tangent, np.vstack([np.zeros((8, 2)), speed.value]))


def test_the_residual_along_a_motion_compares_hardly_any_symbols(monkeypatch):
    """Equal symbols are one object, so dictionaries compare none: 73 were compared before.

    Laws are compared with zero, and some with equal ones that another test derived.
    """
    effects = ("coulomb", "viscous", "spring", "transmission_compliance", "actuation_delay")
    body, motion = body_of(*effects), motion_along(*signals(1, 200), resolution=1e-6)
    names = [name for name, _ in body.declared()]
    residual_along(body, motion, names)  # laws derived once
    compared = []
    equal = sp.Basic.__eq__
    monkeypatch.setattr(sp.Basic, "__eq__", lambda a, b: compared.append((a, b)) or equal(a, b))
    again = residual_along(body.with_values({"coulomb.level": 0.7}), motion, names)
    assert again.residual.tangent.shape[0] == len(names)
    assert len(compared) < 20, compared
