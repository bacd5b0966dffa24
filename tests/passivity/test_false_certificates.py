"""Certificates that are built to deceive: none is accepted, none is confirmed by the solver."""

import json
import random

import pytest
from passivity.small_certificates import impedance, storage

from teleopdesign.passivity.checker import Refused, check


def _number(rng, low=1):
    return f"{rng.randint(low, 99)}/{rng.randint(1, 9)}"


def _same(terms):
    return {"1": terms, "-1": terms}


def _signed_storage(rng):
    """V jumps when v changes sign: free energy at each reversal."""
    a, extra = _number(rng), rng.choice(("sign_v", "abs_v", "v", "sign_v*p", "abs_v*p**2"))
    kept = storage()["proofs"]
    return storage(storage=f"p**2/(2*k) + {a}*k*{extra}", proofs={**kept, "storage": _same([])})


def _jumping_state(rng):
    """V = a + b sign_e of a state e: a jump by 2 b where e passes 0."""
    a = rng.randint(1, 9)
    return storage(
        rates={"e": "v"},
        signals=["v", "b"],
        signs=["e"],
        supply=rng.choice(("0", "-b*v**2", "0*v")),
        storage=rng.choice((f"{a}*k*(1 + sign_e)", f"{a}*k*(1 - sign_e)", f"{a}*k*sign_e**2")),
        proofs={
            "supply": _same([]),
            "storage": {"1": [[str(2 * a), {"k": 1}, "1"]], "-1": []},
        },
        example={"k": "1", "b": "0", "e": "1"},
    )


def _bent_at_a_jump(rng):
    """V = a |e| slides at e = 0: there each side alone shows a loss that is none."""
    a = rng.randint(1, 9)
    both = [["1", {}, "0"]]
    return storage(
        rates={"e": f"v - {a}*sign_e"},
        signals=["v", "b"],
        signs=["e"],
        supply=f"{a}*(sign_e*v - {a})",
        storage=f"{a}*abs_e",
        proofs={"supply": _same(both), "storage": _same([[str(a), {"abs_e": 1}, "1"]])},
        example={"k": "1", "b": "0", "v": "0", "e": "1"},
    )


def _empty_invariant(rng):
    """h >= 0 nowhere, or not at rest; all follows from it."""
    a = _number(rng)
    h = rng.choice((f"-{a} - p**2", f"-{a}", f"p - {a}", f"-{a}*k", f"p**2 - {a}", f"-p - {a}*k"))
    return storage(
        invariant={"h": {"expression": h, "rate": "0"}},
        supply=f"p*v + ({h})*v**2",
        proofs={
            "supply": _same([["1", {"h": 1}, "v"]]),
            "storage": storage()["proofs"]["storage"],
            "h": _same([]),
        },
        rates={"p": "k*v"} if rng.random() < 0.5 else {"p": "0"},
    )


def _invariant_of_one_point(rng):
    """K = {p = 0} has no inside: what holds there does not keep the motion there."""
    a = rng.randint(1, 9)
    return storage(
        invariant={"h": {"expression": f"-{a}*p**2", "rate": rng.choice(("0", "1", "b"))}},
        supply=f"p*v - {a}*p**2*v**2",
        proofs={
            "supply": _same([["1", {"h": 1}, "v"]]),
            "storage": storage()["proofs"]["storage"],
            "h": _same([["1", {"h": rng.randint(0, 2)}, rng.choice(("v", "p", "1"))]]),
        },
    )


def _reserved_invariant(rng):
    """An invariant called supply, storage or abs_v would take the place of what must be shown."""
    name = rng.choice(("supply", "storage", "abs_v", "b", "k"))
    return storage(
        invariant={name: {"expression": f"{rng.randint(1, 9)} - p**2", "rate": "0"}},
        supply="p*v - b*v**2",
    )


def _odd_weight(rng):
    """A weight that is negative or no rational number."""
    a = rng.randint(1, 9)
    weight = rng.choice((f"-{a}", f"(-{a})**(1/2)", "I", f"-{a}/2", f"{a}/0", "nan", "-0.5", "--1",
                         f"1 - {a + 1}", "sqrt(2)", "-1/1", "(0-1)", "k", "\u22121"))  # fmt: skip
    kept = storage()["proofs"]
    proofs = {**kept, "supply": _same([[weight, rng.choice(({}, {"b": 1})), "v"]])}
    return storage(supply=f"p*v + ({weight})*v**2", proofs=proofs)


def _may_divide_by_zero(rng):
    """A denominator that may vanish, in an expression or as a negative power."""
    below = rng.choice(("b", "v", "p", "k - b", "abs_v", "sign_v - 1", "k - k", "0", "b**2"))
    if rng.random() < 0.5:
        kept = storage()["proofs"]
        name = rng.choice(("b", "abs_v", "p", "v"))
        powers = {name: -rng.randint(1, 2), "b": 1} if name != "b" else {"b": -1}
        return storage(proofs={**kept, "supply": _same([["1", powers, "v"]])})
    if rng.random() < 0.5:
        return storage(storage=f"p**2/(2*k) + p**2/({below})")
    return storage(supply=f"p*v + b*v**2 + 1/({below})")


def _wrong_rate(rng):
    """More is stored than is supplied."""
    factor = rng.choice((f"{rng.randint(2, 9)}*", "-", f"1/{rng.randint(2, 9)}*", "b*", "v**2*"))
    return storage(rates={"p": f"{factor}k*v"})


def _overdrawn_supply(rng):
    """More is given than the damper takes."""
    term = rng.choice(("v**2", "b", "p**2", "abs_v", "b*v**2", "1"))
    a = _number(rng)
    kept = storage()["proofs"]
    proofs = {**kept, "supply": _same([["1", {"b": 1}, "v"], [a, {}, "v"], [a, {"abs_v": 1}, "1"]])}
    return storage(supply=f"p*v - {a}*({term})", proofs=proofs)


def _signs_missing(rng):
    """A supply that is only good for one sign of v."""
    one = {"1": [["1", {"abs_v": 1}, "1"]]}
    cases = rng.choice((one, {**one, "1 ": []}, {**one, "+1": []}, {"": []}, {}))
    proofs = {**storage()["proofs"], "supply": cases}
    return storage(supply=f"p*v + {_number(rng)}*v", proofs=proofs)


def _state_assumed(rng):
    """What a state does is assumed, in place of shown."""
    e = rng.choice(("1 - p", "p", "p**2 - v**2", "v*p", "-p", "k - p**2"))
    field = rng.choice(("positive", "nonnegative"))
    rates = {**storage()[field], "hope": e}
    proofs = {
        **storage()["proofs"],
        "supply": _same([["1", {"b": 1}, "v"], ["1", {"hope": 1}, "1"]]),
    }
    return storage(**{field: rates}, supply=f"p*v + b*v**2 + ({e})", proofs=proofs)


def _nothing_meets_it(rng):
    """Assumptions that contradict each other, or that hold only where v is not 0."""
    a = rng.randint(1, 9)
    field = rng.choice(("positive", "nonnegative"))
    e = rng.choice(("-k", f"-{a} - b", f"abs_v - {a}", f"-{a}", "-k*b - 1", "abs_v*k - 1"))
    proofs = {
        **storage()["proofs"],
        "supply": _same([["1", {"b": 1}, "v"], ["1", {"hope": 1}, "1"]]),
    }
    rates = {**storage()[field], "hope": e}
    return storage(**{field: rates}, supply=f"p*v + b*v**2 + ({e})", proofs=proofs)


def _confused_names(rng):
    """A constant that moves, a sign that is declared, a name with two meanings."""
    return storage(**rng.choice((
        {"constants": ["k", "p"]},
        {"constants": ["k", "v"]},
        {"signals": ["b", "v", "sign_v"]},
        {"signals": ["b", "v", "abs_v"]},
        {"rates": {"p": "k*v", "abs_v": "0"}},
        {"rates": {"p": "k*v", "k": "-1"}},
        {"rates": {"p": "k*v", "sign_v": "b"}},
        {"signs": ["k"]},
        {"signs": ["v", "v"]},
        {"nonnegative": {"b": "b", "k": "-1"}},
        {"nonnegative": {"b": "b", "abs_v": "-1"}},
        {"constants": [], "signals": ["b", "k", "v"]},
    )))  # fmt: skip


def _not_positive_real(rng):
    """Rational functions with a pole, a zero or a negative real part on the right."""
    a, b = rng.randint(1, 99), rng.randint(1, 99)
    return impedance(rng.choice((
        f"s - {a}", f"1/(s - {a})", f"-{a}", f"-s*{a}", f"{a}/s**2", f"{b}*s**2 + {a}",
        f"(s**2 - {a}/1000*s + 1)/(s + 1)**2", f"{a}/(s + {b})**2", f"s/(s**2 + {a})**2",
        f"(s - {a})/(s - {a} - 1/1000)", f"1/s - {a}/1000", f"s + {a}/({b} - s)",
        f"{a}*(s + {b})/(s**2 + s*{b}/2 + 1)", f"{a}/s**3", f"s**3 + {a}*s", f"-{a}/s + {b}",
    )))  # fmt: skip


FALSE = [
    _signed_storage,
    _jumping_state,
    _bent_at_a_jump,
    _empty_invariant,
    _invariant_of_one_point,
    _reserved_invariant,
    _odd_weight,
    _may_divide_by_zero,
    _wrong_rate,
    _overdrawn_supply,
    _signs_missing,
    _state_assumed,
    _nothing_meets_it,
    _confused_names,
    _not_positive_real,
]


def refuse_all(make, number, seed):
    rng = random.Random(seed)
    for _ in range(number):
        c = make(rng)
        with pytest.raises(Refused):
            check(c)
            pytest.fail(f"accepted: {json.dumps(c)}")


@pytest.mark.parametrize("make", FALSE)
def test_false_certificates_are_refused(make):
    refuse_all(make, 10, 1)
