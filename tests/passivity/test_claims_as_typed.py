"""Claims as a user of python-control types them, and as text."""

from importlib import import_module

import control
import numpy as np
import pytest
import sympy as sp

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    absolutely_stable,
    claim_over_intervals,
    passive,
    positive_real,
    two_port,
)
from teleopdesign.passivity.linear.impedance import readable
from teleopdesign.realise.lti import S

ONE = control.tf([1, 2], [1, 1])
BOTH = control.tf([[[1, 2], [0]], [[0], [0.5, 1]]], [[[1, 1], [1]], [[1], [1]]])
DEVICE = td.Body("prismatic", {"inertia": 0.15})
LOOP = td.haptic_interface(DEVICE.with_effect(td.EFFECTS["viscous"], {"damping": 4.0}))


@pytest.mark.parametrize(
    "claim",
    [
        positive_real(S + 1),
        positive_real(S - 1),
        claim_over_intervals(LOOP, {"Z_M.inertia": (0.1, 0.2)}),
    ],
    ids=["proved", "refuted", "over intervals"],
)
def test_a_claim_is_not_taken_for_true(claim):
    """`if positive_real(Z):` held for every Z, those that are refuted among them."""
    with pytest.raises(ModelError, match="neither true nor false.*holds"):
        bool(claim)


def test_every_result_that_may_not_hold_refuses_to_be_true():
    """A new kind of claim with three or four answers must refuse `if claim:`, too."""
    module = import_module("teleopdesign.passivity")
    kinds = [getattr(module, n) for n in dir(module)]
    with_answers = {
        k for k in kinds if isinstance(k, type) and isinstance(getattr(k, "holds", 0), property)
    }
    assert len(with_answers) >= 2
    assert not [k for k in with_answers if not hasattr(k, "__bool__")]


@pytest.mark.parametrize(
    ("system", "entries"),
    [
        ([[ONE, 0], [0, control.tf([0.5, 1], [1])]], [[(S + 2) / (S + 1), 0], [0, S / 2 + 1]]),
        (BOTH, [[(S + 2) / (S + 1), 0], [0, S / 2 + 1]]),
        (control.ss(-np.eye(2), np.eye(2), np.eye(2), np.eye(2)), sp.eye(2) * (S + 2) / (S + 1)),
        (np.array([[2.0, 1.0], [1.0, 3.0]]), [[2, 1], [1, 3]]),
    ],
)
@pytest.mark.parametrize("decide", [passive, absolutely_stable])
def test_a_two_port_of_python_control_is_that_of_its_expressions(system, entries, decide):
    """A one-port could be one, and the error for a matrix of them pointed to `two_port`."""
    assert repr(decide(two_port(system))) == repr(decide(two_port(entries)))


@pytest.mark.parametrize(
    "wrong",
    [ONE, control.rss(2, 3, 2), "ab", ["ab", "cd"], 3, np.eye(3), [[1, 2], 3], {1: 2, 3: 4}],
)
def test_what_is_no_two_port_is_refused_in_one_line(wrong):
    with pytest.raises(ModelError, match="two_port: expected"):
        two_port(wrong)


def test_a_discrete_or_measured_two_port_is_refused():
    for wrong in (control.tf([1], [1, 0.5], 0.1), control.frd(ONE, [1.0, 2.0])):
        with pytest.raises(ModelError, match="impedance: "):
            two_port([[wrong, 0], [0, 1]])


@pytest.mark.parametrize("late", [sp.S(1), sp.exp(-S / 200)])
def test_a_statement_shows_coefficients_of_the_size_of_the_impedance(late):
    """Common factors of both sides were shown, 1e51 for an impedance of some N s/m."""
    huge = sp.Rational(10) ** 40 / 7
    above, below = 3 * S**2 + sp.pi.n(30) * S + 11 * late, S**2 + S / 7 + late
    exact = sp.nsimplify(above, rational=True)
    shown = sp.sympify(readable(sp.expand(exact * huge) / sp.expand(below * huge)))
    at = {sp.Symbol("s"): 0.3 + 2j, S: 0.3 + 2j}
    assert abs(complex(shown.subs(at)) / complex((above / below).subs(at)) - 1) < 1e-5
    assert max(abs(float(x)) for x in shown.atoms(sp.Number)) < 1e3
