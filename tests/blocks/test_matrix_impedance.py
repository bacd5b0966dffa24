"""A linear impedance between several motions: its law, its matrix over s, its entries by name."""

import numpy as np
import pytest
import sympy as sp

from teleopdesign.base.errors import ModelError
from teleopdesign.blocks import matrix_impedance

MASS = [[0.2, 0.05], [0.05, 0.3]]
STIFFNESS = [[300.0, -40.0], [-40.0, 200.0]]


def made():
    return matrix_impedance(mass=MASS, damping=2.0, stiffness=STIFFNESS)


def test_forces_along_exponential_motions_are_the_matrix_times_the_motions():
    """x_j = X_j e^(s t) at t = 0: velocity s X_j, acceleration s^2 X_j."""
    s, size = 1.0 + 20.0j, np.array([1e-3, -2e-3])
    motions = [(x, s * x, s**2 * x) for x in size.tolist()]
    impedance = made()
    forces = impedance.forces(motions, lambda name: sp.Float(impedance.parameters[name]))
    expected = impedance.over(np.array([s]))[0] @ size
    # double precision over four products
    np.testing.assert_allclose(np.array(forces, dtype=complex), expected, rtol=1e-12)
    entry = complex(impedance.entry(0, 1, sp.Symbol("s")).subs("s", s))
    assert entry == pytest.approx(complex(impedance.over(np.array([s]))[0, 0, 1]), rel=1e-12)


def test_one_number_stands_on_the_diagonal_and_what_is_zero_is_no_parameter():
    names = set(made().parameters)
    assert {"damping_1_1", "damping_2_2", "stiffness_1_2"} <= names
    assert "damping_1_2" not in names


def test_a_value_of_an_entry_changes_that_entry_alone():
    changed = made().with_values({"stiffness_1_2": -50.0})
    assert changed.parameters == {**made().parameters, "stiffness_1_2": -50.0}
    with pytest.raises(ModelError, match='no entry "stifness_1_2"; did you mean "stiffness_1_2"'):
        made().with_values({"stifness_1_2": 1.0})


@pytest.mark.parametrize(
    ("matrices", "message"),
    [
        ({}, "expected square matrices of one size"),
        ({"mass": 1.0}, "expected square matrices of one size"),
        ({"mass": np.eye(2), "damping": np.eye(3)}, "expected square matrices of one size"),
        ({"mass": [[1.0, 2.0]]}, "no 1 x 1 matrix"),
        ({"mass": [[1.0], [2.0, 3.0]]}, "expected a square matrix, or a number"),
        ({"mass": np.eye(2) * np.nan}, "expected a square matrix, or a number"),
    ],
)
def test_what_is_no_square_matrix_is_refused_in_one_line(matrices, message):
    with pytest.raises(ModelError, match=message) as caught:
        matrix_impedance(**matrices)
    assert "\n" not in str(caught.value)
