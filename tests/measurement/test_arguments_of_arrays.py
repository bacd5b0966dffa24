"""What `td.experiment` is given: refused in one line, or taken as it is meant."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError

T = np.arange(3000) / 500.0
Q = 0.5 * np.sin(2 * np.pi * 0.7 * T)
DATA = {"t": T, "q": Q, "u": 0.1 * np.sign(np.cos(2 * np.pi * 0.7 * T))}
REFUSED = {
    "unit of another column": ({"units": {"qq": "rad"}}, 'units: no column "qq".*did you mean "q"'),
    "overlap": ({"fit": [(0, 4)], "check": [(3, 6)]}, r"check: found \(3, 6\), which overlaps fit"),
    "one number": ({"fit": (3,)}, r"fit: found \(3,\), expected \(begin, end\) in s, or several"),
    "three numbers": ({"fit": [(0, 1, 2)]}, r"expected \(begin, end\) in s, or several"),
    "mixed": ({"check": [(0, 1), 2]}, r"check: found .*, expected \(begin, end\) in s"),
    "no span": ({"fit": []}, "fit: found no span"),
}


def made(data=DATA, **more):
    words = {"axis": "revolute", "position": "q", "actuator_force": "u", "inertia": 0.01, **more}
    return td.experiment(data, **words)


@pytest.mark.parametrize("mistake", REFUSED)
def test_an_argument_that_cannot_be_meant_is_refused(mistake):
    arguments, message = REFUSED[mistake]
    with pytest.raises(ExperimentError, match=message):
        made(**arguments)


def test_two_numbers_are_one_span():
    one, several = made(fit=(0, 3), check=(3, 6)), made(fit=[(0, 3)], check=[(3.0, 6.0)])
    assert [r.file for r in one.records] == [r.file for r in several.records]
    assert [len(r.time) for r in one.records] == [1500, 1500]


def test_a_file_in_place_of_arrays_is_refused_with_how_to_read_it():
    with pytest.raises(ExperimentError, match="found str, .*of a file: teleopdesign new FILE"):
        made("log.csv")


def test_an_empty_table_is_one_line():
    with pytest.raises(ExperimentError, match="found 0 rows, expected at least 64"):
        made({name: values[:0] for name, values in DATA.items()})


def test_a_channel_with_more_to_say_takes_its_unit_from_the_columns_name_too():
    t = np.arange(2000) / 500
    data = {"t": t, "x (mm)": np.sin(5 * t), "F": np.cos(5 * t)}
    experiment = td.experiment(
        data,
        axis="prismatic",
        position={"column": "x (mm)", "resolution": 0.01},
        actuator_force={"column": "F", "sign": -1},
    )
    position = experiment.channels["device.position"]
    assert (position.unit, position.resolution) == ("mm", pytest.approx(1e-5, rel=1e-12))
    assert experiment.channels["device.actuator_force"].unit == "N"
    assert experiment.records[0].signals["device.actuator_force"][0] == -1.0
