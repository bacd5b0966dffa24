"""Diagrams prepared for simulation: bodies split at their structure, and zero delays removed."""

import numpy as np
import pytest
from devices import body

from teleopdesign.blocks import matrix_impedance
from teleopdesign.controllers import Controller, controller
from teleopdesign.diagrams import Linked, parallel_rods
from teleopdesign.realise.simulated import without_no_delay
from teleopdesign.realise.tips import with_tips

COMPLIANT = {
    "transmission_compliance__tip_inertia": 0.1,
    "transmission_compliance__stiffness": 3e3,
    "transmission_compliance__damping": 1.5,
}


@pytest.mark.parametrize("which", [(True, False), (False, True), (True, True), (False, False)])
def test_what_joins_several_bodies_holds_the_tips_of_those_that_have_one(which):
    rods = [body(0.3, **(COMPLIANT if has_tip else {})) for has_tip in which]
    joint = matrix_impedance(stiffness=[[5.0, 1.0], [1.0, 4.0]])
    diagram = with_tips(parallel_rods(rods, np.eye(2), mechanism=joint))
    (linked,) = (b for b in diagram.blocks if isinstance(b, Linked))
    ends = [f"L{k + 1}_tip" if has_tip else f"L{k + 1}" for k, has_tip in enumerate(which)]
    assert list(linked.motions) == ends


@pytest.mark.parametrize("times", [(0.0,), (0.1,), (0.0, 0.1), (0.0, 0.0)])
def test_delays_of_no_time_are_left_out_and_others_stay(times):
    spring = controller("spring_damper", {"stiffness": 2.0, "damping": 0.0})
    late = [controller("delay", {"time": t}).stages[0] for t in times]
    made = without_no_delay(Controller((*late, *spring.stages)))
    assert made.dead_time is None or made.dead_time > 0
    left = [s.value_of("dead_time") for s in made.stages]
    assert left == [*(t for t in times if t), None]
