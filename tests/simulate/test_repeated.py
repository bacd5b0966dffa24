"""The same structure again: nothing is built twice, and nothing of the last run is left."""

import copy
import pickle

import numpy as np
import pytest
from devices import coupled

from teleopdesign.diagrams import haptic_interface
from teleopdesign.simulate import prepare, simulate

RUN = dict(duration=0.1, inputs={"F_u": 1.0})


def test_a_run_does_not_depend_on_those_before_it():
    first = simulate(coupled(), **RUN).data
    simulate(coupled().with_values({"Z_m.coulomb.level": 0.1}), **RUN)
    assert simulate(coupled(), **RUN).data.identical(first)


def test_other_wiring_or_names_of_the_same_laws_are_another_structure():
    one = simulate(coupled(), **RUN)
    alone = haptic_interface(coupled().block("Z_m").body)
    bare = simulate(alone, duration=0.1, inputs={"R_V": 1.0}, jit=False)
    assert not np.array_equal(one["X_m"], bare["L"])
    assert "U_m" in one.data


def test_other_values_share_what_depends_on_structure():
    one, other = (
        prepare(coupled().with_values({"Z_m.coulomb.level": x}), **RUN) for x in (0.2, 0.3)
    )
    assert one.program is not None and one.program.loop is other.program.loop
    assert one.diagram.values["Z_m.coulomb.level"] == 0.2
    assert other.diagram.values["Z_m.coulomb.level"] == 0.3


def test_a_simulation_copies_and_pickles_before_and_after_its_signals_are_asked_for():
    one = simulate(coupled(), **RUN)
    again = pickle.loads(pickle.dumps(one))
    assert again == one and copy.copy(one) == one
    assert again.data.identical(one.data)
    with pytest.raises(AttributeError, match="no attribute 'date'"):
        one.date  # noqa: B018
