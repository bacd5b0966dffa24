"""Certificates over a box: none is accepted that is false at any point of it."""

import json
from fractions import Fraction
from hashlib import sha256

import pytest

from teleopdesign.passivity.checker import Refused, check

LOW, HIGH = Fraction(-1), Fraction(2)


def sealed(content):
    body = {k: v for k, v in content.items() if k != "digest"}
    return {**body, "digest": sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()}


def made(kind, box=None, squares=(), **fields):
    ends = {"v": [str(LOW), str(HIGH)]} if box is None else box
    return sealed({"kind": kind, "title": "t", "box": ends, "squares": [*squares], **fields})


def stable(polynomial, **more):
    return made("stable over a box", polynomial=polynomial, **more)


def one_port(above, below, scale="1", **more):
    fields = {"numerators": [[above]], "denominator": below, "scale": scale}
    return made("positive real over a box", **fields, **more)


def is_accepted(certificate):
    try:
        check(certificate)
    except Refused:
        return False
    return True


@pytest.mark.parametrize(
    ("polynomial", "holds"),
    [
        ("s + v + 3/2", True),
        ("s**2 + s*(v + 2) + v + 3/2", True),
        pytest.param("s**2 + (v - 1/3)**2*s + 1", False, marks=pytest.mark.slow),  # at v = 1/3
        ("s + v + 1", False),  # at an end
        ("s**2 + s + v", False),  # through zero
        ("s**2 + s + (v - 1/3)**2 - 1/10**8", False),  # in a dip
        ("v*s**2 + s + 1", False),  # from infinity
        ("(v + 2)*s**3 + s**2 + s + 1/2", False),  # v + 2 > 2
        ("-s - v - 3/2", True),
        # nowhere zero on the axis, and with roots at the right everywhere
        ("s - v - 3", False),
        ("s**2 - s*(v + 2) + 1", False),
        ("s**2 + s*(v + 2) - 1", False),
        ("s**3 + s**2 + s + 9 + v", False),
        ("v + 2", True),
        ("v", False),
        ("0", False),
        ("s", False),
    ],
)
def test_a_polynomial_is_stable_over_the_box_only_where_it_is_everywhere(polynomial, holds):
    assert is_accepted(stable(polynomial)) is holds


@pytest.mark.parametrize(
    ("above", "below", "holds"),
    [
        ("s + v + 1", "1", True),  # lossless at one end
        ("s**2 + (v + 2)*s + 3", "s", True),
        pytest.param("s**2 + v*s + 3", "s", False, marks=pytest.mark.slow),
        ("s**2 + s + v", "s**2 + 2*s + v", False),  # a pole grows, Re Z >= 0 on the axis
        ("s + 1", "v*(s + 1)", False),  # infinite at v = 0
        ("s + 1", "0", False),
        ("(v + 2)*s", "s**2 + 2", True),  # a lossless resonance
        pytest.param("(v - 1/3)**2*s", "s**2 + 2", False, marks=pytest.mark.slow),  # gone at 1/3
        pytest.param("s*(v - 1/3)", "s**2 + 2", False, marks=pytest.mark.slow),
    ],
)
def test_a_port_is_positive_real_over_the_box_only_where_it_is_everywhere(above, below, holds):
    assert is_accepted(one_port(above, below)) is holds


def test_a_square_is_left_out_only_where_it_divides():
    dissipated = "(s**2 + 1)**2 + (s**2 + v + 2)*s/10**6"
    assert is_accepted(one_port("s + 1", "1", squares=["x - v - 2", "0", "7", "v"]))
    assert not is_accepted(one_port(f"-({dissipated})", "s**2 + s + 1", squares=["x - 1"]))


@pytest.mark.parametrize(
    "change",
    [
        {"box": {}},
        {"box": {"s": ["0", "1"]}},
        {"box": {"__import__": ["0", "1"]}},
        {"box": {"v": ["1", "1"]}},
        {"box": [["v", "0", "1"]]},
        {"box": {f"v{k}": ["0", "1"] for k in range(9)}},
        {"squares": ["x."]},
        {"polynomial": "s + w + 3/2"},
        {"polynomial": "s**4000*v**4000 + 1"},
        {"polynomial": "s + 2 + v**200", "box": {"v": ["1/" + "7" * 3000, "2"]}},
        {"statement": "everything is passive"},
        {"kind": "positive real over a box"},
    ],
)
def test_a_certificate_that_is_not_well_formed_is_refused(change):
    good = stable("s + v + 3/2")
    assert is_accepted(good)
    assert not is_accepted(sealed({**good, **change}))
    assert not is_accepted({**good, "polynomial": "s + v + 2"})  # the digest is another's
