"""More ports than two: passive together, by the exact test of the matrix."""

import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.blocks import matrix_impedance
from teleopdesign.diagrams import (
    Diagram,
    Linked,
    Moving,
)
from teleopdesign.passivity import diagram_claims
from teleopdesign.passivity.linear.family import family_of_matrix
from teleopdesign.passivity.linear.judge import passive_claim
from teleopdesign.realise.lti import S

STAR = 1000.0 * (3 * np.eye(3) - np.ones((3, 3)))


def star(stiffness, **effects):
    """Bodies joined by a matrix of springs, each with a port."""
    numbers = range(1, len(stiffness) + 1)
    one = body(0.3, viscous__damping=2.0, **effects)
    bodies = (
        Moving(f"Z{n}", one, f"x{n}", f"u{n}", {f"f{n}": 1.0, f"g{n}": 1.0}, f"f{n}")
        for n in numbers
    )
    springs = matrix_impedance(stiffness=np.asarray(stiffness).tolist())
    ends = (tuple(f"{letter}{n}" for n in numbers) for letter in "xg")
    forces = {f"{letter}{n}": "force" for letter in "uf" for n in numbers}
    return Diagram("star", (*bodies, Linked("K", springs, *ends)), (), forces, ())


def whole(diagram):
    return diagram_claims(diagram, rng=np.random.default_rng(0)).claims[-1].claim


def test_three_arms_joined_by_springs_are_proved_passive_together():
    claim = whole(star(STAR))
    assert claim.status == "proved"
    assert "positive real" in claim.certificates[0].check()


def random_matrix(rng, size, less):
    """Sums of rank one times passive parts, on whole numbers; less: damping taken at a port."""
    z = sp.zeros(size)
    for shape in (S, sp.S(1), 1 / S, 1 / (S + 2), S / (S**2 + 3)):
        v = sp.Matrix(rng.integers(-2, 3, size).tolist())
        z += shape * v * v.T
    z[0, 0] -= less
    return z


@pytest.mark.slow
@pytest.mark.parametrize("size", [3, 4])
def test_no_wave_beats_what_is_proved_and_each_refutation_is_one(size):
    """Against eigenvalues of Z + Z^H at random points of the right half plane."""
    rng = np.random.default_rng(size)
    points = 10.0 ** rng.uniform(-3, 3, 4000) * np.exp(0.5j * np.pi * rng.random(4000))
    kinds = set()
    for less in (0, sp.Rational(1, 50), 3):
        z = random_matrix(rng, size, less)
        claim = passive_claim(family_of_matrix(sp.ImmutableMatrix(z)))
        values = np.array(sp.lambdify(S, z.tolist(), "numpy")(points), dtype=object)
        values = np.array([[np.broadcast_to(e, points.shape) for e in row] for row in values])
        values = np.moveaxis(values.astype(complex), 2, 0)
        lowest = np.linalg.eigvalsh(values + values.conj().transpose(0, 2, 1))[:, 0]
        # rounding of eigenvalues: sixteen digits of the largest entry, some times over
        beaten = (lowest < -1e-12 * np.abs(values).max(axis=(1, 2))).any()
        assert not (claim.status == "proved" and beaten)
        assert not (claim.status == "refuted" and claim.record.replay() <= 0)
        kinds.add(claim.status)
    assert kinds >= {"proved", "refuted"}
