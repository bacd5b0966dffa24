"""`teleopdesign simulate`: a diagram's signals over time, as the same call in Python gives them."""

import numpy as np
import pytest
import xarray

import teleopdesign as td
from teleopdesign.cli import main
from teleopdesign.diagrams import load_shipped, write_diagram

NAME = "world-haptics-2005"
MOVED = ("--motion", "L", "10mm", "2Hz")


@pytest.fixture
def expected():
    """The same simulation in Python."""
    motion = {"L": td.sine(amplitude=0.01, frequency=2.0)}
    return td.simulate_diagram(load_shipped(NAME), duration=0.2, motion=motion)


def test_the_signals_are_those_of_python(expected, capsys, tmp_path):
    out = tmp_path / "run.nc"
    assert main(["simulate", NAME, "--duration", "200ms", *MOVED, "--output", str(out)]) == 0
    printed = capsys.readouterr().out
    with xarray.open_dataset(out) as data:
        assert set(data) == set(expected.data)
        for signal in expected.data:
            np.testing.assert_array_equal(data[signal], expected[signal])
            assert f"  {signal} " in printed


def test_a_table_holds_every_signal_with_its_unit_and_can_be_read_by_new(expected, tmp_path):
    out = tmp_path / "run.csv"
    assert main(["simulate", NAME, "--duration", "0.2", *MOVED, "--output", str(out)]) == 0
    head, *rows = out.read_text().splitlines()
    names = ["time [s]", *(f"{n} [{x.attrs['units']}]" for n, x in expected.data.items())]
    assert head.split(",") == names
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    exact = np.column_stack([expected.data["time"], *(expected[n] for n in expected.data)])
    np.testing.assert_allclose(table, exact, rtol=1e-8, atol=1e-30)


def test_a_sine_from_outside_and_continuous_controllers_act(capsys):
    assert main(["simulate", NAME, "--duration", "0.1", "--continuous",
                 "--input", "R_V", "2N", "5Hz", "--error"]) == 0  # fmt: skip
    lines = capsys.readouterr().out.splitlines()
    assert all("error over the largest: step" in line for line in lines[1:])
    assert float(lines[1].split()[2]) > 0.0  # the device moves


def test_a_diagram_in_a_file_and_a_figure_of_chosen_signals(tmp_path, capsys):
    file, figure = tmp_path / "loop.toml", tmp_path / "loop.svg"
    write_diagram(load_shipped(NAME), file)
    drawn = ["--signal", "L", "--signal", "R_A", "--figure", str(figure)]
    assert main(["simulate", str(file), "--duration", "0.1", *MOVED, *drawn]) == 0
    assert figure.stat().st_size > 1000
    assert f"written: {figure}" in capsys.readouterr().out


@pytest.mark.slow
def test_the_device_of_a_diagnosis_moves_in_a_hand(answer, capsys):
    assert main(["simulate", str(answer), "--duration", "0.1", *MOVED]) == 0
    assert "Z_M_friction" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--motion", "Lx", "10mm", "2Hz"], 'no signal "Lx", has R_V, L_D, L'),
        (["--motion", "L", "10N", "2Hz"], '--motion L: found "N", expected a length'),
        (["--motion", "L", "10mm", "two"], "--motion L: found 'two', expected a number"),
        (["--motion", "R_V", "1N", "2Hz"], '"R_V" is no motion, has L'),
        (["--input", "L", "1mm", "2Hz"], 'no signal from outside "L", has R_V, L_D'),
        (["--value", "Z_M.inertia"], "--value: found 'Z_M.inertia', expected NAME=VALUE"),
        (["--value", "Z_M.inertai=1kg"], 'did you mean "Z_M.inertia"?'),
        (
            ["--value", "Z_M.inertia=1mm"],
            '--value Z_M.inertia: found "mm", expected a mass',
        ),
        (["--value", "Z_M.inertia=1qq"], '--value Z_M.inertia: found "qq", expected a mass'),
        (["--signal", "Q"], 'no signal "Q", has L'),
        (["--output", "run.txt"], "run.txt: found '.txt', expected .csv or .nc"),
    ],
)
def test_what_cannot_be_simulated_is_refused_in_one_line(refused, options, line):
    assert line in refused("simulate", NAME, "--duration", "0.1", *options)


def test_a_diagram_without_equations_is_refused(refused):
    assert "known by its name only" in refused("simulate", "haptic-interface", "--duration", "1")
