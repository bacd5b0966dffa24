"""Expressions for devices with a compliant transmission: what is printed is what is computed."""

from functools import cache

import numpy as np
import pytest
import sympy as sp

import teleopdesign as td
from teleopdesign.derive import return_difference, symbol_values
from teleopdesign.diagrams import teleoperator
from teleopdesign.frequency import loop_gain
from teleopdesign.realise.lti import S, linear_blocks
from teleopdesign.realise.tips import linear_tips

BODY = td.Body("prismatic", {"inertia": 0.2}).with_effect(td.EFFECTS["viscous"], {"damping": 1.5})
CABLE = {"tip_inertia": 0.05, "stiffness": 5e3, "damping": 1.0}
SOFT = BODY.with_effect(td.EFFECTS["transmission_compliance"], CABLE)
DAMPER = td.controller("spring_damper", {"stiffness": 0.0, "damping": 1.2})
ONE = td.haptic_interface(
    SOFT,
    hand=td.hand(mass=0.1, damping=5.0, stiffness=300.0),
    cancellation=DAMPER,
    force_feedback=td.controller("low_pass", {"bandwidth": 20.0}),
)
TWO = teleoperator(
    SOFT, BODY, coupling=td.controller("spring_damper", {"stiffness": 90.0, "damping": 1.0})
)
AT = 30j


@cache
def numbers_at(diagram):
    blocks = symbol_values(linear_blocks(linear_tips(diagram)))
    return {block: complex(sp.sympify(form).subs(S, AT)) for block, form in blocks.items()}


def value(expression, diagram):
    """The printed expression, with the numbers of its blocks, at one s."""
    return complex(sp.sympify(expression).subs(numbers_at(diagram)).subs(S, AT))


@pytest.mark.parametrize("diagram", [ONE, TWO], ids=lambda d: d.name)
def test_the_printed_expression_of_a_soft_device_has_the_value_of_its_system(diagram):
    """The text was that of a stiff device, T_MBC = Z_H (Z_H + Z_M - C)^-1, the numbers were not."""
    transfers = td.derive_transfers(diagram).transfers
    for name in list(transfers)[1:5]:
        one = transfers[name]
        system, _ = one.system()
        assert value(one.expression, diagram) == pytest.approx(complex(system(AT)), rel=1e-9), name


def test_the_named_functions_are_those_of_two_masses_on_a_spring():
    motor, tip = 0.15 * AT**2 + 1.5 * AT, 0.05 * AT**2
    spring, held = 5e3 + 1.0 * AT, 0.1 * AT**2 + 5.0 * AT + 300.0
    named = td.transfer_functions(ONE)
    for name, cancelled in (("T_o", 0.0), ("T_MBC", 1.2 * AT)):
        balance = np.array([[motor + spring - cancelled, -spring], [-spring, tip + spring + held]])
        moved = np.linalg.solve(balance, [1.0, 0.0])
        assert value(named[name], ONE) == pytest.approx(held * moved[1], rel=1e-9)


def test_the_return_difference_of_a_soft_device_is_that_of_its_loop_gain():
    gain = complex(loop_gain(ONE, controller="C")(AT))
    assert value(return_difference(ONE, "C"), ONE) == pytest.approx(1 + gain, rel=1e-9)
