"""Compensation at the motor where friction also sits behind a compliant transmission.

    m_1 x_1'' = u + f_dahl(x_1) - f_1 sgn x_1' - k (x_1 - x_2) - c (x_1' - x_2')     motor
    m_2 x_2'' = k (x_1 - x_2) + c (x_1' - x_2') - f_2 sgn x_2' + f_env               link

There are two questions with two answers: passivity with any environment, also one that clamps the
link; and no release of energy in slow free motion, where friction f_2 alone holds the link.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..claims.claim import Claim, Evidence, Proof, Refutation
from ..linear.impedance import decimal
from ..rate_independent import (
    AbstractElement,
    Coulomb,
    Cycle,
    Dahl,
    Spring,
    compliance,
    lost_share,
    strongest,
    symmetric_cycle,
)
from ._hypotheses import Free, NonNegative, Positive, Whole, certificate, require_hypotheses
from .dahl_compensation import dahl_compensation


@require_hypotheses
def any_environment(
    *,
    motor_level: Positive,
    link_level: NonNegative,
    transmission_stiffness: Positive,
    compensator_level: Positive,
    compensator_stiffness: Positive,
    motor_inertia: Positive = 1,
    link_inertia: Positive = 1,
    transmission_damping: NonNegative = 0,
) -> Claim:
    """Is the joint passive for any environment and any stroke: if and only if f_D <= f_1?

    The limit does not depend on k and f_2.

    motor_level, link_level: f_1, f_2, N;  transmission_stiffness: k, N/m
    compensator_level: f_D, N;  compensator_stiffness: sigma_D, N/m
    motor_inertia, link_inertia: kg;  transmission_damping: c, N s/m
    returns: proved; else refuted by a cycle of the motor, with the link clamped and the force of
        the spring balanced by the environment
    """
    f_1, f_d = motor_level, compensator_level
    statement = (
        f"a joint with motor friction {decimal(f_1)} N, compensated there by {decimal(f_d)} N, is "
        "passive beside any environment"
    )
    if f_d > f_1:
        clamped = dahl_compensation(
            coulomb_level=f_1,
            compensator_level=f_d,
            compensator_stiffness=compensator_stiffness,
        )
        return Claim(statement, clamped.verdict)
    made = certificate(
        "motor_and_link",
        f_1=f_1,
        f_2=link_level,
        k=transmission_stiffness,
        c=transmission_damping,
        m_1=motor_inertia,
        m_2=link_inertia,
        f_D=f_d,
    )
    equality = "while the motor slides" if f_d == f_1 else ""
    method = "V = kinetic energies + k (x_1 - x_2)^2/2"
    return Claim(statement, Proof(method, (made,), float(f_1 - f_d), "N", equality))


@require_hypotheses
def free_motion(
    *,
    motor_level: Positive,
    link_level: Positive,
    transmission_stiffness: Positive,
    compensator_level: Positive,
    compensator_stiffness: Positive,
    rng: Free = 0,
    paths: Whole = 2000,
) -> Claim:
    """Does slow free motion of the joint never release energy?

    Plain symmetric cycles of the motor release none if and only if f_D <= f_1 + f_2 and
    f_D (1 - tanh(u)/u) <= f_1, u = sigma_D f_2/(k f_D). If this fails, a cycle refutes the claim.
    If it holds, other closed paths are searched. Cycles with a small step back and forth at each
    reversal release more, because the bristle forgets the last stroke at the cost of little
    friction. Random paths follow.

    motor_level, link_level: f_1, f_2, N;  transmission_stiffness: k, N/m
    compensator_level: f_D, N;  compensator_stiffness: sigma_D, N/m
    rng: draws the random paths, or the seed of the generator that does;  paths: their number
    returns: refuted by a closed path, or evidence, because the searched paths are not all motions
    """
    rng, levels = np.random.default_rng(rng), (motor_level, link_level, compensator_level)
    f_1, f_2, f_d = map(float, levels)
    k, sigma = float(transmission_stiffness), float(compensator_stiffness)
    helps = Dahl(f_d, sigma)
    against: list[AbstractElement] = [Coulomb(f_1), Spring(f_2, k)]
    texts = [decimal(x) for x in (*levels, transmission_stiffness, compensator_stiffness)]
    statement = (
        f"slow free motion of a joint (motor {texts[0]} N, link {texts[1]} N behind {texts[3]} "
        f"N/m) with compensator ({texts[2]} N, {texts[4]} N/m) releases no energy"
    )
    margin = free_motion_margin(
        motor_level=f_1,
        link_level=f_2,
        transmission_stiffness=k,
        compensator_level=f_d,
        compensator_stiffness=sigma,
    )
    cycle = _worst_cycle(helps, against) if margin < 0 else None
    if margin >= 0:
        cycle = strongest(_paths(helps, against, rng, paths))
    if cycle is not None and cycle.energy > 0:
        return Claim(statement, Refutation("a closed path of the motor", cycle))
    searched = (
        "all symmetric cycles by formula, cycles with a step back and forth at each reversal, and "
        f"{paths} random closed paths of up to ten strokes"
    )
    return Claim(statement, Evidence(margin >= 0, searched, margin, "N"))


def free_motion_margin(
    *,
    motor_level: float,
    link_level: float,
    transmission_stiffness: float,
    compensator_level: float,
    compensator_stiffness: float,
) -> float:
    """Margin of slow free motion, N; >= 0: no symmetric cycle of the motor releases energy.

    min(f_1 + f_2 - f_D, f_1 - f_D (1 - tanh(u)/u)), with u = sigma_D f_2 / (k f_D): deflection of
    the spring before the link slides, in bristle lengths (P53).

    motor_level, link_level, compensator_level: f_1, f_2, f_D, N
    transmission_stiffness, compensator_stiffness: k, sigma_D, N/m
    """
    stuck = compensator_level * lost_share(
        compensator_stiffness * link_level / (transmission_stiffness * compensator_level)
    )
    return min(motor_level + link_level - compensator_level, motor_level - stuck)


def _worst_cycle(helps: Dahl, against: Sequence[AbstractElement]) -> Cycle | None:
    """The symmetric cycle that releases most energy per travel, of a grid of amplitudes."""
    elastic = against[1].level * compliance(against[1])
    bristle = helps.level / helps.stiffness
    # well within a soft bristle nothing is released, and thousands of rounds would be travelled
    shortest = max(1e-2 * elastic, 1e-3 * bristle)
    amplitudes = [elastic, *np.geomspace(shortest, 1e6 * max(elastic, bristle), 200)]
    cycles = [symmetric_cycle(helps, against, float(a)) for a in amplitudes]
    return max(cycles, key=lambda c: c.energy / c.turning_points[0])


def _paths(
    helps: Dahl, against: Sequence[AbstractElement], rng: np.random.Generator, number: int
) -> Iterator[Cycle]:
    """Cycles with a step back and forth at each reversal, and so many random closed paths."""
    lengths = [e.level * compliance(e) for e in (helps, *against) if not isinstance(e, Coulomb)]
    for a in np.geomspace(0.3 * min(lengths), 3.0 * max(lengths), 24):
        for step in a * np.geomspace(0.003, 0.5, 8):
            points = (a, a - step, a, -a, step - a, -a)
            yield Cycle(helps, tuple(against), tuple(map(float, points)), rounds=30)
    for _ in range(number):
        scale = np.exp(rng.uniform(np.log(0.1 * min(lengths)), np.log(10 * max(lengths))))
        points = scale * rng.standard_normal(rng.integers(2, 11))
        yield Cycle(helps, tuple(against), tuple(map(float, points)), rounds=30)
