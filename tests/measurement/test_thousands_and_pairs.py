"""Numbers with points between thousands, and lines of names and values."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.measurement.doors._cells import numbers_of
from teleopdesign.measurement.doors.text import open_text

ROWS = 800
T = 2.0 * np.arange(ROWS)  # ms: beyond 1000 long after the first rows
Q = 900 * np.sin(0.01 * np.arange(ROWS)) * np.linspace(1, 3, ROWS)


def german(value, digits=2):
    """1234.5 -> "1.234,50"."""
    return f"{value:,.{digits}f}".translate(str.maketrans(",.", ".,"))


def open_lines(path, lines, encoding="utf-8"):
    path.write_bytes(("\n".join(lines) + "\n").encode(encoding))
    return open_text(path, path.name)


def read_all(log):
    read = log.read(dict.fromkeys(log.names, ""))
    return {name: numbers_of(cells, name, "log") for name, cells in read.items()}


@given(value=st.floats(-1e9, 1e9), digits=st.integers(1, 6))
def test_a_number_with_points_between_thousands_is_that_number(value, digits):
    from teleopdesign.measurement.doors._cells import is_number, number_of

    text = german(value, digits)
    assert is_number(text, comma=True)
    assert number_of(text, comma=True) == float(f"{value:.{digits}f}")


def test_a_date_with_points_beside_decimal_commas_is_a_date(tmp_path):
    rows = [f"02.03.2026 22:14:{k // 100:02d},{k % 100:02d};{german(q)}" for k, q in enumerate(Q)]
    columns = read_all(open_lines(tmp_path / "log.csv", ["Zeit;Weg", *rows]))
    assert np.allclose(columns["Zeit"], 0.01 * np.arange(ROWS) + columns["Zeit"][0], atol=1e-5)


@pytest.mark.parametrize("form", ["t={:.3f} pos={:.5g}", "t: {:.3f}, pos: {:.5g}",
                                  "t:{:.3f};pos:{:.5g}", "t = {:.3f} | pos = {:.5g}"])  # fmt: skip
def test_lines_of_names_and_values_are_a_table(tmp_path, form):
    rows = [form.format(t, q) for t, q in zip(T, Q, strict=True)]
    log = open_lines(
        tmp_path / "dump.log", ["ready", rows[0][4:], *rows[:300], "reset", *rows[300:]]
    )
    assert log.names == ("t", "pos")
    columns = read_all(log)
    assert np.allclose(columns["t"], T) and np.allclose(columns["pos"], Q, rtol=1e-4)
    assert log.left_out() == ("a line that is no row, the first one before row 301: left out",)


def test_units_behind_the_values_are_units_of_their_columns(tmp_path):
    rows = [f"t={t}ms pos={q:.3f}deg i=0.5A n=3" for t, q in zip(T, Q, strict=True)]
    log = open_lines(tmp_path / "dump.txt", rows)
    assert log.units == {"t": "ms", "pos": "deg", "i": "A"}
