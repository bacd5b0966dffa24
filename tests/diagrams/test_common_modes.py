"""A matrix of transfer functions whose entries share a mode that does not decay has it once."""

import control
import numpy as np
import pytest
from devices import two_rods

from teleopdesign.base.errors import ModelError
from teleopdesign.diagrams import with_shared_states
from teleopdesign.diagrams.common_modes import with_common_modes

GROWS = [1.0, -0.5]


def matrix(numerators, below):
    return control.tf(numerators, [[below] * 2] * 2)


@pytest.mark.parametrize(
    ("system", "states"),
    [
        (matrix([[[2.0], [4.0]], [[1.0], [2.0]]], GROWS), 1),  # a residue of rank 1
        (matrix([[[2.0], [4.0]], [[1.0], [3.0]]], GROWS), 2),
        (matrix([[[2.0, 1.0], [4.0]], [[1.0], [2.0, 0.25]]], GROWS), 2),
        (matrix([[[2.0], [1.0]], [[3.0], [2.0]]], [1.0, 0.0]), 2),
        (control.tf([[[1.0], [1.0, 1.0]], [[2.0], [1.0]]],
                    [[GROWS, [1.0, 0.5, -0.5]], [GROWS, [1.0, 2.0]]]), 3),
        (matrix([[[1.0], [0.5]], [[0.25], [1.0]]], [1.0, 0.0, 4.0]), 4),
    ],
)  # fmt: skip
def test_common_modes_are_there_as_often_as_the_matrix_has_them(system, states):
    made = with_common_modes(system, name="K")
    assert made.nstates == states
    for s in (0.3j, 1.0 + 2.0j):
        np.testing.assert_allclose(made(s), system(s), rtol=1e-12, atol=1e-15)


def test_a_discrete_matrix_with_an_accumulator_has_it_once():
    system = control.tf([[[1.0], [2.0]], [[1.0], [2.0]]], [[[1.0, -1.0]] * 2] * 2, 0.01)
    made = with_common_modes(system, name="K")
    assert made.nstates == 1
    assert made.dt == 0.01


@pytest.mark.parametrize("below", [[1.0, 2.0], [1.0, 0.2, 4.0]])
def test_modes_that_decay_stay_as_they_are_written(below):
    system = matrix([[[1.0], [2.0]], [[3.0], [4.0]]], below)
    assert with_common_modes(system, name="K") is system


def test_a_growing_mode_that_no_decimals_write_is_refused_with_its_rate():
    system = matrix([[[2.0], [1.0]], [[3.0], [2.0]]], [3.0, -1.0])
    with pytest.raises(ModelError, match="K: entries share a mode that grows, at 0.3333"):
        with_common_modes(system, name="K")


def test_a_controller_that_grows_by_itself_closes_its_loop_as_its_matrix_says():
    """One mode at 0.5 1/s that both rods drive and feel: its loop has it once, not four times."""
    diagram = two_rods(matrix([[[2.0], [4.0]], [[1.0], [2.0]]], GROWS))
    states = [b.name for b in with_shared_states(diagram).blocks if "state" in b.name]
    assert len(states) == 1
