"""Certificates over a box: none is accepted that is false at any point of it."""

import json
from fractions import Fraction
from hashlib import sha256

import numpy as np
import pytest
from devices import body
from passivity.interval_boxes import HAND

import teleopdesign as td
from teleopdesign.passivity import claim_over_intervals
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


def random_polynomial(rng):
    """In s and v, w; often with a root that comes to the axis inside, at an end, or nearly."""

    def number(low=0.05):
        return Fraction(round(float(10 ** rng.uniform(np.log10(low), 1)) * 100), 100) + Fraction(
            1, 100
        )

    text = []
    for _ in range(int(rng.integers(1, 3))):
        a, b, c, d = (number() for _ in range(4))
        at = Fraction(int(rng.integers(-100, 200)), 100)
        less = [Fraction(0), Fraction(1, 10**6), -Fraction(1, 10**6), -a][int(rng.integers(4))]
        dip = f"({b}*(v - {at})**2 - ({less}))"
        kind = int(rng.integers(4))
        text.append(
            [f"(s + {dip})", f"(s**2 + {dip}*s + {c})", f"(s**2 + ({c} + w*v/10)*s + {d} + w*v)",
             f"(s**2 + {c}*s + {dip})"][kind]
        )  # fmt: skip
    return "*".join(text)


def roots_right(text, point):
    """Whether a root lies right of the axis by more than rounding, at a point of the box."""
    import sympy as sp

    s = sp.Symbol("s")
    poly = sp.Poly(sp.sympify(text, locals={"s": s}).subs(point), s)
    if poly.degree() < 1:
        return False
    # 1e-6: a double root that nearly meets the axis comes out of rounding
    return float(np.roots([float(c) for c in poly.all_coeffs()]).real.max()) > 1e-6


def attack(seed, number):
    rng, counts = np.random.default_rng(seed), {True: 0, False: 0}
    for _ in range(number):
        text = random_polynomial(rng)
        box = {"v": ["-1", "2"], "w": ["-1/2", "1/2"]}
        accepted = is_accepted(stable(text, box=box))
        counts[accepted] += 1
        if not accepted:
            continue
        for k in range(12):
            v = Fraction(int(rng.integers(-100, 201)), 100)
            w = (
                Fraction(int(rng.integers(-50, 51)), 100)
                if k % 3
                else Fraction(k % 2) - Fraction(1, 2)
            )
            assert not roots_right(text, {"v": v, "w": w}), (text, v, w)
    return counts


def test_no_polynomial_that_meets_the_axis_within_the_box_is_accepted():
    assert all(attack(1, 6).values())


def claims():
    device = body(0.15, viscous__damping=4.0)
    feedback = td.controller("low_pass", {"bandwidth": 20.0}).then(
        td.controller("gain", {"gain": 0.1})
    )
    loop = td.haptic_interface(device, force_feedback=feedback, hand=HAND)
    numbers = {"stiffness": 300.0, "damping": 2.0, "bandwidth": 50.0}
    side = body(0.15, viscous__damping=2.0)
    pair = td.teleoperator(side, side, coupling=td.controller("proportional_derivative", numbers))
    device_box = {"Z_M.inertia": (0.1, 0.2), "Z_M.viscous.damping": (3.0, 6.0)}
    yield claim_over_intervals(loop, device_box, points=2)
    yield claim_over_intervals(
        loop, {**device_box, "Z_H.inertia": (0.05, 0.2)}, claim="stable", points=2
    )
    for claim in ("passive", "absolutely stable"):
        yield claim_over_intervals(pair, {"Z_m.inertia": (0.1, 0.2)}, claim=claim, points=2)


@pytest.mark.slow
def test_a_mutated_certificate_is_accepted_only_where_it_is_true_at_points():
    """A number of it changed: what is still accepted is held against the test at single values."""
    rng, accepted = np.random.default_rng(5), 0
    genuine = [dict(c.content) for claim in claims() for c in claim.certificates]
    for _ in range(20):
        c = json.loads(json.dumps(genuine[int(rng.integers(len(genuine)))]))
        changed = sealed(mutated(rng, c))
        if is_accepted(changed):
            accepted += 1
            for _ in range(3):
                assert is_true_at(changed, rng), changed
    assert accepted > 2


def mutated(rng, c):
    """One number of a text, or an end of an interval, times a factor or with its sign changed."""
    factor = Fraction(rng.choice(["-1", "1/2", "2", "100", "1/100", "0"]))
    if rng.random() < 0.3:
        name = str(rng.choice([*c["box"]]))
        ends = c["box"][name]
        ends[int(rng.integers(2))] = str(Fraction(ends[0]) * factor)
        return c

    def changed(text):
        terms = text.split(" + ")
        k = int(rng.integers(len(terms)))
        terms[k] = f"({factor})*({terms[k]})" if "(" not in terms[k] else terms[k]
        return " + ".join(terms)

    fields = [n for n in ("polynomial", "denominator", "numerators") if n in c]
    field = str(rng.choice(fields))
    if field == "numerators":
        rows = c[field]
        i, j = (int(rng.integers(len(rows))) for _ in range(2))
        rows[i][j] = changed(rows[i][j])
    else:
        c[field] = changed(c[field])
    return c


def is_true_at(c, rng):
    """The same at a point of the box, by the certificates of single values."""
    import sympy as sp

    s = sp.Symbol("s")
    point = {}
    for name, (low, high) in c["box"].items():
        share = sp.Rational(int(rng.integers(0, 11)), 10)
        point[name] = sp.Rational(low) + (sp.Rational(high) - sp.Rational(low)) * share

    def there(text):
        names = {n: sp.Symbol(n) for n in point} | {"s": s}
        return sp.expand(
            sp.sympify(text, locals=names).subs({sp.Symbol(n): x for n, x in point.items()})
        )

    if "polynomial" in c:
        p = there(c["polynomial"])
        # p is stable iff the sum of its even and odd part is, as a lossless impedance and its root
        roots = np.roots([float(x) for x in sp.Poly(p, s).all_coeffs()])
        return not len(roots) or roots.real.max() < 1e-6
    below = there(c["denominator"])
    rows = [[str(sp.cancel(there(e) / below)) for e in row] for row in c["numerators"]]
    kind = c["kind"].removesuffix(" over a box")
    return is_accepted(sealed({"kind": kind, "title": "", "impedance": rows}))
