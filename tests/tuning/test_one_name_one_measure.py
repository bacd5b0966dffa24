"""Two measures with one name are refused: the values of one would stand for the other's."""

import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError


def test_an_objective_and_a_limit_of_one_name_are_one_measure():
    diagram = td.haptic_interface(body(viscous__damping=1.0))
    late, whole = (td.measure("peak", signal="L", **more) for more in ({"after": 0.05}, {}))
    search = {"duration": 0.1, "inputs": {"R_D": 1.0}, "evaluations": 5}
    box = {"Z_M.viscous.damping": (1.0, 2.0)}
    with pytest.raises(ModelError, match='two different measures are called "peak_L"'):
        td.tune(diagram, box, late, subject_to=[td.limit(whole, most=1.0)], **search)
    assert td.tune(diagram, box, whole, subject_to=[td.limit(whole, most=1.0)], **search)
