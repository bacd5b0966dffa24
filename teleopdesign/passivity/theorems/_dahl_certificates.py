"""Certificates of friction compensation: storage functions for all parameters at once.

The rate of Dahl friction comes from the effect `presliding`. v is the velocity, p the friction
force of the plant, d the force of the compensator. So the supply is (p - d) v.
"""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from ...effects import EFFECTS
from ..claims.certificate import Certificate, Term, storage_certificate

v, abs_v, sign_v, p, d = sp.symbols("v abs_v sign_v p d", real=True)
f_D, f_C, F, F_min, F_max = sp.symbols("f_D f_C F F_min F_max", real=True)
sigma_D, sigma_p = sp.symbols("sigma_D sigma_p", real=True)

Values = Mapping[str, sp.Expr]


def dahl_rate(force: sp.Expr, level: sp.Expr, stiffness: sp.Expr) -> sp.Expr:
    """Rate df/dt of the force f of Dahl friction (N/s), with abs_v for abs(v)."""
    now = {"velocity": v, "level": level, "bristle": force / stiffness}
    rates = EFFECTS["presliding"].rates(now, {"stiffness": stiffness})
    return sp.expand(stiffness * rates["bristle"].subs(sp.Abs(v), abs_v))


def bounded_compensator(values: Values) -> Certificate:
    """Coulomb friction f_C with any compensator, abs(d) <= f_D <= f_C, releases no energy.

    values: f_C and f_D, an example that meets the assumptions
    """
    forward: list[Term] = [(1, {"abs_v": 1, "enough": 1}, 1)]
    return storage_certificate(
        "Coulomb friction f_C and any compensating force with abs(d) <= f_D <= f_C: power is lost "
        "at every instant, storage 0",
        supply=(f_C * sign_v - d) * v,
        nonnegative={"enough": f_C - f_D, "above": f_D + d, "below": f_D - d},
        signs=["v"],
        proofs={
            "supply": {
                "1": [*forward, (1, {"abs_v": 1, "below": 1}, 1)],
                "-1": [*forward, (1, {"abs_v": 1, "above": 1}, 1)],
            },
            "storage": {"": ()},
        },
        example={**values, "d": 0, "v": 1},
    )


def dahl_bound(values: Values) -> Certificate:
    """A Dahl compensator keeps abs(d) <= f_D, so Coulomb friction f_C >= f_D covers its force.

    values: f_C, f_D and sigma_D
    """
    decay = sigma_D * abs_v / f_D
    forward: list[Term] = [(1, {"abs_v": 1, "enough": 1}, 1)]
    kept: list[Term] = []
    return storage_certificate(
        "Coulomb friction f_C and a Dahl compensator that starts with abs(d) <= f_D <= f_C: power "
        "is lost at every instant, storage 0",
        supply=(f_C * sign_v - d) * v,
        rates={"d": dahl_rate(d, f_D, sigma_D)},
        constants=["f_D"],
        positive={"f_D": f_D, "sigma_D": sigma_D},
        nonnegative={"enough": f_C - f_D},
        invariant={"below": (f_D - d, decay), "above": (f_D + d, decay)},
        signs=["v"],
        proofs={
            "supply": {
                "1": [*forward, (1, {"abs_v": 1, "below": 1}, 1)],
                "-1": [*forward, (1, {"abs_v": 1, "above": 1}, 1)],
            },
            "storage": {"": ()},
            "below": {"1": kept, "-1": [(2, {"abs_v": 1, "sigma_D": 1}, 1)]},
            "above": {"-1": kept, "1": [(2, {"abs_v": 1, "sigma_D": 1}, 1)]},
        },
        example={**values, "d": 0, "v": 1},
    )


def sampled_bound(values: Values) -> Certificate:
    """The exact step of a Dahl compensator over a travel keeps abs(d) <= f_D.

    d' = s f_D + (d - s f_D) E, 0 <= E <= 1;  values: f_D
    """
    e = sp.Symbol("E", real=True)
    after = sign_v * f_D + (d - sign_v * f_D) * e
    both: Term = (1, {"below": 1, "above": 1, "E": 2}, 1)
    return storage_certificate(
        "after a travel of sign s the Dahl force d' = s f_D + (d - s f_D) E, 0 <= E <= 1, is still "
        "within f_D: (f_D - d') (f_D + d') >= 0",
        supply=(f_D - after) * (f_D + after),
        nonnegative={"below": f_D - d, "above": f_D + d, "E": e, "rest": 1 - e, "f_D": f_D},
        signs=["v"],
        proofs={
            "supply": {
                "1": [both, (2, {"below": 1, "f_D": 1, "E": 1, "rest": 1}, 1)],
                "-1": [both, (2, {"above": 1, "f_D": 1, "E": 1, "rest": 1}, 1)],
            },
            "storage": {"": ()},
        },
        example={**values, "d": 0, "E": sp.Rational(1, 2), "v": 1},
    )


def presliding_pair(values: Values) -> Certificate:
    """Dahl friction (sigma_p, any level F(t) in F_min..F_max) with a Dahl compensator is passive.

        V = ((sigma_p + sigma_D) (p^2/sigma_p + d^2/sigma_D)/2 - 2 p d)/(sigma_p - sigma_D)

    where f_D <= F_min, sigma_D^2/f_D <= sigma_p^2/F_max and sigma_D < sigma_p.
    values: f_D, sigma_D, sigma_p, F_min, F_max
    """
    total, softer = sigma_p + sigma_D, sigma_p - sigma_D
    mixed = sigma_p * f_D + sigma_D * F
    square = sp.Rational(1, 2)
    storage = (total * (p**2 / sigma_p + d**2 / sigma_D) / 2 - 2 * p * d) / softer
    rest = {"abs_v": 1, "softer": -1, "F": -1, "f_D": -2, "total": -1}
    products: list[Term] = [
        (1, {**rest, low: 1, high: 1}, d * root)
        for low in ("covered", "above_min")
        for high, root in (("soft_enough", 1), ("below_max", sigma_D))
    ]
    lost: list[Term] = [
        (1, {"abs_v": 1, "softer": -1, "F": -1, "total": 1}, p - mixed / (total * f_D) * d),
        *products,
    ]
    stored: list[Term] = [
        (square, {"total": 1, "softer": -1, "sigma_p": -1}, p - 2 * sigma_p / total * d),
        (square, {"softer": 1, "total": -1, "sigma_D": -1}, d),
    ]
    return storage_certificate(
        "Dahl friction p (stiffness sigma_p, any level F(t) within F_min..F_max) less a Dahl "
        "compensator d (sigma_D, f_D) is passive where f_D <= F_min, sigma_D^2/f_D <= "
        "sigma_p^2/F_max and sigma_D < sigma_p",
        supply=(p - d) * v,
        storage=storage,
        rates={"p": dahl_rate(p, F, sigma_p), "d": dahl_rate(d, f_D, sigma_D)},
        constants=["sigma_p", "sigma_D", "f_D"],
        positive={
            "F": F,
            "f_D": f_D,
            "sigma_p": sigma_p,
            "sigma_D": sigma_D,
            "softer": softer,
            "total": total,
        },
        nonnegative={
            "covered": F_min - f_D,
            "soft_enough": f_D * sigma_p**2 - F_max * sigma_D**2,
            "above_min": F - F_min,
            "below_max": F_max - F,
        },
        signs=["v"],
        proofs={"supply": {"": lost}, "storage": {"": stored}},
        example={**values, "F": values["F_min"], "v": 1},
    )


def identical_pair(values: Values) -> Certificate:
    """Dahl friction with a Dahl compensator of the same level f and stiffness sigma is passive.

    The difference e = p - d only decays. Storage: V = f abs(e)/sigma
    values: f_D, sigma_D
    """
    e, abs_e = sp.symbols("e abs_e", real=True)
    rate = sp.expand(dahl_rate(d + e, f_D, sigma_D) - dahl_rate(d, f_D, sigma_D))
    both: list[Term] = [(2, {"abs_v": 1, "abs_e": 1}, 1)]
    return storage_certificate(
        "Dahl friction less a Dahl compensator of the same level and stiffness is passive",
        supply=e * v,
        storage=f_D * abs_e / sigma_D,
        rates={"e": rate},
        constants=["f_D", "sigma_D"],
        positive={"f_D": f_D, "sigma_D": sigma_D},
        signs=["v", "e"],
        proofs={
            "supply": {"1 1": both, "-1 -1": both},
            "storage": {"": [(1, {"abs_e": 1, "f_D": 1, "sigma_D": -1}, 1)]},
        },
        example={**values, "v": 1, "e": 1},
    )
