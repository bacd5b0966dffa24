"""Certificates for friction that is cancelled by a law of velocity.

v is the velocity, c = f_D v/(a + abs(v)) the compensator, f_C or p the friction, B the damping. The
proofs hold for all parameters that meet the stated inequalities.
"""

from __future__ import annotations

import sympy as sp

from ..claims.certificate import Certificate, Term, storage_certificate
from ._dahl_certificates import F, Values, abs_v, dahl_rate, f_C, f_D, p, sigma_p, sign_v, v

a, B = sp.symbols("a B", real=True)
_HELP = f_D * v**2 / (a + abs_v)


def ideal_contact(*, f_c: sp.Expr, f_d: sp.Expr, smoothing: sp.Expr, b: sp.Expr) -> Certificate:
    """Coulomb friction and damping cover the law at every speed: no power comes out.

    (f_C + B abs(v)) (a + abs(v)) >= f_D abs(v)
    """
    if smoothing == 0:  # then c = f_D sgn v, and f_D <= f_C
        return _ideal_contact_unsmoothed({"f_C": f_c, "f_D": f_d, "B": b})
    gap = f_D - f_C - a * B
    values = {"f_C": f_c, "f_D": f_d, "a": smoothing, "B": b}
    nonnegative = {"f_C": f_C, "a": a, "B": B}
    positive = {"speed": a + abs_v}
    if f_d <= f_c + smoothing * b:
        nonnegative["spare"] = -gap
        lost: list[Term] = [
            (1, {"abs_v": 1, "speed": -1, "f_C": 1, "a": 1}, 1),
            (1, {"abs_v": 1, "speed": -1, "B": 1}, v),
            (1, {"speed": -1, "spare": 1}, v),
        ]
        reads = "f_D <= f_C + a B"
    else:
        nonnegative["enough"] = 4 * f_C * a * B - gap**2
        positive["B"] = nonnegative.pop("B")
        quarter = sp.Rational(1, 4)
        lost = [
            (1, {"abs_v": 1, "speed": -1, "B": 1}, abs_v - gap / (2 * B)),
            (quarter, {"abs_v": 1, "speed": -1, "B": -1, "enough": 1}, 1),
        ]
        reads = "(f_D - f_C - a B)^2 <= 4 f_C a B"
    return storage_certificate(
        f"Coulomb friction f_C and damping B cover f_D v/(a + abs(v)) at every speed where {reads}",
        supply=(f_C * sign_v + B * v) * v - _HELP,
        positive=positive,
        nonnegative=nonnegative,
        signs=["v"],
        proofs={"supply": {"": lost}, "storage": {"": ()}},
        example={**values, "v": 1},
    )


def _ideal_contact_unsmoothed(values: Values) -> Certificate:
    lost: list[Term] = [(1, {"abs_v": 1, "enough": 1}, 1), (1, {"B": 1}, v)]
    return storage_certificate(
        "Coulomb friction f_C and damping B cover f_D sgn(v) at every speed where f_D <= f_C",
        supply=(f_C * sign_v + B * v - f_D * sign_v) * v,
        nonnegative={"enough": f_C - f_D, "B": B},
        signs=["v"],
        proofs={"supply": {"": lost}, "storage": {"": ()}},
        example={**values, "v": 1},
    )


def yielding_contact(
    *, f_d: sp.Expr, smoothing: sp.Expr, b: sp.Expr, stiffness: sp.Expr
) -> Certificate:
    """Dahl friction of any level F(t) and damping B cover the law where f_D <= a B.

    Storage: V = p^2/(2 sigma_p)
    """
    lost: list[Term] = [
        (1, {"abs_v": 1, "F": -1}, p),
        (1, {"speed": -1, "enough": 1}, v),
        (1, {"speed": -1, "abs_v": 1, "B": 1}, v),
    ]
    return storage_certificate(
        "Dahl friction p of any level and damping B cover f_D v/(a + abs(v)) where f_D <= a B",
        supply=(p + B * v) * v - _HELP,
        storage=p**2 / (2 * sigma_p),
        rates={"p": dahl_rate(p, F, sigma_p)},
        constants=["sigma_p"],
        positive={"F": F, "sigma_p": sigma_p, "speed": a + abs_v},
        nonnegative={"enough": a * B - f_D, "B": B},
        signs=["v"],
        proofs={
            "supply": {"": lost},
            "storage": {"": [(sp.Rational(1, 2), {"sigma_p": -1}, p)]},
        },
        example={"f_D": f_d, "a": smoothing, "B": b, "sigma_p": stiffness, "F": 1, "v": 1},
    )


def held_command(*, least: sp.Expr, b: sp.Expr) -> Certificate:
    """A command c of an earlier sample, held over a sample, releases no energy in the sum.

    u and w are the mean velocities of the sample and of the earlier sample.
    """
    u, w, c, f_0, abs_u, abs_w = sp.symbols("u w c f_0 abs_u abs_w", real=True)
    bound = f_0 + B * abs_w
    apart: Term = (sp.Rational(1, 2), {"B": 1}, abs_u - abs_w)
    return storage_certificate(
        "a held command with abs(c) <= f_0 + B abs(w), w of an earlier sample, takes mean power "
        "f_0 abs(u) + B u^2 - c u >= B (u^2 - w^2)/2, which sums up to no less than 0",
        supply=f_0 * abs_u + B * (u**2 + w**2) / 2 - c * u,
        nonnegative={"f_0": f_0, "B": B, "below": bound - c, "above": bound + c},
        signs=["u", "w"],
        proofs={
            "supply": {
                f"{s} {t}": [apart, (1, {"abs_u": 1, "below" if s > 0 else "above": 1}, 1)]
                for s in (1, -1)
                for t in (1, -1)
            },
            "storage": {"": ()},
        },
        example={"f_0": least, "B": b, "c": 0, "u": 1, "w": 1},
    )
