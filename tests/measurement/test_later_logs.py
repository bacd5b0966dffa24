"""What a later log states of itself is not read by the table of the first one without a word."""

import numpy as np
import pytest

from teleopdesign.cli import main

T = np.arange(0, 4, 0.001)
ROWS = [T, 20 * np.sin(6 * T), 2 * np.cos(6 * T)]


def log(path, lines, columns=ROWS):
    rows = (",".join(f"{x:.5f}" for x in row) for row in zip(*columns, strict=True))
    path.write_text("\n".join((*lines, *rows)) + "\n")
    return str(path)


@pytest.mark.parametrize(
    ("first", "second", "columns", "statement"),
    [
        (["# sample rate: 1000 Hz", "x_mm,F_N"], ["# sample rate: 500 Hz", "x_mm,F_N"], ROWS[1:],
         "500 Hz"),
        (["t,x,F", "s,mm,N"], ["t,x,F", "s,mm,mN"], ROWS, "mN"),
    ],
)  # fmt: skip
def test_a_later_log_that_states_something_else_is_refused(
    first, second, columns, statement, tmp_path, capsys
):
    one = log(tmp_path / "one.csv", first, columns)
    two = log(tmp_path / "two.csv", second, columns)
    folder = str(tmp_path / "both")
    assert main(["new", one, two, "--yes", "--inertia", "0.4", "--output", folder]) == 2
    assert statement in capsys.readouterr().err


@pytest.mark.parametrize("later", ["t,F_N,x_mm", "t_ms,x_in,F_lbf", "s,m,mN"])
def test_a_second_header_with_other_columns_is_refused(later, tmp_path, capsys):
    path = tmp_path / "two_runs.csv"
    log(path, ["t,x_mm,F_N"])
    rows = path.read_text().splitlines()
    path.write_text("\n".join([*rows, later, *rows[1:]]) + "\n")
    assert main(["new", str(path), "--yes", "--output", str(tmp_path / "e")]) == 2
    assert later in capsys.readouterr().err
