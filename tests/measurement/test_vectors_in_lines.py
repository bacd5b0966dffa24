"""Vectors that programs print behind their names, and names that only count channels."""

import numpy as np
import pytest

from teleopdesign.cli import main
from teleopdesign.measurement.column_names import is_wanted, likeness, unit_in_name
from teleopdesign.measurement.doors._pairs import pairs_of
from teleopdesign.measurement.doors.text import open_text

T = 0.005 * np.arange(1200)
Q = np.sin(2 * np.pi * 0.7 * T) + 0.2 * np.sin(2 * np.pi * 2.1 * T)
V = np.gradient(Q, T)
U = 0.02 * np.gradient(V, T) + 0.3 * np.sign(V)
FORMS = {
    "lists": "t: {t:.4f} position: [{q:.6f}, 0.02, 1e-3] force: [{u:.5f}, 0.0, 0.0]",
    "a dict": "{{'t': {t:.4f}, 'position': [{q:.6f}, 0.02, 0.001], 'force': [{u:.5f}, 0, 0.]}}",
    "tuples": "t={t:.4f}, position=({q:.6f}, 0.02, .001), force=({u:.5f}, 0.0, 0.0)",
    "numpy": "t={t:.4f} position=[ {q:.6f}  0.02  0.001] force=[{u:.5f} 0. 0.]",
    "arrays": "t: {t:.4f}; position: array([{q:.6f}, 0.02, 0.001]); force: array([{u:.5f}, 0, 0])",
}


@pytest.mark.parametrize("form", FORMS)
def test_a_vector_behind_a_name_is_a_column_for_each_element(form, tmp_path, capsys):
    """Such a log was "not a table of numbers"."""
    rows = [FORMS[form].format(t=t, q=q, u=u) for t, q, u in zip(T, Q, U, strict=True)]
    log = tmp_path / "pen.txt"
    log.write_text("\n".join(["started", *rows]))
    assert main(["new", str(log), "--yes", "--output", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert 'position           "position[0]"' in printed
    assert 'actuator_force     "force[0]"' in printed


def test_lines_with_brackets_that_hold_no_pairs_stay_what_they_are():
    assert pairs_of("moved to [1, 2, 3]") == []
    assert pairs_of("t=1 (first) q=2") == []
    assert pairs_of("t=1, q=[1, two]") == []
    assert pairs_of("t=1 q=[2") == []
    assert pairs_of("{'a': 1, 'b c': [2]}") == [("a", "1", ""), ("b_c[0]", "2", "")]


@pytest.mark.parametrize(
    ("header", "names"),
    [
        ("I0,I1,I2", ("column 1", "column 2", "column 3")),
        ("t,I1,I2", ("t", "I1", "I2")),
        ("I1,I2,I3", ("I1", "I2", "I3")),
    ],
)
def test_names_that_count_channels_from_zero_are_none(header, names, tmp_path):
    """A plotter calls its channels so; they were currents, and none was a position."""
    log = tmp_path / "plot.csv"
    rows = "".join(f"{u:.5f},{v:.5f},{q:.5f}\n" for q, v, u in zip(Q, V, U, strict=True))
    log.write_text(f"{header}\n{rows}")
    assert open_text(log, "plot.csv").names == names


def test_the_current_of_the_q_axis_is_no_position():
    for name in ("q_current_A", "current_q", "i_q", "I_q", "iq"):
        assert likeness(name, "position") == 0.0 < likeness(name, "actuator_force"), name
    assert likeness("q_i", "position") > 0.75 and not is_wanted("i_q")
    assert unit_in_name("velocity_rev_s") == "rev/s"
