"""The same structure again: nothing is built twice, and nothing of the last run is left."""

import copy
import pickle

import pytest
from devices import coupled

from teleopdesign.simulate import simulate

RUN = dict(duration=0.1, inputs={"F_u": 1.0})


def test_a_run_does_not_depend_on_those_before_it():
    first = simulate(coupled(), **RUN).data
    simulate(coupled().with_values({"Z_m.coulomb.level": 0.1}), **RUN)
    assert simulate(coupled(), **RUN).data.identical(first)


def test_a_simulation_copies_and_pickles_before_and_after_its_signals_are_asked_for():
    one = simulate(coupled(), **RUN)
    again = pickle.loads(pickle.dumps(one))
    assert again == one and copy.copy(one) == one
    assert again.data.identical(one.data)
    with pytest.raises(AttributeError, match="no attribute 'date'"):
        one.date  # noqa: B018
