"""Products of parameters that records tell though they tell none of them alone."""

import numpy as np
import pytest
from diagnose.known_models import BY_EFFECT, ROWS, fitted, model

from teleopdesign.diagnose.products import best_product, product_of


def test_the_best_product_is_known_better_than_any_other():
    """Of all powers of the same size."""
    rng = np.random.default_rng(2)
    for _ in range(5):
        columns = rng.standard_normal((ROWS, 3)) @ rng.standard_normal((3, 3))
        covariance = np.linalg.inv(columns.T @ columns)
        errors = np.sqrt(np.diag(covariance))
        powers, known = best_product(columns, errors)
        assert np.max(np.abs(powers)) == 1.0 and np.max(powers) == 1.0
        assert known == pytest.approx(np.sqrt(powers @ covariance @ powers))
        others = rng.standard_normal((500, 3))
        others *= np.linalg.norm(powers) / np.linalg.norm(others, axis=1)[:, None]
        spread = np.sqrt(np.einsum("ij,jk,ik->i", others, covariance, others))
        assert known <= spread.min() * (1 + 1e-9)


def valley(little=0.01, also=0.0, scale=(1.0, 1.0, 1.0), **changed):
    """A fit in which level and speed of `stribeck` do alike, and coulomb's level does `also`."""
    rng = np.random.default_rng(3)
    one, two, three = np.linalg.qr(rng.standard_normal((ROWS, 3)))[0].T
    level, speed = (
        BY_EFFECT["stribeck"]["extra_static_level"][0],
        BY_EFFECT["stribeck"]["stribeck_velocity"][0],
    )
    columns = [three + also * one, one / level, (0.5 * one + little * two) / speed]
    known = model("coulomb", "stribeck", **changed)
    fit = fitted(known, "coulomb", "stribeck", columns=np.column_stack(columns) * scale)
    fit.scale = np.array(scale)
    return fit


OPEN = {"extra_static_level": (0.5, 0.6), "stribeck_velocity": (0.1, 0.24)}


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (5.0, 1e3, 1e-3)])
def test_the_product_of_a_valley_is_estimated_whatever_the_units(scale):
    product = product_of(valley(scale=scale, **OPEN), "device.stribeck")
    assert product.names == (
        "device.stribeck.extra_static_level",
        "device.stribeck.stribeck_velocity",
    )
    assert product.powers == pytest.approx((1.0, 0.5), rel=0.02)
    assert product.errors == pytest.approx((1.2, 2.4))
    assert product.known < 0.1
    assert str(product) == "extra_static_level * stribeck_velocity^0.5"


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (5.0, 1e3, 1e-3)])
@pytest.mark.parametrize(("little", "is_known"), [(0.0, False), (1e-9, False), (1e-4, True)])
def test_two_parameters_of_one_change_tell_no_product(little, is_known, scale):
    """A pseudo-inverse called the open combination known: level * speed^-0.5 within 1e-8."""
    product = product_of(valley(little=little, scale=scale, **OPEN), "device.stribeck")
    assert (product is not None) == is_known
    if is_known:
        assert product.powers == pytest.approx((1.0, 0.5), rel=0.02)
