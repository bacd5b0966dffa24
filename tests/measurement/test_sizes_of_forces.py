"""A column with the size of a force that takes both signs, such as a servo's supply current."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, look

from teleopdesign.measurement.first_guess import is_size

H = float(T[1])
V = np.gradient(Q, T)
A = np.gradient(V, T)
NOISE = 0.02 * np.random.default_rng(2).standard_normal(len(T))
SERVO = 0.1 + np.abs(0.02 * A + 0.1 * np.sign(V) + 0.08 * V) + np.abs(NOISE)


@pytest.mark.parametrize(
    ("force", "expected"),
    [
        (SERVO, True),
        (np.abs(A), True),
        (0.02 * A + 0.3 * np.sign(V), False),
        (5.0 + 0.02 * A + 0.3 * np.sign(V) + NOISE, False),
        (4.0 + 2.0 * Q + 0.3 * np.sign(V) + NOISE, False),
        (3.0 * np.cos(Q) + 0.3 * np.sign(V) + NOISE, False),  # slow where its load is least
        (5.0 + NOISE, False),
        (np.full(len(T), 2.0), False),
    ],
)
def test_only_the_size_of_the_motion_explains_the_size_of_a_force(force, expected):
    assert is_size(force, Q, H) == expected
    assert is_size(1e3 * force, -20.0 * Q, H) == expected


def test_a_force_with_both_signs_or_in_one_direction_is_no_size():
    assert not is_size(SERVO - 0.5, Q, H)
    assert not is_size(SERVO, Q + 20.0 * T, H)
    assert not is_size(SERVO[:99], Q[:99], H), "too short to say"
    assert not is_size(np.full(len(T), 1e200) * (1 + SERVO), Q, H)


def test_a_log_of_sizes_says_so_beside_any_other_guess():
    survey = look({"t": T, "angle": Q, "current_A": SERVO})
    says = survey.guesses["channels.actuator_force.column"]
    assert says.startswith("'current_A' seems to hold the size of a force without its sign")
    survey = look({"t": T, "angle": Q, "x2": SERVO}, actuator_force="x2")
    assert "without its sign" in survey.guesses["channels.actuator_force.column"]
    signed = look({"t": T, "angle": Q, "current_A": 0.02 * A + 0.3 * np.sign(V)})
    assert "channels.actuator_force.column" not in signed.guesses
