"""What has no exact step in a computer is refused there, and steps that are exact agree with C."""

import numpy as np
import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import ControlLaw, ControllerState, controller
from teleopdesign.effects import Parameter
from teleopdesign.realise.c_header import as_c_header

GAIN = {"g": Parameter("stiffness", "g")}


def law(**states):
    made = ControlLaw(law=lambda now, p: p.g * now.a, states=states, parameters=GAIN)
    return controller(made.named("mine", "x"), {"g": 100.0})


COUPLED = law(
    a=ControllerState("position", lambda now, p: now.b),
    b=ControllerState("velocity", lambda now, p: now.input - now.a),
)
BENT = law(a=ControllerState("position", lambda now, p: now.input - 4 * now.a**3))


@pytest.mark.parametrize(("bad", "why"), [(COUPLED, "depends on other"), (BENT, "is not affine")])
def test_a_rate_without_an_exact_step_runs_in_continuous_time_alone(bad, why):
    diagram = td.haptic_interface(body(viscous__damping=1.0), cancellation=bad)
    for run in (
        lambda: td.simulate_diagram(diagram, duration=0.01),
        lambda: td.to_iosystem(diagram, dt=1e-3),
        lambda: as_c_header(bad, period=1e-3, name="law"),
    ):
        with pytest.raises(ModelError, match=why):
            run()
    td.simulate_diagram(diagram, duration=0.01, computer="continuous")


def test_a_state_that_hides_a_signal_is_refused():
    with pytest.raises(ModelError, match="state input has the name of a signal"):
        law(input=ControllerState("position", lambda now, p: now.velocity))


@pytest.mark.parametrize("seed", [0.0, 0.25, 0.5, 0.75, 1.0, 0.37])
def test_a_lossy_hold_loses_its_share_whatever_the_seed(seed):
    lossy = controller("lossy_hold", {"share": 0.3, "seed": seed})
    whole = controller("gain", {"gain": 1.0}).then(lossy)
    diagram = td.haptic_interface(body(viscous__damping=1.0), cancellation=whole)
    run = td.simulate_diagram(
        diagram, duration=3.0, motion={"L": td.sine(amplitude=0.01, frequency=1.0)}
    )
    lost = np.mean(np.abs(run["R_MBC"].values - run["L"].values) > 1e-15)
    assert lost == pytest.approx(0.3, abs=0.03)
