"""A disturbance observer: its closed form, its delay margin, and what it does to friction."""

import numpy as np
import pytest
import sympy as sp
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.derive import transfer_function
from teleopdesign.diagrams import (
    Diagram,
    Junction,
    Moving,
    disturbance_observer,
    haptic_interface,
    read_diagram,
    teleoperator,
    write_diagram,
)
from teleopdesign.frequency import delay_margin, loop_gain
from teleopdesign.passivity import diagram_claims, ports
from teleopdesign.passivity.linear.family import family_at
from teleopdesign.realise.lti import S
from teleopdesign.simulate import simulate

BANDWIDTH = 20.0
POLE = 2 * np.pi * BANDWIDTH


def axis(made):
    """A body with a commanded force from outside, and a port."""
    return Diagram(
        "axis",
        (Moving("M", made, "x", "u", {"f": 1}, "f"),),
        (Junction("u", {"w": 1}),),
        {"f": "force", "w": "force"},
        measured=("x",),
    )


def observed(made, *, inertia, damping=0.0):
    return disturbance_observer(
        axis(made), body="M", inertia=inertia, damping=damping, bandwidth=BANDWIDTH
    )


sizes = st.floats(0.05, 5.0).map(lambda x: round(x, 3))


@pytest.mark.slow
@settings(max_examples=4)
@given(mass=sizes, viscous=sizes, inertia=sizes, damping=sizes)
def test_to_its_port_it_is_a_damper_and_a_spring(mass, viscous, inertia, damping):
    """Z = M s + B + g (M_n + B_n/s), passive for any nominal body; 1e-12: rounding of pi."""
    made = observed(body(mass, viscous__damping=viscous), inertia=inertia, damping=damping)
    form = family_at(made, ports(made)).z[0, 0]
    for s in (0.3 + 2j, 40j, 5.0):
        expected = mass * s + viscous + POLE * (inertia + damping / s)
        assert complex(form.subs(S, s)) == pytest.approx(expected, rel=1e-12)
    claims = diagram_claims(made, rng=np.random.default_rng(0)).claims
    assert [one.claim.status for one in claims] == ["proved"]


def test_of_the_true_inertia_the_command_moves_the_body_as_without_friction():
    made = observed(body(0.4, viscous__damping=3.0), inertia=0.4, damping=3.0)
    moved, _ = transfer_function(made, output="x", input="w")
    for s in (1j, 30j, 400j):
        assert moved(s) == pytest.approx(1 / (0.4 * s**2 + 3.0 * s), rel=1e-9)


@settings(max_examples=6)
@given(mass=sizes, inertia=sizes)
def test_its_loop_bears_the_delay_of_an_integrator(mass, inertia):
    """Gain g M_n/(M s): a quarter of a turn at its crossover."""
    loop = loop_gain(observed(body(mass), inertia=inertia), controller="N_M")
    assert sp.simplify(loop.expression * S * sp.nsimplify(mass)).is_number
    assert delay_margin(loop) == pytest.approx(np.pi / 2 / (POLE * inertia / mass), rel=1e-6)


def test_it_goes_around_the_bodies_of_shipped_wirings_and_into_files(tmp_path):
    made = body(0.3, viscous__damping=1.0)
    spring = controller("spring_damper", {"stiffness": 100.0, "damping": 2.0})
    for diagram, name in (
        (teleoperator(made, made, coupling=spring), "Z_s"),
        (haptic_interface(made, cancellation=spring), "Z_M"),
        (haptic_interface(made), "Z_M"),
    ):
        other = disturbance_observer(diagram, body=name, inertia=0.2, bandwidth=5.0)
        write_diagram(other, tmp_path / "loop.toml")
        assert read_diagram(tmp_path / "loop.toml") == other
        assert simulate(other, duration=0.01, jit=False)[f"d_{name}"].attrs["units"] == "N"
        with pytest.raises(ModelError, match="already"):
            disturbance_observer(other, body=name, inertia=0.2, bandwidth=5.0)
    with pytest.raises(ModelError, match="no body that forces move"):
        disturbance_observer(teleoperator(made, made), body="P", inertia=0.2, bandwidth=5.0)
