"""Options of `teleopdesign new` that cannot be taken are refused, each in one line."""

import numpy as np
import pytest

from teleopdesign.cli import main

T = np.arange(2000) / 500.0
Q = 40 * np.sin(2 * np.pi * 0.7 * T)
REFUSED = {
    ("--unit", "pos=degre"): 'found \'degre\', expected a unit such as "deg"',
    ("--unit", "pso=deg"): "unit: no column 'pso', found time, pos, current; did you mean",
    ("--unit", "pos=A"): "unit of 'pos': found 'A', expected one of a position",
    ("--torque-constant", "0.045"): 'found \'0.045\', expected a number and a unit such as "0.037',
    ("--torque-constant", "0.045 Nm"): "expected a force or torque for each ampere",
    ("--velocity", "current"): "--velocity: is the speed of a friction curve, found a log with",
    ("--position", "poss"): 'position: no column \'poss\', found time, pos, current; did you mean',
}  # fmt: skip


@pytest.mark.parametrize("option", REFUSED)
def test_an_option_that_cannot_be_taken_is_refused_and_nothing_is_written(
    tmp_path, monkeypatch, capsys, option
):
    monkeypatch.chdir(tmp_path)
    rows = np.column_stack([T, Q, np.sign(np.cos(2 * np.pi * 0.7 * T))])
    np.savetxt("my log.csv", rows, delimiter=",", header="time,pos,current", comments="")
    assert main(["new", "my log.csv", "--yes", *option]) == 2
    output = capsys.readouterr()
    assert output.err.count("\n") == 1 and REFUSED[option] in output.err
    assert not output.out and not (tmp_path / "my log_experiment").exists()


def test_what_to_type_next_can_be_typed_where_a_name_has_spaces(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    rows = np.column_stack([T, Q, np.sign(np.cos(2 * np.pi * 0.7 * T))])
    np.savetxt("my log.csv", rows, delimiter=",", header="time,pos (deg),current (A)", comments="")
    assert main(["check", "my log.csv"]) == 2
    assert capsys.readouterr().err.endswith("to make one: teleopdesign new 'my log.csv'\n")
    assert main(["new", "my log.csv", "--yes", "--torque-constant", "0.1 Nm/A"]) == 0
    assert "teleopdesign check 'my log_experiment'\n" in capsys.readouterr().out
