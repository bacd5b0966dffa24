"""How much friction a Dahl compensator may cancel before energy comes out.

The true friction is Coulomb friction, or Dahl friction with presliding stiffness sigma_p and a
level within a range. The compensator is a Dahl element of level f_D and stiffness sigma_D on the
same position. Mahvash, Okamura, ICRA 2006 prove f_D <= f_C for Coulomb friction.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ..claims.claim import Claim, Proof
from ..identified import IdentifiedDevice
from ..linear.impedance import decimal
from ..rate_independent import Cycle, Dahl, dahl_loss, lost_share, symmetric_cycle
from ._hypotheses import Positive, PositiveOrNone, certificate, require_hypotheses
from ._theorem import Question, Time, TopicClaim, decide
from .bounded_compensation import cycle_beyond_onset, proof_of_level
from .lugre import add_bristle_damping

ORDER = 20


@require_hypotheses
def dahl_compensation(
    *,
    coulomb_level: Positive,
    compensator_level: Positive,
    compensator_stiffness: Positive,
    presliding_stiffness: PositiveOrNone = None,
    highest_level: PositiveOrNone = None,
) -> Claim:
    """Is the pair of true friction and Dahl compensator passive?

    coulomb_level: f_C, N; with `highest_level` the lowest level that can occur
    compensator_level: f_D, N;  compensator_stiffness: sigma_D, N/m
    presliding_stiffness: sigma_p of Dahl friction, N/m; None: ideal Coulomb friction
    highest_level: f_max, N, if the true level changes in any way between f_C and f_max
    returns: proved if and only if f_D <= f_C and, with presliding, sigma_D^2/f_D <=
        sigma_p^2/f_max; decided in exact numbers, equality included. Else refuted by a cycle;
        unknown where the condition fails by too little for double precision
    raises ModelError: an argument outside of its hypothesis, or highest_level below coulomb_level
    """
    f_c, f_d, stiffness = coulomb_level, compensator_level, compensator_stiffness
    top = f_c if highest_level is None else highest_level
    if top < f_c:
        raise ModelError(
            f"highest_level: {decimal(top)} N is below coulomb_level, {decimal(f_c)} N"
        )
    helps, values = Dahl(float(f_d), float(stiffness)), {"f_D": f_d, "sigma_D": stiffness}
    compensator = f"a Dahl compensator ({decimal(f_d)} N, {decimal(stiffness)} N/m)"
    if presliding_stiffness is None:
        return decide(
            f"Coulomb friction {decimal(f_c)} N with {compensator} is passive",
            f_d <= f_c,
            proof=lambda: proof_of_level(
                "storage 0, abs(d) <= f_D <= f_C",
                f_d,
                f_c,
                certificate("dahl_bound", f_C=f_c, **values),
                certificate("sampled_bound", f_D=f_d),
            ),
            motion=lambda: cycle_beyond_onset(helps, float(f_c)),
            how="a cycle beyond the onset amplitude",
        )
    p = presliding_stiffness
    levels = f"{decimal(f_c)} N" if top == f_c else f"{decimal(f_c)} to {decimal(top)} N"
    return decide(
        f"Dahl friction ({levels}, {decimal(p)} N/m) with {compensator} is passive",
        f_d <= f_c and stiffness**2 * top <= p**2 * f_d,
        proof=lambda: _pair_proof(f_c, top, f_d, stiffness, p),
        motion=lambda: _best_cycle(helps, Dahl(float(f_c if f_d > f_c else top), float(p))),
        how="a cycle of "
        + ("large motion: f_D > f_C" if f_d > f_c else "small motion: sigma_D^2/f_D too large"),
        why_open="the condition fails, but by so little that no cycle shows it in double precision",
    )


def largest_passive_level(*, coulomb_level: float, stiffness: float, amplitude: float) -> float:
    """Level f_D, N, at which cycles of one amplitude neither release nor take energy.

    It solves f_D (1 - tanh(u)/u) = f_C, u = sigma_D A/f_D. It is above f_C for every amplitude, and
    higher for a softer compensator.

    coulomb_level: f_C, N;  stiffness: sigma_D, N/m;  amplitude: A, m
    returns: inf where no level releases energy
    """
    from scipy.optimize import brentq, minimize_scalar

    _refuse_not_positive(
        "largest_passive_level: expected levels, stiffness and amplitude > 0",
        coulomb_level,
        stiffness,
        amplitude,
    )

    def out(level: float) -> float:
        return dahl_loss(level, stiffness, amplitude) / (4 * amplitude) - coulomb_level

    # beyond the best level the compensator becomes a spring, which releases nothing
    best = minimize_scalar(lambda u: -lost_share(u) / u, bounds=(0.1, 10.0), method="bounded")
    most = max(stiffness * amplitude / float(best.x), coulomb_level)
    if out(most) <= 0:
        return float("inf")
    return float(brentq(out, coulomb_level, most, xtol=1e-12 * coulomb_level))


def largest_ratio(u: float, *, motion: Literal["cycles", "closed paths"] = "cycles") -> float:
    """Largest f_D/f_C with which motions within an amplitude release no energy.

    u: amplitude in bristle lengths, sigma_D A/f_D, either way
    motion: "cycles": plain cycles of this amplitude, exact, 1/(1 - tanh(u)/u);
        "closed paths": every closed path within it, sufficient, 1/(1 - e^(-2 u))^2 (P56). A motion
        that does not return may release the energy of the bristle once: `largest_one_off_energy`
    raises ModelError: u is not > 0
    """
    if u <= 0:
        raise ModelError(f"largest_ratio: expected an amplitude > 0, found u = {u:g}")
    return 1 / lost_share(u) if motion == "cycles" else 1 / math.expm1(-2 * u) ** 2


def largest_one_off_energy(*, level: float, stiffness: float, u: float) -> float:
    """Most energy that a motion within an amplitude can release once, from rest, J (P56).

    It is the energy of the compensator's bristle, f_D^2 (1 - e^(-2 u))^2/(2 sigma_D), wherever
    f_D <= largest_ratio(u, motion="closed paths") f_C.

    level: f_D, N;  stiffness: sigma_D, N/m;  u: amplitude in bristle lengths, either way
    """
    _refuse_not_positive(
        "largest_one_off_energy: expected level, stiffness and amplitude > 0", level, stiffness, u
    )
    return (level * math.expm1(-2 * u)) ** 2 / (2 * stiffness)


def _refuse_not_positive(expected: str, *values: float) -> None:
    if min(values) <= 0:
        raise ModelError(f"{expected}, found {', '.join(f'{x:g}' for x in values)}")


def onset_amplitude(
    *, coulomb_level: float, compensator_level: float, compensator_stiffness: float
) -> float:
    """Amplitude, m, from which on symmetric cycles release energy; inf where f_D <= f_C.

    There f_D (1 - tanh(u)/u) = f_C, u = sigma_D A/f_D.

    coulomb_level: f_C, N;  compensator_level: f_D, N;  compensator_stiffness: sigma_D, N/m
    """
    from scipy.optimize import brentq

    f_c, f_d, stiffness = map(float, (coulomb_level, compensator_level, compensator_stiffness))
    if f_d <= f_c:
        return float("inf")
    beyond = f_d / (f_d - f_c)  # there 1 - tanh(u)/u > 1 - 1/u = f_C/f_D
    u = brentq(lambda u: f_d * lost_share(u) - f_c, 1e-300, beyond, xtol=1e-300, rtol=1e-14)
    return float(u) * f_d / stiffness


def _pair_proof(
    f_c: sp.Expr, top: sp.Expr, f_d: sp.Expr, stiffness: sp.Expr, presliding: sp.Expr
) -> Proof:
    equality = ["small motion"] if stiffness**2 * top == presliding**2 * f_d else []
    values = {"f_D": f_d, "sigma_D": stiffness}
    if stiffness == presliding:  # then the conditions leave f_D = f_C = f_max
        method, made = "V = f abs(p - d)/sigma", certificate("identical_pair", **values)
    else:
        method = "a quadratic storage function"
        made = certificate("presliding_pair", **values, sigma_p=presliding, F_min=f_c, F_max=top)
    return proof_of_level(method, f_d, f_c, made, also=equality)


def _best_cycle(helps: Dahl, against: Dahl) -> Cycle | None:
    """A symmetric cycle that releases at least half of the largest share of energy; else None.

    Of all such cycles the one with the amplitude nearest to the bristle lengths.
    """
    lengths = [e.level / e.stiffness for e in (helps, against)]
    middle = math.sqrt(lengths[0] * lengths[1])
    amplitudes = np.geomspace(1e-2 * min(lengths), 1e12 * max(lengths), 600)

    def share(amplitude: float) -> float:
        gives, takes = (dahl_loss(e.level, e.stiffness, amplitude) for e in (helps, against))
        return 1 - takes / gives

    shares = np.array([share(float(a)) for a in amplitudes])
    if shares.max() < 1e-12:  # within rounding
        return None
    good = amplitudes[shares >= shares.max() / 2]
    best = good[np.argmin(np.abs(np.log(good / middle)))]
    return symmetric_cycle(helps, [against], float(best))


def dahl_claim(
    device: IdentifiedDevice, level: float, stiffness: float, *, certain: bool = True
) -> Claim:
    """The claim about a device's friction with a Dahl compensator, bristle damping counted.

    level: f_D, N;  stiffness: sigma_D, N/m
    certain: for all values within the intervals; else at the estimates
    """
    presliding = device.presliding
    low = device.lowest.low if certain else device.lowest.estimate
    high = device.highest.high if certain else device.highest.estimate
    values = dict(coulomb_level=low, compensator_level=level, compensator_stiffness=stiffness)
    if presliding is None:
        return dahl_compensation(**values)
    softest = presliding.low if certain else presliding.estimate
    return add_bristle_damping(
        dahl_compensation(**values, presliding_stiffness=softest, highest_level=high),
        coulomb_level=low,
        highest_level=high,
        stiffness=softest,
        bristle_damping=device.bristle_damping.high if certain else device.bristle_damping.estimate,
        viscous_damping=device.damping.low if certain else device.damping.estimate,
    )


def claims(question: Question) -> list[TopicClaim]:
    """Claims at the estimates, and for all values within the intervals; in continuous time."""
    if question.bristle is None:
        return []
    device, (level, stiffness) = question.device, question.bristle
    ideal = device.presliding is None
    when = ", continuous time" if question.computer is not None and not ideal else ""
    # beside ideal friction it rests on the bound alone, which a computer may keep too
    time: Time = question.time_of_bound if ideal else "continuous"
    certain = TopicClaim(f"95 % interval{when}", dahl_claim(device, level, stiffness), time=time)
    if not question.estimates:
        return [certain]
    estimate = dahl_claim(device, level, stiffness, certain=False)
    return [TopicClaim(f"estimate{when}", estimate, time=time), certain]
