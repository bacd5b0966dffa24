"""Diagrams prepared for simulation: bodies split at their structure, and zero delays removed."""

import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.base.errors import ModelError
from teleopdesign.blocks import Body, Value, matrix_impedance
from teleopdesign.diagrams import Linked, parallel_rods
from teleopdesign.effects import EFFECTS, SIGNALS, Effect, Parameter
from teleopdesign.realise.simulated import check_levels, least_levels
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


@pytest.mark.parametrize(
    ("dip", "way", "refused"),
    [(0.4, 0.0, None), (0.6, 0.0, "forward"), (0.6, 1.0, "forward"), (0.6, -1.0, "backward")],
)
def test_friction_below_zero_at_rest_alone_is_refused_with_its_direction(dip, way, refused):
    """A user's level that dips at rest, in one direction or in both, and is whole in sliding."""
    side = sp.Piecewise((1, way * SIGNALS["direction"] >= 0), (0, True))
    effect = Effect(
        role="friction_level",
        law=lambda now, p: -p.dip * side * sp.exp(-((now.velocity / sp.Float(0.01)) ** 2)),
        parameters={"dip": Parameter("force", "depth")},
        absent={"dip": 0.0},
    ).named("dip", "")
    values = {"inertia": Value(0.1), "coulomb.level": Value(0.5), "dip.dip": Value(dip)}
    made = Body("prismatic", values, (EFFECTS["coulomb"], effect))
    if refused is None:
        check_levels(made, "device")
        return
    with pytest.raises(ModelError, match=f"device: friction of -0.1 N {refused} .coulomb, dip."):
        check_levels(made, "device")
    levels = least_levels(made, made.numbers().get)
    assert levels[refused] == pytest.approx(-0.1) and set(levels) == {"forward", "backward"}
    if way:
        (other,) = set(levels) - {refused}
        assert levels[other] == pytest.approx(0.5)
