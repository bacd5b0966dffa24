"""Every transfer function of a diagram: right for matrices, with numbers, loops told by name."""

import time

import numpy as np
import pytest
import sympy as sp
from clock import slowness
from diagrams.random_diagrams import diagrams
from diagrams.test_wiring import pair
from hypothesis import HealthCheck, Phase, assume, example, given, settings

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.derive import (
    all_transfers,
    block_symbol,
    insert_matrices,
    proved_equal,
    return_difference,
    transfer,
    transfer_functions,
)
from teleopdesign.derive.elimination import rows
from teleopdesign.diagrams import (
    ANY,
    SHIPPED,
    Attached,
    Control,
    Diagram,
    Junction,
    Moving,
    haptic_interface,
    load_shipped,
    teleoperator,
)


def looped(*junctions, blocks=(), outside=("a",)):
    return Diagram("loop", tuple(blocks), junctions, dict.fromkeys(outside, "force"), ())


INTERFACE = {"T_o", "T_MBC", "T_FF", "T_H", "Zhat_M", "L/L_D", "L/R_V", "R_M/L_D", "R_V/L"}
ADMITTANCE = {"F_H/F_u", "F_u/X", "X/F_u"}
TWO_PORT = {"Z_mm", "Z_ms", "Z_sm", "Z_ss", "h_11", "h_12", "h_21", "h_22", "Z_t", "X_m/F_u"}


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_diagram_has_every_transfer_within_two_seconds_each(name):
    start = time.process_time()
    transfers = all_transfers(load_shipped(name))
    each = (time.process_time() - start) / len(transfers.transfers)
    assert each < 2 * slowness() and not transfers.undone
    signals = transfers.diagram.signals
    expected = TWO_PORT if "X_s" in signals else ADMITTANCE if "X_d" in signals else INTERFACE
    assert expected <= set(transfers.transfers)


def test_what_a_driver_works_against_is_the_inverse_of_what_it_moves():
    for diagram in (load_shipped("haptic-interface"), pair(ANY, ANY, ANY)):
        transfers = all_transfers(diagram).transfers
        for block in diagram.bodies:
            if isinstance(block, Moving):
                impedance = transfers[f"{block.driver}/{block.motion}"].expression
                moved = transfers[f"{block.motion}/{block.driver}"].expression
                assert proved_equal(impedance * moved, sp.S(1))


def numeric(expression, blocks):
    return np.array(insert_matrices(expression, blocks, size=2).tolist(), dtype=float)


#: (1 + Zf0) Mx0 - (2 + 2 Zf0) Mx0/2 arises in it, a product of sums that is zero
VANISHING = Diagram(
    "vanishing",
    (
        Moving("Mx0", ANY, "x0", "o0", {"j3": -1, "o1": 0.5, "j1": 1, "j4": 1, "f0": 1}, "x0"),
        Moving("Mx1", ANY, "x1", "f1", {"f1": 1}, "o1"),
        Attached("Zf0", ANY, "f0", "f0", -1),
        Attached("Zf1", ANY, "j2", "f1", 1),
    ),
    (
        Junction("j0", {"j0": -1, "o1": -1}),
        Junction("j1", {"j3": 0.5, "o0": 1, "j2": -1}),
        Junction("j2", {"j0": 1, "f0": 1, "x1": 1}),
        Junction("j3", {"f1": 0.5}),
        Junction("j4", {"j1": -1}),
    ),
    {"o0": "position", "o1": "position", "o2": "force"},
    ("o0", "x1"),
)


# no search for a smaller example: with inverses of matrices in it, that takes minutes
@settings(
    max_examples=15,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.explicit, Phase.generate],
)
@given(diagrams())
@example(VANISHING)
def test_transfers_solve_the_equations_of_the_wiring_for_matrices(diagram):
    """Against numpy: all equations of the wiring at once, 2 x 2 blocks, one column an input."""
    random = np.random.default_rng(1)
    symbols = {c for row in rows(diagram) for e in row.values() for c in e.free_symbols}
    values = {
        s: sp.Matrix(2, 2, lambda *_: sp.Rational(int(random.integers(-99, 99)), 7))
        for s in sorted(symbols, key=str)
    }
    unknown = [s for s in diagram.signals if s not in diagram.outside]
    assume(unknown)
    left, right = (
        np.block([[numeric(sp.sympify(r.get(s, 0)), values) for s in names] for r in rows(diagram)])
        for names in (unknown, list(diagram.outside))
    )
    singular = np.linalg.matrix_rank(left) < len(left)
    output = unknown[-1]
    try:
        transfers = transfer(diagram, output, seconds=2.0)
    except ModelError as error:
        assume("within" not in str(error))
        assert singular, str(error)
        return
    assume(not singular and np.linalg.cond(left) < 1e6)
    solved = -np.linalg.solve(left, right)
    k = 2 * unknown.index(output)
    for i, signal in enumerate(diagram.outside):
        expected = solved[k : k + 2, 2 * i : 2 * i + 2]
        value = numeric(sp.sympify(transfers[signal]), values)
        # weights such as 0.5 are floating numbers, and inverses one inside the other lose digits;
        # a wrong term is off by the size of the blocks
        limit = 1e-7 * (1 + np.abs(expected).max())
        np.testing.assert_allclose(value, expected, rtol=0, atol=limit)


@pytest.mark.parametrize(
    ("diagram", "words"),
    [
        (looped(Junction("b", {"a": 1, "b": 1})), "loop: the loop b -> b has no solution"),
        (
            looped(Junction("b", {"a": 1, "c": 1}), Junction("c", {"b": 1})),
            "has no solution",
        ),
        (
            looped(
                Junction("e", {"a": 1, "u": 1}),
                Junction("e2", {"u": 1, "e": -1}),
                Junction("e3", {"e2": 1, "u": 1, "e": -1, "e3": 1}),
                blocks=(Control("C", ANY, "e", "u", "e"),),
            ),
            "e3",
        ),
    ],
)
def test_a_loop_without_a_solution_is_reported_by_its_signals(diagram, words):
    last = diagram.junctions[-1].output
    with pytest.raises(ModelError) as caught:
        transfer(diagram, last)
    text = str(caught.value)
    assert words in text and "->" in text and "\n" not in text


def test_a_loop_that_has_no_solution_at_its_values_only_is_reported():
    """e = a + u with u = e: the lead's gain at its pole equal to its zero is 1."""
    one = controller("lead", {"gain": 1.0, "zero": 1.0, "pole": 1.0})
    diagram = Diagram(
        "unit loop",
        (Control("C", one, "e", "u", "e"),),
        (Junction("e", {"a": 1, "u": 1}),),
        {"a": "force"},
        measured=("e",),
    )
    transfers = all_transfers(diagram)["e/a"]
    assert proved_equal(transfers.expression, (1 - block_symbol("C")) ** -1)
    with pytest.raises(ModelError, match="e/a: a loop has no solution at these values"):
        transfers.system()
    (data,) = all_transfers(diagram).as_data()["transfers"]
    assert "no solution" in data["no_system"]


def test_what_has_no_linear_form_is_named():
    data = all_transfers(load_shipped("world-haptics-2005")).as_data(speed=0.02)
    assert data["speed"] == 0.02
    assert all(t["left_out"] == ["Z_M.coulomb"] for t in data["transfers"])


def test_a_derivation_that_takes_too_long_is_named():
    transfers = all_transfers(load_shipped("haptic-interface"), seconds=-1.0)
    assert not transfers.transfers
    assert "was not derived within" in transfers.undone["T_H"] and "T_H: " in transfers.text()


def test_a_transfer_that_is_not_there_is_reported_with_the_nearest():
    with pytest.raises(ModelError, match='did you mean "T_MBC"'):
        all_transfers(load_shipped("haptic-interface"))["T_MCB"]


def test_a_diagram_that_is_no_haptic_interface_is_sent_to_the_function_for_any():
    with pytest.raises(ModelError, match="no signal L, .*derive_transfers"):
        transfer_functions(teleoperator(coupling=ANY))


def test_the_return_difference_is_that_of_the_opened_loop():
    diagram = haptic_interface(hand=ANY, force_feedback=ANY)
    Z_M, Z_H, H = map(block_symbol, ("Z_M", "Z_H", "H"))
    expected = 1 + H * Z_H * (Z_M + Z_H) ** -1
    assert proved_equal(return_difference(diagram, "H"), expected)
