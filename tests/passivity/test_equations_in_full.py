"""The equations in full of a linear diagram have the poles that python-control finds of it."""

import control as ct
import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.derive.all_states import all_states
from teleopdesign.derive.polynomials import as_poly
from teleopdesign.diagrams import Attached, Control, Diagram, Junction, Moving, teleoperator
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.realise.lti import S

LAG = controller("low_pass", {"bandwidth": 20.0})
LEAD = controller("lead", {"gain": 60.0, "zero": 3.0, "pole": 90.0})
SPRING = controller("spring_damper", {"stiffness": 150.0, "damping": 2.0})
HALF = controller("gain", {"gain": 0.5})


def looped(law, analog=True, **effects):
    """A damped mass that a controller holds."""
    return Diagram(
        "looped",
        (
            Moving("M", body(0.2, viscous__damping=1.0, **effects), "x", "u", {"f": 1}, "f"),
            Control("P", law, "x", "F", "x", analog=analog),
        ),
        (Junction("u", {"F": -1}),),
        {"f": "force"},
        measured=("x",),
    )


def carried(law, sign):
    """A damped mass that a controller holds, with another body on it; sign: of its force."""
    load = body(0.1, viscous__damping=0.5, spring__stiffness=20.0)
    return Diagram(
        "carried",
        (
            Moving("M", body(0.4, viscous__damping=1.0), "x", "u", {"f": 1, "g": -sign}, "f"),
            Attached("Z", load, "x", "g", sign),
            Control("P", law, "x", "F", "x", analog=True),
        ),
        (Junction("u", {"F": -1}),),
        {"f": "force"},
        measured=("x",),
    )


DIAGRAMS = {
    "a spring": looped(SPRING),
    "a lead": looped(LEAD),
    "a lead behind a lag": looped(LAG.then(LEAD)),
    "half a lead behind a lag": looped(HALF.then(LAG).then(LEAD)),
    "a lag behind a spring": looped(SPRING.then(LAG)),
    "two devices": teleoperator(
        body(0.2, viscous__damping=1.0), body(0.3, viscous__damping=2.0), coupling=LAG.then(SPRING)
    ),
    "two lags of the drive": looped(
        SPRING, actuator_lag__time_constant=0.02, actuator_gain__gain=0.8
    ),
    "a lag of the drive and a leaking film": looped(LEAD, actuator_lag__time_constant=0.05),
    "something that is carried": carried(SPRING, 1),
    "something that pulls the other way": carried(LEAD, -1),
    "a delay of no time": looped(controller("delay", {"time": 0.0}).then(SPRING)),
}


@pytest.mark.parametrize("name", DIAGRAMS)
def test_the_determinant_has_the_poles_of_the_closed_loop_and_no_others(name):
    diagram = DIAGRAMS[name]
    roots = np.roots([float(c) for c in as_poly(all_states(diagram).determinant(), S).all_coeffs()])
    system = to_iosystem(diagram)
    linear = ct.linearize(system, np.zeros(system.nstates), np.zeros(system.ninputs))
    expected = list(np.linalg.eigvals(linear.A))
    assert len(roots) == len(expected)
    for pole in roots:
        k = int(np.argmin(np.abs(np.array(expected) - pole)))
        assert abs(expected.pop(k) - pole) < 1e-4 * (1 + abs(pole))
