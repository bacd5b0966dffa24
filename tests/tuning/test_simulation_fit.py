"""A simulation fitted to measured signals: known values come back, and what cannot is told."""

import pickle

import numpy as np
import pytest
import study_models as models
import xarray
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.simulate import sampled_motion

VALUES = {"Z_M.inertia": 0.15, "Z_M.viscous.damping": 2.0, "Z_M.spring.stiffness": 300.0}
INTERVALS = {
    "Z_M.inertia": (0.05, 0.5),
    "Z_M.viscous.damping": (0.1, 10.0),
    "Z_M.spring.stiffness": (50.0, 1000.0),
}
SPRUNG = td.haptic_interface(body(0.15, viscous__damping=2.0, spring__stiffness=300.0))
OTHER = SPRUNG.with_values(
    {"Z_M.inertia": 0.3, "Z_M.viscous.damping": 0.5, "Z_M.spring.stiffness": 900.0}
)
NOISE = 1e-5  # m


def push(time):
    """N"""
    return np.sin(2 * np.pi * 1.5 * time) + 0.5 * np.sin(2 * np.pi * 4.0 * time)


PUSHED = {"inputs": {"R_V": push}, "computer": "continuous"}


def measured(seed=0, duration=0.6, **settings):
    """Time and noisy position of the device with the known values."""
    simulation = td.simulate_diagram(SPRUNG, duration=duration, **{**PUSHED, **settings})
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(simulation.data["time"]))
    return {"time": simulation.data["time"].values, "L": simulation["L"].values + noise}


def test_known_values_come_back_from_far_away_within_their_errors():
    fitted = td.fit_simulation(OTHER, measured(), INTERVALS, **PUSHED)
    for name, value in VALUES.items():
        # four standard errors: one in 16 000
        assert abs(fitted.values[name] - value) < 4 * fitted.errors[name] < 0.01 * value
    assert fitted.diagram.values["Z_M.inertia"] == fitted.values["Z_M.inertia"]
    assert fitted.rms["L"] == pytest.approx(NOISE, rel=0.1)
    assert fitted.before["L"] > 0.5 and not fitted.at_ends and not fitted.undetermined
    assert "+-" in repr(fitted) and "kg" in repr(fitted)


@pytest.mark.slow
def test_standard_errors_are_as_large_as_errors_are():
    """24 recordings: mean square of 72 errors over their standard errors, expected 1."""
    near = OTHER.with_values({n: 1.02 * x for n, x in VALUES.items()})
    ratios = []
    for seed in range(24):
        fitted = td.fit_simulation(near, measured(seed), INTERVALS, starts=0, **PUSHED)
        ratios += [(fitted.values[n] - x) / fitted.errors[n] for n, x in VALUES.items()]
    # three correlated errors a recording count as one at least: 24 squares spread by 0.29
    assert 0.4 < np.mean(np.square(ratios)) < 1.9


def test_samples_between_those_of_the_simulation_and_gaps_are_taken():
    data = measured()
    kept = np.random.default_rng(1).random(len(data["time"])) < 0.4
    some = {"time": data["time"][kept], "L": data["L"][kept]}
    some["L"][5:9] = np.nan
    one = td.fit_simulation(OTHER, some, INTERVALS, **PUSHED)
    table = xarray.Dataset({"place": ("time", some["L"])}, {"time": some["time"]})
    two = td.fit_simulation(OTHER, table, INTERVALS, signals={"L": "place"}, **PUSHED)
    assert one.values == two.values
    for name, value in VALUES.items():
        assert abs(one.values[name] - value) < 4 * one.errors[name]


def test_what_moves_nothing_by_itself_is_not_determined():
    """A released mass: only ratios of inertia, damping and stiffness show."""
    held = {"initial": {"L": 5e-3}, "inputs": {}}
    fitted = td.fit_simulation(OTHER, measured(**held), INTERVALS, computer="continuous", **held)
    assert set(fitted.undetermined) == set(VALUES)
    assert np.isnan(list(fitted.errors.values())).all()
    assert "the data do not determine" in repr(fitted)
    ratio = fitted.values["Z_M.spring.stiffness"] / fitted.values["Z_M.inertia"]
    assert ratio == pytest.approx(2000.0, rel=1e-3)


def test_a_value_beyond_the_interval_ends_at_its_end():
    intervals = {**INTERVALS, "Z_M.inertia": (0.2, 0.5)}
    fitted = td.fit_simulation(OTHER, measured(), intervals, **PUSHED)
    assert fitted.at_ends == ("Z_M.inertia",) and np.isnan(fitted.errors["Z_M.inertia"])
    assert fitted.values["Z_M.inertia"] == pytest.approx(0.2, rel=0.01)


@pytest.mark.slow
def test_dry_friction_and_its_cancellation_come_back_from_the_force_of_a_measured_motion():
    truth = models.interface()
    simulation = td.simulate_diagram(truth, **models.SIMULATED)
    time = simulation.data["time"].values
    force = simulation["R_V"].values + 5e-3 * np.random.default_rng(2).standard_normal(len(time))
    data = {"time": time, "place": simulation["L"].values, "R_V": force}
    intervals = {"Z_M.coulomb.level": (0.2, 4.0), "Z_M.inertia": (0.05, 0.5)}
    intervals["Z_M.viscous.damping"] = (0.1, 10.0)
    start = truth.with_values({"Z_M.coulomb.level": 3.0, "Z_M.inertia": 0.4})
    fitted = td.fit_simulation(start, data, intervals, motion={"L": "place"})
    for name in intervals:
        assert abs(fitted.values[name] - truth.values[name]) < 4 * fitted.errors[name]
    figure = fitted.plot()
    assert len(figure.axes) == 2 and "R" in figure.axes[0].get_ylabel()
    assert pickle.loads(pickle.dumps(fitted)) == fitted


def test_a_record_is_data_too():
    record = td.load_experiment(td.example("rod")).records[0]
    time = record.time - record.time[0]
    name = next(n for n in record.signals if n.endswith(".position"))
    driven = sampled_motion(time, record.signals[name])
    position = td.tuning.measured_signals.measured_signals(record).motion(name)
    np.testing.assert_array_equal(position.position(time), driven.position(time))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"data": {"L": np.zeros(20)}}, 'mapping with "time"'),
        ({"data": {"time": np.arange(20.0)[::-1], "L": np.zeros(20)}}, "increase"),
        ({"data": {"time": np.arange(20.0), "L": np.arange(20.0)}}, "rows are 1 s apart.*in ms"),
        ({"data": {"time": np.arange(20) / 1e3, "L": np.zeros(19)}}, "shape"),
        ({"data": {"time": np.arange(20) / 1e3, "L": np.zeros(20)}}, "constant"),
        ({"data": {"time": np.arange(20) / 1e3, "M": np.arange(20.0)}}, "say by `signals`"),
        ({"signals": {"L": "place"}}, 'no column "place"'),
        ({"signals": {"Q": "L"}}, 'no signal "Q"'),
        ({"noise": {"L": 0.0}}, "more than 0"),
        ({"inputs": {"R_V": "F"}}, 'no column "F"'),
        ({"parameters": {}}, "parameters: found none"),
        ({"parameters": {"Z_M.inertia": (0.5, 0.1)}}, "expected \\(low, high\\)"),
        ({"parameters": {"Z_M.inertia": (-0.5, 0.1)}}, "inertia"),
        ({"parameters": {"duration": (0.5, 0.7)}}, "by jumps"),
    ],
)
def test_what_cannot_be_fitted_is_refused_in_one_line(change, words):
    arguments = {"data": measured(duration=0.05), "parameters": INTERVALS, **PUSHED, **change}
    with pytest.raises(ModelError, match=words) as error:
        td.fit_simulation(SPRUNG, **arguments)
    assert "\n" not in str(error.value)
