"""A column with the size of a force that takes both signs, such as a servo's supply current."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T

from teleopdesign.cli import main
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


def test_new_says_of_a_log_of_sizes_that_no_diagnosis_can_answer(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    signed = 0.02 * A + 0.3 * np.sign(V)
    for name, force, is_size_of in (("size", SERVO, True), ("signed", signed, False)):
        table = np.column_stack([T, Q, force])
        np.savetxt(f"{name}.csv", table, delimiter=",", header="t,angle,current_A", comments="")
        assert main(["new", f"{name}.csv", "--yes", "--torque-constant", "1 N*m/A"]) == 0
        assert ("Log it with its sign" in capsys.readouterr().out) == is_size_of
