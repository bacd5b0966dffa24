"""Tables of messages: a reading in each row, and vectors in cells."""

import numpy as np
import pytest
from measurement.made_logs import ROWS, Q, T, U, columns_of, rows, survey

from teleopdesign.measurement.tables import open_log, read_columns

LATE = 0.0007


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("in_turn", [True, False])
def test_a_reading_in_each_row_belongs_to_the_signal_that_its_row_names(
    tmp_path, separator, in_turn
):
    """Viewers of bags write one signal after the other, data bases write readings as they come."""
    angles = [f"{t:.4f},/joint.position[0],{q:.2f},deg" for t, q in zip(T, Q, strict=True)]
    torques = [f"{t + LATE:.4f},/command.data,{u:.3f},Nm" for t, u in zip(T, U, strict=True)]
    states = ["0.5000,/state,ready,", "0.6000,/state,,"]
    mixed = [row for pair in zip(angles, torques, strict=True) for row in pair]
    lines = ["elapsed time,topic,value,unit", *(mixed if in_turn else angles + torques), *states]
    decimal = "," if separator == ";" else "."
    lines = [line.replace(".", "@").replace(",", separator) for line in lines]
    log, proposal = survey(tmp_path, [line.replace("@", decimal) for line in lines])
    names = "/joint@position[0]", "/command@data"
    position, torque = (name.replace("@", decimal) for name in names)
    assert columns_of(proposal.channels) == {
        "time": f"time of {position}", "position": position, "actuator_force": torque,
    }  # fmt: skip
    assert proposal.channels["position"]["unit"] == "deg"
    assert proposal.channels["actuator_force"]["unit"] == "Nm"
    read = read_columns(tmp_path / "log.csv", "log.csv", {torque: "channels.actuator_force"})
    assert np.array_equal(read.values[torque], U)
    assert np.allclose(read.stamps[torque], T + LATE)


def test_a_table_of_values_without_a_signal_in_each_row_is_an_ordinary_table(tmp_path):
    lines = ["time,topic,value,torque", *rows("%.4f,joint,%.2f,%.3f", T, Q, U)]
    lines[0] = "time,joint,value,torque"
    log, _ = survey(tmp_path, lines, position="value")
    assert log.names == ("time", "joint", "value", "torque")
    lines[0] = "time,topic,value,value 2"
    assert open_log_of(tmp_path, lines).names == ("time", "topic", "value", "value 2")


def open_log_of(tmp_path, lines):
    path = tmp_path / "other.csv"
    path.write_text("\n".join(lines) + "\n")
    return open_log(path, path.name)


@pytest.mark.parametrize("form", ["[{}, {}]", "array('d', [{}, {}])", "({}, {})"])
@pytest.mark.parametrize("named", [True, False])
def test_vectors_in_cells_are_a_column_for_each_element(tmp_path, form, named):
    cells = [
        ",".join(f'"{form.format(*pair)}"' for pair in ((f"{q:.2f}", 0.5), (f"{u:.3f}", 2)))
        for q, u in zip(Q, U, strict=True)
    ]
    middle = "\"['hip', 'knee']\"," if named else ""
    table = [f"{t:.4f},{middle}{cell}" for t, cell in zip(T, cells, strict=True)]
    names = f"time,{'name,' * named}position,effort"
    log, proposal = survey(tmp_path, [names, *table])
    expected = ["hip.position", "hip.effort"] if named else ["position[0]", "effort[0]"]
    chosen = columns_of(proposal.channels)
    assert [chosen["position"], chosen["actuator_force"]] == expected
    read = log.read({expected[1]: ""})
    assert np.array_equal(read[expected[1]], U) and len(log.names) == 5
    assert "vectors in cells: a column for each element" in log.notes


def test_a_row_whose_vector_is_shorter_is_no_row(tmp_path):
    table = [f'{t:.4f},"[{q:.2f}, 1]",{u:.3f}' for t, q, u in zip(T, Q, U, strict=True)]
    table[700] = table[700].replace(", 1", "")
    log, _ = survey(tmp_path, ["time,position,effort", *table])
    assert len(log.read({"effort": ""})["effort"]) == ROWS - 1
    assert "a line that is no row" in log.left_out()[0]
