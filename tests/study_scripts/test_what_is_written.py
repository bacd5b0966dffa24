"""What every study script writes; `make studies` runs them all."""

from runpy import run_module

import pytest


@pytest.mark.slow
def test_a_study_writes_its_figure_and_its_numbers(tmp_path, monkeypatch, capsys):
    """By one of the quickest; the others end in the same call of `write_study`."""
    name = "forward_euler_against_exact"
    monkeypatch.setattr("sys.argv", [name, "--quick", "--output", str(tmp_path)])
    run_module(name, run_name="__main__")
    assert {p.suffix for p in tmp_path.iterdir()} == {".pdf", ".svg", ".png", ".nc"}
    assert "forward Euler keeps abs(f) <= f_c up to q = 1" in capsys.readouterr().out
