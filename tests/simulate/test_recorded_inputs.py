"""Recorded signals as inputs, systems of python-control as blocks, and the give of friction."""

import control
import numpy as np
import pytest

import teleopdesign as td


def rod():
    body = td.Body("prismatic", {"inertia": 2.0})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": 3.0})
    return body.with_effect(td.EFFECTS["viscous"], {"damping": 0.5})


def test_a_pair_of_times_and_samples_is_an_input_on_any_grid():
    times = np.linspace(0.0, 1.0, 11)
    samples = 6.0 * times
    runs = [
        td.simulate_diagram(td.haptic_interface(rod()), duration=1.0, inputs={"R_D": force})
        for force in ((times, samples), lambda t: 6.0 * t)
    ]
    np.testing.assert_allclose(runs[0]["L"], runs[1]["L"], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    "pair, part",
    [
        ((np.linspace(0, 0.2, 5), np.ones(5)), "its times are 0 to 0.2 s"),
        ((np.linspace(0, 1, 5), np.ones(4)), "two rows of one length"),
        ((np.array([0.0, 0.5, 0.4, 1.0]), np.ones(4)), "do not rise"),
    ],
)
def test_a_pair_that_does_not_fit_is_one_line(pair, part):
    with pytest.raises(td.ModelError) as refused:
        td.simulate_diagram(td.haptic_interface(rod()), duration=1.0, inputs={"R_D": pair})
    assert part in str(refused.value) and '"R_D"' in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_transfer_function_as_a_block_hears_of_from_control():
    with pytest.raises(td.ModelError, match="td.from_control"):
        td.haptic_interface(rod(), force_feedback=control.tf([1], [0.1, 1]))


def test_the_error_estimate_says_what_the_give_of_friction_changes():
    """2 kg, 3 N, pulled by 6 N for 1 s: exact 0.69122 m; a bristle that gives 1e-5 m is off."""
    run = td.simulate_diagram(
        td.haptic_interface(rod()), duration=1.0, inputs={"R_D": 6.0}, estimate_error=True
    )
    off = abs(float(run["L"][-1]) - 0.69122)
    # a tenth of the give leaves a tenth of the error, or a third where it grows with its root
    assert 0.5 * off < run["L"].attrs["give_error"] * 0.69 < 2 * off
