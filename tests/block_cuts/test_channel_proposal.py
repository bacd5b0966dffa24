"""The columns of a log as signals of a diagram: by their names, and by what fits at the cuts."""

import numpy as np
import pytest
from block_cuts.interface_simulator import draw_interface, write_case

import teleopdesign as td
from teleopdesign.block_cuts import propose_channels
from teleopdesign.cli import main

#: column of the simulated log -> its signal
SIGNALS = {"r_a": "R_A", "x": "L", "f_h": "R_M", "r_d": "R_D"}
WORDS = {"r_a": "motor_cmd", "x": "position", "f_h": "hand_force", "r_d": "desired_force"}
BLANK = {"r_a": "ch1", "x": "ch2", "f_h": "ch3", "r_d": "ch4"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("channels") / "interface"
    random = np.random.default_rng(11)
    write_case(draw_interface(random), place, random, durations=(3.0, 1.5))
    return place


@pytest.fixture
def log(folder, tmp_path, monkeypatch):
    """Writes log.csv and interface.toml: columns renamed, multiplied, and others beside them."""
    monkeypatch.chdir(tmp_path)

    def write(names, factors=None, **others):
        experiment = td.load_experiment(folder)
        columns = dict(experiment.logs[0].columns.values)
        made = {names.get(n, n): (factors or {}).get(n, 1.0) * x for n, x in columns.items()}
        made |= others
        table = np.column_stack(list(made.values()))
        np.savetxt("log.csv", table, delimiter=",", header=",".join(made), comments="", fmt="%.9g")
        (tmp_path / "interface.toml").write_bytes((folder / "interface.toml").read_bytes())

    return write


def new(*options):
    return main(["new", "log.csv", "--diagram", "interface.toml", "--yes", *options])


def channels(names):
    """Signal -> column that is expected."""
    return {signal: names.get(column, column) for column, signal in SIGNALS.items()}


def read():
    return td.load_experiment("log_experiment")


@pytest.mark.parametrize(
    "names",
    [{}, pytest.param(WORDS, marks=pytest.mark.slow), pytest.param(BLANK, marks=pytest.mark.slow)],
    ids=["as signals", "words", "blank"],
)
def test_the_columns_are_recognised_and_the_folder_is_an_experiment(log, capsys, names):
    log(names)
    assert new() == 0
    experiment = read()
    columns = {name: experiment.channel[name].columns[0] for name in experiment.recorded}
    assert columns == channels(names)
    assert experiment.zero == ("R_V",)
    assert {cut.name for cut in experiment.cuts.tested} == {"R_A", "Z_M", "Z_H"}
    assert {one.use for one in experiment.logs} == {"fit", "check"}
    words = "off by" if names is BLANK else "known by its name"
    assert words in capsys.readouterr().out
    assert main(["check", "log_experiment"]) == 0


@pytest.mark.slow
def test_columns_without_names_may_be_any_signal(log):
    """Among them a signal of the hand's cut that is no sum with the force of the hand."""
    log({"time": "a", "x": "b", "r_d": "c", "r_a": "d", "f_h": "e"})
    assert new("--signal", "E=e") == 0


def test_signs_units_and_columns_of_other_quantities_are_recognised(log, capsys):
    names = {**WORDS, "x": "stroke"}
    temperature = 20.0 + np.linspace(0.0, 3.0, 3000)
    log(names, {"f_h": -1.0, "x": 1e3}, temperature=temperature)
    assert new() == 0
    experiment = read()
    columns = {name: experiment.channel[name].columns[0] for name in experiment.recorded}
    assert columns == channels(names)
    assert experiment.channels["L"].content["unit"] == "mm"
    signs = {n: experiment.channels[n].content.get("sign", 1) for n in experiment.recorded}
    assert signs == {"L": 1, "R_A": 1, "R_M": -1, "R_D": 1}
    assert "temperature" in capsys.readouterr().out


@pytest.mark.slow
def test_the_cuts_correct_exchanged_names(log, capsys):
    exchanged = {"r_a": "hand_force", "f_h": "motor_cmd"}
    log(exchanged)
    assert new() == 0
    experiment = read()
    columns = {name: experiment.channel[name].columns[0] for name in experiment.recorded}
    assert columns == channels(exchanged)
    assert "guess" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--signal", "R_A=nothing"], ("no column", "nothing", "r_a")),
        (["--signal", "R_B=r_a"], ("R_B", "did you mean")),
        (["--signal", "R_A"], ("NAME=COLUMN",)),
        (["--position", "x"], ("--position", "--signal")),
    ],
)
def test_what_is_not_there_is_one_line(log, capsys, options, words):
    log({})
    assert new(*options) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and all(word in message for word in words), message


def test_a_log_of_noise_is_one_line_and_nothing_is_written(folder):
    noise = np.random.default_rng(2).standard_normal((2, 2000))
    data = {"t": np.arange(2000) / 1e3, "a": noise[0], "b": noise[1]}
    with pytest.raises(td.ExperimentError, match="no columns fit the signals") as problem:
        propose_channels(td.load_experiment(folder).diagram, data)
    assert "\n" not in str(problem.value)


def test_a_stated_column_is_taken(log):
    log(WORDS)
    assert new("--signal", "R_D=none", "--signal", "R_M=hand_force") == 0
    experiment = read()
    assert experiment.channel["R_M"].columns == ("hand_force",)
    assert "R_D" not in experiment.recorded


def test_of_two_columns_that_fit_as_well_the_user_chooses(log, folder, monkeypatch, capsys):
    forces = td.load_experiment(folder).logs[0].columns.values["f_h"]
    log(WORDS, hand_force_2=forces)
    questions = []
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("builtins.input", lambda text: questions.append(text) or "hand_force_2")
    assert main(["new", "log.csv", "--diagram", "interface.toml"]) == 0
    assert len(questions) == 1 and questions[0].startswith("R_M")
    assert read().channel["R_M"].columns == ("hand_force_2",)
    assert "known as stated" in capsys.readouterr().out


def test_a_hand_is_compared_where_no_command_is_recorded(folder):
    stated = td.load_experiment(folder)
    tables = {n: dict(t.content) for n, t in stated.channels.items() if n in ("time", "L", "R_M")}
    columns = dict(stated.logs[0].columns.values)
    hand = td.diagram_experiment(stated.diagram, columns, channels=tables, outside=["R_V"])
    assert set(td.compare(hand)) == {"Z_H"}
