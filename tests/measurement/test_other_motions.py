"""Tables without names that hold positions, speeds and torques of several joints."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, U, V, look

from teleopdesign.measurement.survey.other_motions import agreements, other_motions

H = float(T[1])
RANDOM = np.random.default_rng(7)
JOINTS = 4


def arm(noise):
    """Positions, speeds and torques (n, JOINTS) of joints that move alike under gravity."""
    places = [0.3 * np.sin((1 + 0.1 * j) * T + j) for j in range(JOINTS)]
    places[2] = Q
    speeds = [np.gradient(q, T) for q in places]
    speeds = [v + noise * np.ptp(v) * RANDOM.standard_normal(len(v)) for v in speeds]
    gravity = [5 * np.cos(q) + 0.5 * np.sign(v) for q, v in zip(places, speeds, strict=True)]
    torques = [u + 0.01 * RANDOM.standard_normal(len(T)) for u in gravity]
    torques[2] = U
    return np.column_stack(places), np.column_stack(speeds), np.column_stack(torques)


def nameless(table):
    return {f"column {k + 1}": column for k, column in enumerate(table.T)}


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize("order", ["by quantity", "by joint", "speeds last"])
def test_the_position_of_another_joint_is_no_force(noise, order):
    """The first column was the force of the second one: the motion explained 100 % of it."""
    q, v, u = arm(noise)
    if order == "by joint":
        table = np.hstack([np.column_stack([q[:, j], v[:, j], u[:, j]]) for j in range(JOINTS)])
    else:
        table = np.hstack([q, v, u] if order == "by quantity" else [q, u, v])
    columns = nameless(table)
    survey = look({"time": T, **columns})
    force = columns[survey.channels["actuator_force"]["column"]]
    position = columns[survey.channels["position"]["column"]]
    which = [j for j in range(JOINTS) if np.array_equal(q[:, j], position)]
    assert len(which) == 1
    assert any(np.array_equal(u[:, j], force) for j in range(JOINTS)), "a torque"
    assert len(survey.motions) == JOINTS - 1
    assert any("of another body" in why for why in survey.unused.values())


def test_a_spring_and_a_damper_keep_their_forces():
    """The force of a spring is nearly a copy of its position, and has its velocity, too."""
    noise = 0.01 * RANDOM.standard_normal(len(T))
    for force in (3.0 * Q + 0.05 * np.sign(V) + noise, 0.2 * V + 0.05 * np.sign(V) + noise):
        columns = {"column 1": Q, "column 2": V + 0.02 * RANDOM.standard_normal(len(T))}
        columns["column 3"] = force
        survey = look({"time": T, **columns})
        assert survey.channels["position"]["column"] == "column 1"
        assert survey.channels["actuator_force"]["column"] == "column 3"


def test_a_planned_path_is_no_other_body():
    """The friction of a body is nearly the derivative of the path that was planned for it."""
    columns = {"path": np.roll(Q, -2), "u": 0.02 * V + 0.3 * np.sign(V)}
    assert other_motions(agreements(columns, H), columns, Q, H) == {}
    assert other_motions({}, {}, Q, H) == {}
