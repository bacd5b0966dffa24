"""Bands of responses from the covariance of parameters, and responses of recorded signals."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.diagrams import four_cases, haptic_interface, world_haptics_2005
from teleopdesign.frequency import (
    ParameterCovariance,
    bode,
    quasi_linear_impedance,
    recorded_response,
)

F = np.array([0.5, 3.0, 20.0])
IMPEDANCE = {"output": "E", "input": "L", "given": "L"}
NAMES = ("Z_M.inertia", "Z_M.viscous.damping")


def band_of(mass, damping, matrix, **how):
    device = haptic_interface(body(mass, viscous__damping=damping))
    covariance = ParameterCovariance(NAMES, matrix)
    return bode(device, frequency=F, covariance=covariance, **IMPEDANCE, **how).band


@settings(max_examples=10)
@given(
    mass=st.floats(0.01, 10.0),
    damping=st.floats(0.1, 10.0),
    correlation=st.floats(-0.99, 0.99),
)
def test_the_band_is_that_of_the_derivatives_by_hand(mass, damping, correlation):
    errors = np.array([0.01 * mass, 0.05 * damping])
    matrix = np.outer(errors, errors) * np.array([[1, correlation], [correlation, 1]])
    band = band_of(mass, damping, matrix)
    s = 2j * np.pi * F
    slopes = np.array([s**2, s]) / (mass * s**2 + damping * s)
    for part, made in (
        (slopes.real, band.log_magnitude[0]),
        (slopes.imag, np.radians(band.phase[0])),
    ):
        expected = np.sqrt(np.einsum("pn,pq,qn->n", part, matrix, part))
        # the difference over a tenth of a standard error, 5 %, is off by its third derivative
        np.testing.assert_allclose(made, expected, rtol=2e-3, atol=1e-9)


def test_friction_at_a_speed_and_at_an_amplitude_widens_the_band():
    device = haptic_interface(body(0.15, coulomb__level=0.5))
    covariance = ParameterCovariance(("Z_M.coulomb.level",), np.array([[0.05**2]]))
    of_speed, of_amplitude = (
        bode(device, frequency=F, covariance=covariance, **IMPEDANCE, **how).band
        for how in ({"speed": 0.05}, {"amplitude": 0.002})
    )
    # where friction is most of the impedance, 10 % of it are 10 % of the magnitude
    assert of_speed.log_magnitude[0, 0] == pytest.approx(0.1, rel=0.02)
    assert of_amplitude.log_magnitude[0, 0] == pytest.approx(0.1, rel=0.02)
    assert of_amplitude.log_magnitude[0, -1] < 0.05


def test_impedances_have_bands_and_draw_them():
    cases = {name: four_cases(world_haptics_2005())[name] for name in ("none", "MBC")}
    covariance = ParameterCovariance(("Z_M.coulomb.level",), np.array([[0.02**2]]))
    bands = quasi_linear_impedance(
        cases, amplitude=[1e-3, 1e-2], frequency=F, covariance=covariance
    )
    assert bands.data["magnitude_error"].dims == bands.data["impedance"].dims
    # in slow motion, what a cancellation leaves is known less well than what was there
    left, there = (bands.data["magnitude_error"].sel(case=c).values for c in ("MBC", "none"))
    assert left[0, 0] > there[0, 0] > 0.01
    figure = bands.plot("frequency")
    assert len(figure.axes[0].collections) == len(cases)
    plt.close(figure)


def test_a_parameter_at_its_bound_has_a_one_sided_derivative():
    matrix = np.diag([0.01**2, 0.1**2])
    assert np.isfinite(band_of(0.15, 0.0, matrix).log_magnitude).all()


def test_a_covariance_of_another_diagram_is_refused():
    with pytest.raises(ModelError, match=r"Z_S\.inertia.*Z_M"):
        device = haptic_interface(body(0.15))
        bode(device, covariance=ParameterCovariance(("Z_S.inertia",), np.eye(1)))
    with pytest.raises(ModelError, match="shape"):
        ParameterCovariance(("Z_M.inertia",), np.eye(2))


def first_order(x, pole):
    y = np.zeros(len(x))
    for k in range(1, len(x)):
        y[k] = pole * y[k - 1] + (1 - pole) * x[k]
    return y


@pytest.mark.parametrize("noise", [0.0, 0.5])
def test_the_interval_of_a_recorded_response_contains_the_true_one(noise):
    rng, step, pole = np.random.default_rng(3), 1e-3, 0.97
    x = rng.standard_normal((4, 8000))
    y = np.array([first_order(one, pole) for one in x])
    read = x + noise * rng.standard_normal(x.shape)
    y = y + 0.02 * rng.standard_normal(y.shape)
    measured = recorded_response(list(read), list(y), sample_time=step)
    z = np.exp(-2j * np.pi * measured.frequency * step)
    true = (1 - pole) / (1 - pole * z)
    off = np.abs(np.log(measured.magnitude[0] / np.abs(true))) / measured.band.log_magnitude[0]
    turned = np.angle(measured.values() / true, deg=True) / measured.band.phase[0]
    assert np.mean(off < 1.96) > 0.85 and np.mean(np.abs(turned) < 1.96) > 0.85
    assert (measured.coherence[0, :5] > 0.7).all()


def test_signals_that_share_nothing_have_no_response():
    rng = np.random.default_rng(0)
    alone = recorded_response(*rng.standard_normal((2, 1, 20000)), sample_time=1e-3)
    assert np.isnan(alone.magnitude).mean() > 0.8
    with pytest.raises(ModelError, match="windows"):
        recorded_response([np.zeros(40)], [np.zeros(40)], sample_time=1e-3)
