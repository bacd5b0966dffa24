"""The same table through every door gives the same numbers."""

import numpy as np
import pandas
import polars
import pytest
import xarray

import teleopdesign as td

COLUMNS = ("time (s)", "Pos (deg)", "torque (N*m)")


@pytest.fixture
def table():
    t = np.arange(2000) / 500.0
    angle = 40.0 * np.sin(2 * np.pi * 0.7 * t)
    return dict(zip(COLUMNS, (t, angle, 0.3 * np.sign(np.cos(2 * np.pi * 0.7 * t))), strict=True))


def record_of(data):
    experiment = td.experiment(
        data,
        axis="revolute",
        position="Pos (deg)",
        actuator_force="torque (N*m)",
        inertia=0.01,
    )
    return experiment.records[0]


def test_frames_and_datasets_are_read_like_a_dict_of_arrays(table):
    plain = record_of(table)
    assert plain.signals["device.position"] == pytest.approx(np.radians(table["Pos (deg)"]))
    for data in (
        pandas.DataFrame(table),
        polars.DataFrame(table),
        xarray.Dataset({name: ("row", values) for name, values in table.items()}),
    ):
        other = record_of(data)
        assert np.array_equal(other.time, plain.time)
        for name, values in plain.signals.items():
            assert np.array_equal(other.signals[name], values)
