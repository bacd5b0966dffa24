"""What a claim about Dahl compensation rests on: bounds, or estimates; equality in small motion."""

from types import SimpleNamespace

import pytest

from teleopdesign.passivity import dahl_compensation
from teleopdesign.passivity.theorems.dahl_compensation import dahl_claim


def interval(low, estimate, high):
    return SimpleNamespace(low=low, estimate=estimate, high=high)


def device(presliding=True):
    return SimpleNamespace(
        lowest=interval(0.41, 0.42, 0.43),
        highest=interval(0.51, 0.52, 0.53),
        presliding=interval(2.1e4, 2.2e4, 2.3e4) if presliding else None,
        bristle_damping=interval(0.11, 0.12, 0.13),
        damping=interval(0.61, 0.62, 0.63),
    )


@pytest.mark.parametrize(
    ("certain", "friction", "damping"),
    [
        (True, "0.41 to 0.53 N, 21000 N/m", "bristle damping 0.13 and viscous damping 0.61 N s/m"),
        (False, "0.42 to 0.52 N, 22000 N/m", "bristle damping 0.12 and viscous damping 0.62 N s/m"),
    ],
)
def test_a_claim_for_all_values_takes_the_worst_of_each_and_one_at_the_estimates_these(
    certain, friction, damping
):
    claim = dahl_claim(device(), 0.3, 1e4, certain=certain)
    assert claim.status == "proved"
    assert friction in claim.statement and damping in claim.statement
    level = "0.41" if certain else "0.42"
    plain = dahl_claim(device(presliding=False), 0.3, 1e4, certain=certain)
    assert f"Coulomb friction {level} N" in plain.statement and "bristle" not in plain.statement
    assert claim.verdict.margin == plain.verdict.margin == pytest.approx(float(level) - 0.3)


@pytest.mark.parametrize(
    ("stiffness", "presliding", "level", "highest", "is_equal"),
    [
        (1e4, 2e4, 0.125, 0.5, True),  # 1 * 0.5 = 4 * 0.125
        (1e4, 2e4, 0.125, 0.499, False),
        (1e4, 2e4, 0.13, 0.5, False),
        (2e4, 2e4, 0.5, 0.5, True),
        (5.0, 10.0, 0.125, 0.5, True),
        (1e4, 3e4, 0.3, 0.5, False),
    ],
)
def test_small_motion_is_named_where_there_the_two_losses_are_equal(
    stiffness, presliding, level, highest, is_equal
):
    """A stroke a loses sigma^2 a^3 / f: sigma_D^2 / f_D of the one, sigma_p^2 / f of the other."""
    claim = dahl_compensation(
        coulomb_level=highest,
        compensator_level=level,
        compensator_stiffness=stiffness,
        presliding_stiffness=presliding,
        highest_level=highest,
    )
    assert claim.status == "proved"
    assert ("small motion" in str(claim)) is is_equal
