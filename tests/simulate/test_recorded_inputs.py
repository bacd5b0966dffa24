"""Recorded signals as inputs, systems of python-control as blocks, and the give of friction."""

import math

import numpy as np
import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller


def rod():
    body = td.Body("prismatic", {"inertia": 2.0})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": 3.0})
    return body.with_effect(td.EFFECTS["viscous"], {"damping": 0.5})


def test_a_pair_of_times_and_samples_is_an_input_on_any_grid():
    times = np.linspace(0.0, 1.0, 11)
    samples = 6.0 * times
    runs = [
        td.simulate_diagram(td.haptic_interface(rod()), duration=1.0, inputs={"R_D": force})
        for force in ((times, samples), lambda t: 6.0 * t)
    ]
    np.testing.assert_allclose(runs[0]["L"], runs[1]["L"], rtol=1e-9, atol=1e-12)


def test_the_error_estimate_says_what_the_give_of_friction_changes():
    """2 kg, 3 N, pulled by 6 N for 1 s: exact 0.69122 m; a bristle that gives 1e-5 m is off."""
    run = td.simulate_diagram(
        td.haptic_interface(rod()), duration=1.0, inputs={"R_D": 6.0}, estimate_error=True
    )
    off = abs(float(run["L"][-1]) - 0.69122)
    # a tenth of the give leaves a tenth of the error, or a third where it grows with its root
    assert 0.5 * off < run["L"].attrs["give_error"] * 0.69 < 2 * off


BODY = td.Body("prismatic", {"inertia": 0.2}).with_effect(td.EFFECTS["viscous"], {"damping": 3.0})
LOOP = td.haptic_interface(BODY, hand=td.hand(mass=0.1, damping=2.0, stiffness=50.0))


def moved(force):
    return td.simulate_diagram(LOOP, duration=0.05, inputs={"R_D": force})["L"].values


@pytest.mark.parametrize(
    ("one_by_one", "at_once"),
    [
        (lambda t: 1.0 if t > 0.02 else 0.0, lambda t: np.where(t > 0.02, 1.0, 0.0)),
        (lambda t: math.sin(60 * t), lambda t: np.sin(60 * t)),
        (lambda t: max(0.0, t - 0.01), lambda t: np.maximum(0.0, t - 0.01)),
        (lambda t: 2.0, 2.0),
    ],
)
def test_a_function_of_one_number_is_an_input(one_by_one, at_once):
    """`if t > 0.02` ended in "The truth value of an array ... is ambiguous"."""
    assert np.array_equal(moved(one_by_one), moved(at_once))


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (float("nan"), "found the number nan"),
        (lambda t: np.where(t > 0.02, np.nan, 1.0), "is nan at 0.02005 s"),
        (lambda t: np.full_like(t, np.nan), "is nan at 0 s, expected finite numbers"),
        (np.full(1001, np.inf), "is inf at 0 s"),
        (lambda t: "2 N", 'its function returns the text "2 N", expected a number'),
        (lambda t: {"R_D": t}, "its function returns the dict"),
        (np.ones(10), "10 samples, expected 1001, one each 0.05 ms from 0 to 0.05 s.*np.interp"),
    ],
)
def test_an_input_that_is_no_number_is_not_called_an_unstable_loop(force, words):
    """NaN ended in "signals grow beyond all bounds", a text in a ValueError."""
    with pytest.raises(ModelError, match=words):
        moved(force)
    with pytest.raises(ModelError, match=words):
        td.simulate_many(LOOP, {}, duration=0.05, inputs={"R_D": force})


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
