"""A command or a force that is not recorded joins blocks in one cut of a body."""

import numpy as np
import pytest
from block_cuts.interface_simulator import draw_interface, leave_out, write_case

import teleopdesign as td
from teleopdesign.block_cuts.body import body_experiment
from teleopdesign.block_cuts.cuts import same_effects
from teleopdesign.cli import main


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("joined") / "interface"
    random = np.random.default_rng(4)
    write_case(draw_interface(random), place, random, durations=(1.5, 1.5))
    return place


def without(folder, signal, place):
    """The experiment without one of its channels."""
    for file in folder.iterdir():
        (place / file.name).write_bytes(file.read_bytes())
    leave_out(place, signal)
    return td.load_experiment(place)


def cut_of(experiment, name):
    (cut,) = [cut for cut in experiment.cuts.tested if cut.name == name]
    return cut


def test_the_command_of_the_laws_stands_for_the_one_that_is_not_recorded(folder, tmp_path):
    whole, joined = td.load_experiment(folder), without(folder, "R_A", tmp_path)
    recorded = body_experiment(whole, cut_of(whole, "Z_M"))
    predicted = body_experiment(joined, cut_of(joined, "Z_M"))
    for one, other in zip(recorded.records, predicted.records, strict=True):
        left = one.signals["Z_M.actuator_force"] - other.signals["Z_M.actuator_force"]
        # the converter's step is 4 mN
        assert np.abs(left).max() < 0.0021


def test_what_acts_on_the_same_command_is_one_effect(folder, tmp_path):
    joined = without(folder, "R_A", tmp_path)
    cut, diagram = cut_of(joined, "Z_M"), joined.diagram
    assert same_effects(diagram, cut, td.EFFECTS["actuation_delay"]) == (("delay", "computer"),)
    biases = same_effects(diagram, cut, td.EFFECTS["bias"])
    assert {at for _, at in biases} == {"computer", "H", "C"}
    assert same_effects(diagram, cut, td.EFFECTS["stribeck"]) == ()


def test_device_and_hand_are_one_body_where_the_force_between_is_not_recorded(folder, tmp_path):
    joined = without(folder, "R_M", tmp_path)
    cut = cut_of(joined, "Z_M")
    assert set(cut.blocks) == {"Z_M", "Z_H"}
    experiment = body_experiment(joined, cut)
    assert set(experiment.records[0].signals) == {"Z_M.position", "Z_M.actuator_force"}
    spring = td.EFFECTS["hardening_spring"]
    assert same_effects(joined.diagram, cut, spring) == (("hardening_spring", "Z_H"),)


def test_a_law_that_reads_a_force_that_is_not_recorded_is_not_predicted(folder, tmp_path):
    without(folder, "R_A", tmp_path)
    leave_out(tmp_path, "R_M")
    with pytest.raises(td.ExperimentError, match="the computer reads R_M.*record R_M"):
        td.load_experiment(tmp_path)


def test_commands_print_the_cuts_and_what_to_log(folder, capsys):
    assert main(["check", str(folder)]) == 0
    assert "cut R_A: R_A from R_D, L, R_M tests H, C, computer" in capsys.readouterr().out
    assert main(["next", str(folder / "interface.toml")]) == 0
    assert "fprintf" in capsys.readouterr().out
    assert main(["diagnose", str(folder), "--simulate"]) == 2
    assert "whole diagram" in capsys.readouterr().err
