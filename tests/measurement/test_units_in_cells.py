"""Units behind the numbers of a table, and units in quoted parts of a name."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, U, look

from teleopdesign.measurement.column_names import unit_in_name
from teleopdesign.measurement.doors._units_in_cells import units_in_cells
from teleopdesign.measurement.doors.text import open_text
from teleopdesign.measurement.survey import Choices, survey_log


def written(tmp_path, header, form, *, end=".csv", decimal=".", before=""):
    """A log as a program writes it, opened again."""
    numbers = zip(T, np.degrees(Q), U, strict=True)
    rows = (form.format(t=t, ms=1e3 * t, q=q, u=u, ma=1e3 * u) for t, q, u in numbers)
    path = tmp_path / f"log{end}"
    path.write_text(before + "\n".join([header, *(r.replace(".", decimal) for r in rows)]) + "\n")
    return open_text(path, path.name)


@pytest.mark.parametrize(
    ("header", "form", "decimal", "units"),
    [
        ("Time,Angle,Torque", "{t:.3f} sec,{q:.3f},{u:.4f}", ".", {"Time": "s"}),
        ("t;w;i", "{t:.3f} s;{q:.3f} °;{ma:.1f} mA", ",", {"t": "s", "w": "deg", "i": "mA"}),
        ("t\tq\tu", "{ms:.0f}ms\t{q:.3f}deg\t{u:.4f}", ".", {"t": "ms", "q": "deg"}),
        ("t,q,u", '"{t:.3f} sec","{q:.3f} deg",{u:.4e} N*m', ".", {"t": "s", "u": "N*m"}),
    ],
)
def test_units_behind_numbers_are_those_of_their_columns(tmp_path, header, form, decimal, units):
    """A timetable of MATLAB had "no column that rises as a time does"."""
    log = written(tmp_path, header, form, decimal=decimal)
    stated = {name: "deg" if unit == "°" else unit for name, unit in log.units.items()}
    assert units.items() <= stated.items()
    survey = survey_log(log, "log", Choices())
    assert survey.channels["time"]["column"] == header[: len(survey.channels["time"]["column"])]
    assert survey.duration == pytest.approx(T[-1], abs=1e-3)
    position = survey.columns[survey.channels["position"]["column"]].values
    assert np.ptp(position) == pytest.approx(np.ptp(np.degrees(Q)), rel=0.01)


@pytest.mark.parametrize(
    "lines",
    [
        ["t,q", "0.1,2", "0.2,3", "0.3,4"],
        ["t,state", "0.1,2 open", "0.2,3 open", "0.3,4 open"],
        ["t,u", "0.1,2 mV", "0.2,3 V", "0.3,4 V"],
        ["t,q", "10:00:01 PM,1", "10:00:02 PM,2", "10:00:03 PM,3"],
        ["0.1 s,2", "0.2 s,3", "0.3 s,4"],
        ["t,q", "0.1 s", "0.2 s,3", "0.3 s,4"],
        ["t", "0.1 s"],
        [],
    ],
)
def test_other_texts_behind_numbers_are_no_units(lines):
    assert units_in_cells(lines) is None


def test_a_line_of_another_form_stays_as_it_is():
    edit = units_in_cells(["t,q", "0.1 s,2", "0.2 s,3"])
    assert [*edit(["t,q\n", "0.1 s,2\n", "stopped\n", "0.4,5\n"])] == [
        "t,q\n", "0.1,2\n", "stopped\n", "0.4,5\n",
    ]  # fmt: skip


def test_the_unit_in_a_quoted_part_of_a_path_is_read():
    """As dSPACE writes names; an angle in deg was in rad, because the name stated no unit."""
    angle, torque = '"Model Root"/"Plant"/"phi [deg]"', '"Model Root"/"Control"/"u [N*m]"'
    assert unit_in_name(angle) == "deg" and unit_in_name(torque) == "N*m"
    survey = look({"Time": T, angle: 20 * Q, torque: U})
    assert survey.channels["position"]["unit"] == "deg"
    assert "channels.position.unit" not in survey.guesses


@pytest.mark.parametrize("scale", [0.1, 5.0])
def test_the_estimate_of_an_odrive_is_in_turns(scale):
    """Its firmware reports turns; they were read in rad."""
    columns = {"time": T, "axis0.encoder.pos_estimate": scale * Q}
    survey = look(columns | {"axis0.motor.current_control.Iq_measured": U})
    assert survey.channels["position"]["unit"] == "turns"
    assert "ODrive" in survey.guesses["channels.position.unit"]
    assert survey.axis == "revolute"
