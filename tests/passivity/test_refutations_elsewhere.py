"""Whether a refutation also holds for another impedance: by its wave, or by a test of its own."""

import pytest
import sympy as sp
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity.linear.positive_real import positive_real
from teleopdesign.passivity.linear_diagrams import WHOLE, _fails, linear_claims
from teleopdesign.passivity.ports import ports
from teleopdesign.passivity.theorems import TopicClaim
from teleopdesign.passivity.two_port.claims import (
    absolutely_stable,
    is_shown_unstable,
    passive,
)
from teleopdesign.passivity.two_port.late_one_port import late_one_port
from teleopdesign.passivity.two_port.several_ports import passive_together
from teleopdesign.passivity.two_port.two_port import two_port
from teleopdesign.realise.lti import S


def dip(at, depth=2):
    """Damping of 1 N s/m less a resonance: 1 - depth at that angular frequency, rad/s."""
    s = S / at
    return 1 - depth * s / 5 / (s**2 + s / 5 + 1)


LATE = sp.exp(-S / 100)


def one_port(z):
    judge = late_one_port if z.has(sp.exp) else positive_real
    return TopicClaim("", judge(z))


def both(z):
    return TopicClaim("", passive(two_port(z.tolist())))


def together(z):
    return TopicClaim("", passive_together(z))


def any_hands(z):
    return TopicClaim("", absolutely_stable(two_port(z.tolist())))


def diagonal(*entries):
    return sp.diag(*(sp.sympify(e) for e in entries))


def transfer(gain, wide=1):
    """A two-port that hands on a force as `gain` allows: stable up to 1, passive up to 0."""
    return sp.Matrix([[1 + S * wide, -gain], [gain, 1 + S]])


@pytest.mark.parametrize(
    ("claim", "there", "fails"),
    [
        (one_port(dip(1)), diagonal(dip(1)), True),
        (one_port(dip(1)), diagonal(dip(100)), True),
        (one_port(dip(1)), diagonal(dip(1, sp.Rational(1, 2))), False),
        (one_port(dip(1)), diagonal(dip(100, 3) + 2 * LATE / 100), True),
        (one_port(dip(1)), diagonal(3 + LATE), False),
        (one_port(1 + 2 * LATE), diagonal(1 + 3 * LATE), True),
        (one_port(1 + 2 * LATE), diagonal(1 + LATE / 2), False),
        (both(diagonal(dip(1), 1)), diagonal(dip(1), 2), True),
        (both(diagonal(dip(1), 1)), diagonal(dip(100), 1), True),
        (both(diagonal(dip(1), 1)), diagonal(1, dip(30)), True),
        (both(diagonal(dip(1), 1)), diagonal(dip(1, 1), 1), False),
        (together(diagonal(dip(1), 1, 1)), diagonal(1, dip(50), 1), True),
        (together(diagonal(dip(1), 1, 1)), diagonal(1, dip(50, 1), 1), False),
    ],
)
def test_a_refutation_holds_where_the_impedance_there_is_active_too(claim, there, fails):
    assert claim.claim.status == "refuted"
    assert _fails(claim, there) is fails


def test_what_is_not_refuted_is_left():
    assert _fails(one_port(sp.S(1)), diagonal(-1)) is True


LOOP = sp.Matrix([[1 + S, -6 / (1 + S)], [2, 1 + S]])


@pytest.mark.parametrize(("share", "fails"), [(1, True), (sp.Rational(1, 20), False)])
def test_no_termination_unsettles_a_two_port_whose_loop_is_weak(share, fails):
    """z12 z21 turns with frequency; weak enough, |z12 z21| stays below Re z11 Re z22."""
    claim = any_hands(LOOP)
    assert claim.claim.status == "refuted"
    there = LOOP.copy()
    there[0, 1] *= share
    assert _fails(claim, there) is fails
    late = there.copy()
    late[0, 1] *= LATE
    assert is_shown_unstable(two_port(late.tolist())) is fails
    assert _fails(claim, late) is fails


def held(*laws, **effects):
    """A body that laws hold, one port."""
    names = [f"p{k}" for k in range(len(laws))]
    blocks = [Moving("M", body(0.2, **effects), "x", "u", {"f": 1}, "f")]
    blocks += [
        Control(f"C{n}", law, "x", n, "x", analog=True) for n, law in zip(names, laws, strict=True)
    ]
    return Diagram(
        "held", tuple(blocks), (Junction("u", dict.fromkeys(names, -1)),), {"f": "force"}, ("x",)
    )


def gain(k):
    return controller("gain", {"gain": k})


@pytest.mark.parametrize(
    ("less", "status"), [(0.0, "proved"), (1e-3, "refuted"), (-1e-3, "proved"), (1e-15, "unknown")]
)
def test_a_spring_taken_off_is_refuted_by_more_than_rounding(less, status):
    """The law takes off the whole spring of the body, and a part of it more."""
    diagram = held(gain(-10.0 * (1 + less)), viscous__damping=2.0, spring__stiffness=10.0)
    (one,) = linear_claims(diagram, ports(diagram))
    assert one.claim.status == status
    assert one.topic == WHOLE[1]
    if status == "unknown":
        assert "a relative change of its values by" in str(one.claim)
