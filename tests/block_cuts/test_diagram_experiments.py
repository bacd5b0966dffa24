"""Experiments of whole diagrams: what is read, and one clear line for what is not."""

from dataclasses import replace

import numpy as np
import pytest
from block_cuts.interface_simulator import draw_interface, write_case

import teleopdesign as td


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("cases") / "interface"
    random = np.random.default_rng(3)
    interface = draw_interface(random)
    write_case(interface, place, random, durations=(1.5, 1.5))
    return place


@pytest.fixture
def edited(folder, tmp_path):
    """A copy of the folder with one text of its experiment.toml replaced."""

    def edit(old, new):
        for file in folder.iterdir():
            (tmp_path / file.name).write_bytes(file.read_bytes())
        text = (tmp_path / "experiment.toml").read_text()
        assert old in text
        (tmp_path / "experiment.toml").write_text(text.replace(old, new))
        return tmp_path

    return edit


def test_a_folder_with_a_diagram_is_read_with_its_cuts(folder):
    experiment = td.load_experiment(folder)
    assert isinstance(experiment, td.DiagramExperiment)
    assert [cut.name for cut in experiment.cuts.tested] == ["R_A", "Z_M", "Z_H"]
    assert experiment.assumed == {"R_V": 0.0}
    assert "R_A" in repr(experiment)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"R_M" =', '"R_m" =', ("R_m", "R_M")),
        ('"R_V" = 0', '"R_v" = 0', ("R_v", "R_V")),
        ('"R_V" = 0', '"R_V" = 1', ("R_V", "expected 0")),
        ('file = "interface.toml"', 'file = "interfce.toml"', ("interfce.toml", "interface.toml")),
        ('[channels]', '[model.device]\naxis = "prismatic"\n[channels]', ("model", "[diagram]")),
        ("sample_period", "sample_perod", ("sample_perod", "sample_period")),
        ('unit = "m"', 'unit = "N"', ("L",)),
    ],
)  # fmt: skip
def test_a_wrong_entry_is_one_line_with_place_and_nearest_name(edited, old, new, words):
    place = edited(old, new)
    with pytest.raises(td.ExperimentError) as problem:
        td.load_experiment(place)
    message = str(problem.value)
    assert "\n" not in message and all(word in message for word in words), message


def test_rows_further_apart_than_the_period_leave_the_computer_untested(edited):
    experiment = td.load_experiment(edited("value = 1, unit", "value = 0.25, unit"))
    from teleopdesign.block_cuts.computer import UnevenRows, passes_of

    with pytest.raises(UnevenRows, match="log every pass"):
        passes_of(experiment, experiment.logs[0])


def test_a_few_lost_rows_leave_the_computer_tested_beside_them(folder):
    from teleopdesign.block_cuts.computer import passes_of
    from teleopdesign.block_cuts.half_steps import whole_passes_of

    experiment = td.load_experiment(folder)
    log = experiment.logs[0]
    whole = passes_of(experiment, log)
    kept = ~np.isin(np.arange(log.count), (400, 401, 700))
    values = {name: column[kept] for name, column in log.columns.values.items()}
    fewer = replace(log, columns=replace(log.columns, values=values))
    rows = passes_of(experiment, fewer)
    assert (whole.lost, rows.lost) == ((), (400, 401, 700))
    for name, signal in rows.signals.items():
        assert np.array_equal(signal[kept], whole.signals[name][kept])
    with pytest.raises(td.ModelError, match="a row is missing at 0.4 s"):
        whole_passes_of(experiment, fewer)
