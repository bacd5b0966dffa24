"""A delay that is simulated in whole steps: the result says which delay it took."""

import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError

LATE = body(0.1, viscous__damping=1.0, actuation_delay__delay=0.0)


def scheme(delay=0.0, *, actuator=0.0, computer=None):
    name = "Z_M.actuation_delay.delay"
    diagram = td.haptic_interface(LATE if actuator else body(0.1, viscous__damping=1.0))
    if actuator:
        diagram = diagram.with_values({name: actuator})
    made = td.simulate_diagram(
        diagram,
        duration=0.01,
        inputs={"R_D": 1.0},
        computer=computer or td.Sampling(delay=delay),
        jit=False,
    )
    return made.data.attrs["scheme"], repr(made)


@pytest.mark.parametrize("delay", [0.0, 1e-4, 2.1e-3, 0.0300000000001])
def test_a_whole_number_of_steps_needs_no_word(delay):
    assert all("whole steps" not in text for text in scheme(delay))


@pytest.mark.parametrize(
    ("delay", "words"),
    [(2.0738e-3, "2.1 ms for 2.0738 ms"), (5.04e-3, "5 ms for 5.04 ms")],
)
def test_a_rounded_delay_of_the_computer_is_stated(delay, words):
    assert all(f"delays in whole steps: {words}" in text for text in scheme(delay))


@pytest.mark.parametrize("computer", ["continuous", td.Sampling()])
def test_a_rounded_delay_of_an_actuator_is_stated(computer):
    text, _ = scheme(actuator=5.04e-3, computer=computer)
    assert text.endswith("delays in whole steps: 5 ms for 5.04 ms")


def test_a_delay_far_from_whole_steps_is_refused():
    with pytest.raises(ModelError, match="is no whole number of steps"):
        scheme(1.5e-4)
