"""Bands of a fitted device's response, and its recorded impedance, on a device that is known."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from diagnose.linear_records import STEP, experiment, fitted, recordings, true_response

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.diagnose.covariance import covariance_in_blocks
from teleopdesign.measurement.prepare import prepare

IMPEDANCE = {"output": "E", "input": "L", "given": "L"}


def response(model, covariance, frequency):
    device = td.haptic_interface(model.body("device"))
    return td.bode(device, frequency=frequency, covariance=covariance, **IMPEDANCE)


@pytest.fixture(scope="module")
def recorded():
    time, command, position = recordings(1, seconds=16.0)
    return experiment(time, command[0], position[0])


def test_a_covariance_has_the_standard_errors_and_correlations_of_the_fit(recorded):
    fit = fitted(recorded)
    covariance = covariance_in_blocks(fit.model, prepare(recorded), {"Z_M": "device"})
    assert covariance.names == ("Z_M.inertia", "Z_M.viscous.damping", "Z_M.spring.stiffness")
    errors = [fit.model.parameters[name].stderr for name in fit.free]
    np.testing.assert_allclose(np.sqrt(np.diag(covariance.matrix)), errors, rtol=1e-9)
    stiffness, mass = fit.free[2], fit.free[0]
    expected = covariance.matrix[0, 2] / (errors[0] * errors[2])
    assert fit.correlations[stiffness, mass] == pytest.approx(expected)
    with pytest.raises(ModelError, match="rod"):
        covariance_in_blocks(fit.model, prepare(recorded), {"Z_M": "rod"})


def test_a_comparison_has_the_band_and_the_recorded_impedance_in_one_figure(recorded):
    comparison = td.compare(fitted(recorded).model, recorded)
    frequency = np.geomspace(0.5, 20.0, 30)
    derived = response(comparison.model, comparison.covariance(), frequency)
    measured = comparison.impedance()
    known = np.isfinite(measured.magnitude[0])
    true = np.abs(true_response(measured.frequency))
    off = np.abs(np.log(measured.magnitude[0] / true)) / measured.band.log_magnitude[0]
    assert known.sum() > 5 and np.mean(off[known] < 1.96) > 0.8
    figure = derived.plot(measured=measured)
    assert [a.get_ylabel() for a in figure.axes][-1] == "coherence (1)"
    plt.close(figure)


@pytest.mark.slow
def test_the_band_covers_the_true_response_in_95_percent_of_fits():
    frequency = np.array([0.3, 1.0, 2.8, 4.0, 8.0, 16.0])
    true, inside = true_response(frequency), []
    time, commands, positions = recordings(40)
    assert STEP * len(time) == 8.0
    for command, position in zip(commands, positions, strict=True):
        recorded = experiment(time, command, position)
        model = fitted(recorded).model
        made = response(model, covariance_in_blocks(model, prepare(recorded)), frequency)
        size = np.abs(np.log(made.magnitude[0] / np.abs(true))) / made.band.log_magnitude[0]
        phase = np.abs(np.angle(made.values() / true, deg=True)) / made.band.phase[0]
        inside.append([size < 1.96, phase < 1.96])
    coverage = np.mean(inside, axis=0)
    # 40 fits: a share of 95 % has a standard deviation of 3.4 % at each frequency
    assert (coverage > 0.82).all(), coverage
    assert 0.90 < coverage.mean() < 0.99, coverage
