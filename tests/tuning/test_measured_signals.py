"""Measured signals as people have them: DataFrames, simulations, stamps of a clock."""

import numpy as np
import pandas
import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.tuning.measured_signals import measured_signals

T = np.linspace(0.0, 0.5, 51)
L = np.sin(9.0 * T)
SPRUNG = td.haptic_interface(body(0.15, viscous__damping=2.0, spring__stiffness=300.0))


@pytest.mark.parametrize(
    "data",
    [
        {"time": T, "L": L},
        pandas.DataFrame({"time": T, "L": L}),
        pandas.DataFrame({"L": L}, index=T),
        pandas.DataFrame({"L": L}, index=pandas.Index(T, name="time")),
    ],
)
def test_columns_of_any_table_are_the_same_signals(data):
    signals = measured_signals(data)
    assert np.array_equal(signals.time, T) and np.array_equal(signals.column("L"), L)
    assert list(signals.columns) == ["L"]


def test_a_simulation_is_data_too():
    run = td.simulate_diagram(SPRUNG, duration=0.1, inputs={"R_V": 1.0})
    signals = measured_signals(run)
    assert np.array_equal(signals.column("L"), run["L"].values)


@pytest.mark.parametrize("start", [100.0, 1.7e9])
def test_stamps_of_a_clock_are_no_time_of_a_simulation(start):
    """It was simulated from 0 to 100 s, and the fit of half a second there was as good as none."""
    with pytest.raises(ModelError, match=r"begins at 1\S+ s and lasts 0\.5 s.*subtract"):
        measured_signals({"time": T + start, "L": L})
    assert measured_signals({"time": T + 2.0, "L": L}).time[0] == 2.0


@pytest.mark.parametrize("data", [pandas.DataFrame({"L": L}), {"L": L}, [T, L], 3.0])
def test_data_without_a_time_are_refused(data):
    with pytest.raises(ModelError, match='with "time"'):
        measured_signals(data)
