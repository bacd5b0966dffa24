"""Which recorded signal tests which block, from the wiring alone."""

import pytest
from devices import body

from teleopdesign.block_cuts import cuts_of, what_to_log
from teleopdesign.blocks import hand
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface, teleoperator

RIGID = body(0.2)
H = controller("low_pass", {"bandwidth": 20.0})
C = controller("smoothed_coulomb", {"level": 0.3, "smoothing_velocity": 0.02})
K = controller("lead", {"gain": 100.0, "zero": 10.0, "pole": 100.0})
HAND = hand(mass=0.1, damping=3.0, stiffness=300.0)


def interface(**more):
    return haptic_interface(RIGID, hand=HAND, cancellation=C, force_feedback=H, **more)


def blocks(cuts):
    return {cut.name: set(cut.blocks) for cut in cuts.tested}


def test_command_motion_and_force_test_computer_mechanism_and_hand():
    cuts = cuts_of(interface(), ["R_D", "R_A", "L", "R_M"], ["R_V"])
    expected = {"R_A": {"H", "C", "computer"}, "Z_M": {"Z_M"}, "Z_H": {"Z_H"}}
    assert blocks(cuts) == expected and not cuts.untested
    (command,) = cuts.of("computer")
    assert set(command.separating) >= {"R_FF", "R_MBC"}


def test_a_force_of_the_hand_that_is_not_known_leaves_the_hand_untested():
    cuts = cuts_of(interface(), ["R_D", "R_A", "L", "R_M"])
    assert set(cuts.untested) == {"Z_H"} and "R_V" in cuts.untested["Z_H"]
    assert "Z_M" in blocks(cuts)


def test_a_command_that_is_not_recorded_joins_the_computer_to_the_mechanism():
    cuts = cuts_of(interface(), ["R_D", "L", "R_M"], ["R_V"])
    assert blocks(cuts)["Z_M"] == {"Z_M", "H", "C", "computer"}


def test_the_position_loop_is_tested_where_its_force_is_recorded():
    recorded = ["L_D", "R_D", "R_A", "L", "R_M"]
    cuts = cuts_of(interface(position_loop=K), recorded, ["R_V"])
    assert blocks(cuts)["R_D"] == {"K"}
    unknown = cuts_of(interface(position_loop=K), recorded[1:], ["R_V"])
    assert "L_D" in unknown.untested["K"]


def test_a_coupling_is_tested_at_both_commands_of_a_teleoperator():
    law = controller("spring_damper", {"stiffness": 1000.0, "damping": 5.0})
    diagram = teleoperator(RIGID, RIGID, coupling=law, slave_cancellation=C)
    cuts = cuts_of(diagram, ["X_m", "X_s", "U_m", "U_s", "F_m"], ["F_d"])
    assert blocks(cuts)["U_m"] == {"P", "computer"}
    assert blocks(cuts)["U_s"] == {"P", "C_s", "computer"}
    assert {"Z_m", "Z_s"} <= set(blocks(cuts))


@pytest.mark.parametrize("recorded", [["R_D", "R_A", "R_M"], ["L"]])
def test_every_block_has_a_cut_or_a_reason(recorded):
    cuts = cuts_of(interface(), recorded, ["R_V"])
    done = {name for cut in cuts.tested for name in cut.blocks}
    assert done | set(cuts.untested) >= {"Z_M", "Z_H", "H", "C"}
    assert all(cuts.untested.values())


def test_a_diagram_says_what_must_be_logged_to_test_every_block():
    plan = what_to_log(interface(position_loop=K))
    assert not plan.cuts.untested and plan.zero == ("R_V",)
    names = {one.name for one in plan.signals}
    assert {"L_D", "R_D", "R_A", "R_M", "L"} <= names
    assert all(name in plan.code and f'"{name}"' in plan.channels for name in names)
