"""A table of an input counts for the step that was asked for, also in a run of shorter steps."""

import numpy as np
import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller

#: s; half a step of the default
HALF, DURATION = 5e-5, 0.02
TIMES = HALF * np.arange(round(DURATION / HALF) + 1)
STIFF = td.haptic_interface(body(0.15, coulomb__level=0.5, presliding__stiffness=2e7))
SOFT = STIFF.with_values({"Z_M.presliding.stiffness": 1e4})


def push(t):
    return 1.0 + 20.0 * np.asarray(t)


@pytest.mark.parametrize("diagram", [SOFT, STIFF])
@pytest.mark.parametrize("estimate", [False, True])
def test_a_table_is_the_function_that_it_was_made_of(diagram, estimate):
    table, function = (
        td.simulate_diagram(diagram, duration=DURATION, inputs={"R_V": x}, estimate_error=estimate)
        for x in (push(TIMES), push)
    )
    assert table.data.attrs["step_s"] == function.data.attrs["step_s"]
    assert np.allclose(table["L"].values, function["L"].values, rtol=1e-12, atol=0)
    assert ("step_error" in table["L"].attrs) == estimate


def test_cases_of_one_diagram_take_one_table_though_their_steps_differ():
    name = "Z_M.presliding.stiffness"
    made = td.simulate_many(
        STIFF, {name: [1e4, 2e7]}, duration=DURATION, inputs={"R_V": push(TIMES)},
        reduce={"end": ("L", "final")},
    )  # fmt: skip
    alone = [
        td.simulate_diagram(STIFF.with_values({name: k}), duration=DURATION, inputs={"R_V": push})
        for k in (1e4, 2e7)
    ]
    assert made["end"].values == pytest.approx([float(one["L"][-1]) for one in alone])


def test_a_table_of_another_length_is_refused_with_the_length_for_the_step_asked():
    for diagram in (SOFT, STIFF):
        with pytest.raises(ModelError, match="has 21 samples, expected 401, one each 0.05 ms"):
            td.simulate_diagram(diagram, duration=DURATION, inputs={"R_V": np.ones(21)})


def test_what_computer_and_body_read_may_be_one_table():
    """The computer reads the rows of its samples."""
    law = controller("low_pass", {"bandwidth": 50.0})
    parts = (
        td.diagrams.Moving("M", body(0.15), "x", "u", {"f": 1.0}, "f"),
        td.diagrams.Control("F", law, "f", "u", "x"),
    )
    diagram = td.Diagram("fed", parts, (), {"f": "force"}, ("x",))
    table, function = (
        td.simulate_diagram(diagram, duration=DURATION, inputs={"f": x}, jit=False)
        for x in (push(TIMES), push)
    )
    assert np.allclose(table["x"].values, function["x"].values, rtol=1e-12, atol=0)
