"""The forces that links need: against a Lagrangian, energy, and an independent simulator."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
import sympy as sp
from arms.arm_simulator import SimulatedArm, forces, random_arm, urdf
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.arms import (
    Chain,
    Link,
    base_parameters,
    force_columns,
    inertia_about,
    read_urdf,
    rotation_of,
)

#: of a force: double precision over some hundred products
ROUNDING = 1e-9


def arm_of(simulated: SimulatedArm) -> Chain:
    links = [
        Link(
            name=f"link{i + 1}",
            joint=f"joint{i + 1}",
            kind=simulated.kinds[i],
            axis=simulated.axes[i],
            rotation=rotation_of(*simulated.angles[i]),
            origin=simulated.origins[i],
            inertial=inertia_about(simulated.masses[i], simulated.centres[i], simulated.moments[i]),
        )
        for i in range(simulated.count)
    ]
    return Chain(tuple(links))


@lru_cache(maxsize=2)
def lagrangian(spatial: bool):
    """Joint forces of an arm by Lagrange's equations: planar of two joints, or spatial of three.

    returns: f(q..., v..., a...) -> forces, the arm as the package has it
    """
    count = 3 if spatial else 2
    axes = [(0, 0, 1), (0, 1, 0), (1, 0, 0)] if spatial else [(0, 1, 0), (0, 1, 0)]
    kinds = ["revolute", "revolute", "prismatic"] if spatial else ["revolute"] * 2
    origins = [(0, 0, 0.3), (0.1, 0, 0.4), (0.0, 0.2, 0.1)][:count]
    centres = [(0.02, 0.03, 0.2), (0.1, -0.05, 0.15), (0.05, 0.02, 0.1)][:count]
    masses = [4, 2.5, 1.5][:count]
    moments = [(0.03, 0.05, 0.02), (0.02, 0.01, 0.04), (0.01, 0.02, 0.015)][:count]
    names = sp.symbols(f"x:{count} v:{count} a:{count}")
    q, v, a = names[:count], names[count : 2 * count], names[2 * count :]

    def rate(expression):
        """Derivative over time, by the chain rule."""
        pairs = [*zip(q, v, strict=True), *zip(v, a, strict=True)]
        return sum((expression.diff(x) * dx for x, dx in pairs), 0 * expression)

    turn, place, kinetic, potential = sp.eye(3), sp.zeros(3, 1), sp.S(0), sp.S(0)
    for i in range(count):
        place = place + turn * sp.Matrix(origins[i])
        x, y, z = axes[i]
        if kinds[i] == "prismatic":
            place = place + turn * sp.Matrix(axes[i]) * q[i]
        else:
            k = sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            turn = turn * (sp.eye(3) + sp.sin(q[i]) * k + (1 - sp.cos(q[i])) * k * k)
        centre = place + turn * sp.Matrix(centres[i])
        speed, turning = rate(centre), turn.T * rate(turn)
        spin = sp.Matrix([turning[2, 1], turning[0, 2], turning[1, 0]])
        kinetic += masses[i] * speed.dot(speed) / 2
        kinetic += (spin.T * sp.diag(*moments[i]) * spin)[0] / 2
        potential += masses[i] * 9.80665 * centre[2]
    lagrange = kinetic - potential
    values = [rate(lagrange.diff(v[i])) - lagrange.diff(q[i]) for i in range(count)]
    links = [
        Link(
            f"link{i}",
            f"joint{i}",
            kinds[i],
            np.array(axes[i], float),
            np.eye(3),
            np.array(origins[i], float),
            inertia_about(masses[i], np.array(centres[i]), np.diag(moments[i])),
        )
        for i in range(count)
    ]
    return sp.lambdify(names, values, "numpy", cse=True), Chain(tuple(links))


@pytest.mark.slow
@pytest.mark.parametrize("spatial", [False, True])
def test_forces_are_those_of_lagranges_equations(spatial):
    call, arm = lagrangian(spatial)
    q, v, a = np.random.default_rng(1).normal(size=(3, len(arm.links), 20))
    expected = np.array(call(*q, *v, *a))
    got = np.einsum("kpn,p->kn", force_columns(arm, q, v, a), arm.inertial)
    assert np.allclose(got, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())


@given(count=st.integers(1, 6), seed=st.integers(0, 10_000), prismatic=st.booleans())
def test_forces_are_those_of_an_independent_simulator(count, seed, prismatic):
    generator = np.random.default_rng(seed)
    simulated = random_arm(generator, count, prismatic=prismatic)
    q, v, a = generator.normal(size=(3, count, 4))
    expected = forces(simulated, q, v, a)
    arm = arm_of(simulated)
    got = np.einsum("kpn,p->kn", force_columns(arm, q, v, a), arm.inertial)
    assert np.allclose(got, expected, rtol=0, atol=ROUNDING * max(np.abs(expected).max(), 1.0))


@given(count=st.integers(1, 6), seed=st.integers(0, 1000))
def test_base_parameters_say_all_that_the_links_do(count, seed):
    generator = np.random.default_rng(seed)
    arm = arm_of(random_arm(generator, count))
    base = base_parameters(arm)
    q, v, a = generator.normal(size=(3, count, 5))
    columns = force_columns(arm, q, v, a)
    expected = np.einsum("kpn,p->kn", columns, arm.inertial)
    motors = np.eye(count)[:, :, None] * a[:, None, :]
    chosen = np.concatenate([columns, motors], axis=1)[:, base.chosen]
    got = np.einsum("kbn,b->kn", chosen, base.initial)
    assert np.allclose(got, expected, rtol=0, atol=1e-7 * max(np.abs(expected).max(), 1.0))
    assert len(base.names) == len(set(base.names)) <= 11 * count


@given(count=st.integers(1, 6), seed=st.integers(0, 1000))
def test_a_urdf_reads_as_the_arm_that_it_describes(count, seed, tmp_path_factory):
    simulated = random_arm(np.random.default_rng(seed), count, prismatic=True)
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(urdf(simulated, inertial=True))
    arm = read_urdf(path, "arm.urdf", [f"axis{i + 1}" for i in range(count)])
    q, v, a = np.random.default_rng(seed).normal(size=(3, count, 3))
    got = np.einsum("kpn,p->kn", force_columns(arm, q, v, a), arm.inertial)
    expected = forces(simulated, q, v, a)
    assert np.allclose(got, expected, rtol=0, atol=ROUNDING * max(np.abs(expected).max(), 1.0))
