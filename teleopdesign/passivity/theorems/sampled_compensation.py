"""A Dahl compensator in a computer, with friction that deflects before it slides.

In continuous time the pair is passive for a wedge of parameters (`dahl_compensation`). In a
computer it is passive for no parameters. Dahl friction relaxes under small motion back and forth:
over n small strokes of length L about one position its force falls by e^(-n L/lambda), at almost no
work. Let a hand tremble once per sample and drift by a share r of its path. The mean friction is
then r f_C. The compensator reads only the drift, and helps with f_D. So

    energy released per sample  ->  r L (f_D - r f_C) - B L^2/T,    r < f_D/f_C, L small,

is positive for every f_D, sigma_D, damping B and sample period T. The energy is small: no law
within f_D releases more power than f_D^2/(4 B), and a tremor in step with the clock is an unlikely
motion. Many real contacts do not relax in this way, because their small loops close on themselves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..claims.claim import Claim
from ..linear.impedance import decimal
from ..rate_independent import AbstractMotion, Dahl
from ..search.stroke_motion import Strokes
from ._hypotheses import NonNegative, Positive, PositiveOrNone, Whole, require_hypotheses
from ._theorem import Question, TopicClaim, refute
from .bounded_compensation import bounded_compensation

ORDER = 40

#: most samples, one way, of a motion that refutes a claim
LONGEST = 10_000_000


@dataclass(frozen=True)
class Trembling(AbstractMotion):
    """A trembling motion: in each sample a stroke forth and a shorter stroke back.

    The motion drifts forth for a number of samples, and then in the same way back to its start.

    compensator: the sampled law, which reads the drift alone;  friction: the element that resists
    damping: B, N s/m;  sample_time: T, s
    forth, back: the two strokes of a sample, at one speed, m;  samples: number, one way
    late: delay of the compensator's force in samples
    """

    compensator: Dahl
    friction: Dahl
    damping: float
    sample_time: float
    forth: float
    back: float
    samples: int
    late: int = 0
    kind = "trembling"

    @property
    def power(self) -> float:
        """Power released during the drift, after its transient, W."""
        return self._steady_sample()[0] / self.sample_time

    @property
    def path(self) -> float:
        """Length of the path in one sample, m."""
        return self.forth + self.back

    def replay(self) -> float:
        """Energy released, J, from rest without preload back to the start.

        With exact formulas for each stroke, summed over all samples.
        """
        force, read, out = 0.0, [0.0] * (self.late + 1), 0.0
        for _ in range(2):  # the way back is the way there with all signs turned
            steady, forgets, by_force = self._steady_sample()[1:]
            k = np.arange(self.samples)
            forces = steady + (force - steady) * forgets**k
            work = self._work(0.0) * self.samples + by_force * float(forces.sum())
            level, net = self.compensator.level, self.forth - self.back
            length = level / self.compensator.stiffness
            helped = level + (read[-1] - level) * np.exp(-net / length * np.arange(1, k[-1] + 2))
            helped = np.concatenate([read, helped])
            out += net * float(helped[: self.samples].sum()) - work
            out -= self.damping * self.path**2 / self.sample_time * self.samples
            force = -float(steady + (force - steady) * forgets**self.samples)
            read = [-float(d) for d in helped[self.samples : self.samples + self.late + 1]]
        return out

    def strokes(self) -> Strokes:
        """The motion as strokes that begin and end at rest, in step with the samples."""
        there = np.cumsum(np.tile([self.forth, -self.back], self.samples))
        points = np.concatenate([there, there[-1] - there])[:-1]
        speed = math.pi * self.path / (2 * self.sample_time)
        return Strokes(tuple(map(float, points)), speed, rounds=1)

    def _steady_sample(self) -> tuple[float, float, float, float]:
        """Properties of a sample after the transient.

        returns: energy released, J; friction force at the begin, N; share of a force at the begin
            that remains at the end; and work of friction per newton of force at the begin, m
        """
        length, level = self.friction.level / self.friction.stiffness, self.friction.level
        forth, back = -math.expm1(-self.forth / length), -math.expm1(-self.back / length)
        lost = -math.expm1(-self.path / length)
        force = level * (forth * (1 - back) - back) / lost
        by_force = length * (forth - (1 - forth) * back)
        work = self._work(0.0) + by_force * force
        helped = self.compensator.level * (self.forth - self.back)
        energy = helped - work - self.damping * self.path**2 / self.sample_time
        return energy, force, 1 - lost, by_force

    def _work(self, force: float) -> float:
        """Work that friction takes over one sample, J; force: of friction at the begin, N."""
        there, first = self.friction.leg(force, self.forth)
        return first + self.friction.leg(there, -self.back)[1]


@require_hypotheses
def sampled_compensation(
    *,
    coulomb_level: Positive,
    compensator_level: Positive,
    compensator_stiffness: Positive,
    sample_time: Positive,
    presliding_stiffness: PositiveOrNone = None,
    viscous_damping: NonNegative = 0,
    late: Whole = 0,
) -> Claim:
    """Is friction passive together with a Dahl compensator in a computer?

    coulomb_level: f_C, N: of ideal friction the lowest level that can occur, of Dahl friction the
        highest
    compensator_level: f_D, N;  compensator_stiffness: sigma_D, N/m
    sample_time: T, s;  viscous_damping: B, N s/m
    presliding_stiffness: of Dahl friction, N/m; None: ideal Coulomb friction
    late: delay of the compensator's force in whole samples
    returns: for ideal friction proved if and only if f_D <= f_C. For Dahl friction refuted, for all
        numbers, by a motion that trembles once a sample; unknown where this motion would need more
        than `LONGEST` samples to release the energy that its start takes
    """
    if presliding_stiffness is None:
        return bounded_compensation(coulomb_level=coulomb_level, bound=compensator_level)
    f_c, f_d, stiffness = coulomb_level, compensator_level, compensator_stiffness
    period, presliding, b = sample_time, presliding_stiffness, viscous_damping
    helps, against = Dahl(float(f_d), float(stiffness)), Dahl(float(f_c), float(presliding))
    return refute(
        f"Dahl friction {decimal(f_c)} N, {decimal(presliding)} N/m and damping {decimal(b)} N s/m "
        f"with a Dahl compensator ({decimal(f_d)} N, {decimal(stiffness)} N/m) in a computer, "
        f"every {decimal(period)} s, is passive",
        _find_best(helps, against, float(b), float(period), late),
        lambda motion: (
            f"trembling {motion.path:.3g} m a sample, {motion.power:.3g} W: friction relaxes, and "
            "readings do not show it"
        ),
        f"a motion releases energy, but one of more than {LONGEST:g} samples",
    )


def _find_best(
    helps: Dahl, against: Dahl, damping: float, period: float, late: int
) -> Trembling | None:
    """The trembling motion that releases most power with at most LONGEST samples; None if none."""
    bristle = against.level / against.stiffness
    longest = bristle
    if damping:
        longest = min(longest, period * helps.level**2 / (against.level * damping))
    best = None
    for path in longest * np.geomspace(1e-3, 1.0, 61):
        for drift in np.linspace(0.05, 0.95, 19) * min(helps.level / against.level, 1.0):
            forth, back = path * (1 + drift) / 2, path * (1 - drift) / 2
            one = Trembling(helps, against, damping, period, float(forth), float(back), 1, late)
            gain = one.power * period
            if gain <= 0:
                continue
            # its bristle has to be led over first, and forces of the samples before push back
            lost = 2 * helps.level * (helps.level / helps.stiffness + (1 + late) * (forth - back))
            samples = 2 * math.ceil(lost / gain) + 2
            if samples <= LONGEST and (best is None or gain > best[0]):
                best = gain, replace(one, samples=samples)
    return None if best is None or best[1].energy <= 0 else best[1]


def claims(question: Question) -> list[TopicClaim]:
    """The claim about presliding and a Dahl bristle in a computer, at the estimates, any motion."""
    device, computer = question.device, question.computer
    if device.presliding is None or question.bristle is None:
        return []
    if computer is None or question.late is None:
        return []
    level, stiffness = question.bristle
    if device.bristle_damping.high > 0:
        return []  # no theorem covers it beside a compensator in a computer
    claim = sampled_compensation(
        coulomb_level=device.highest.estimate,
        compensator_level=level,
        compensator_stiffness=stiffness,
        sample_time=computer.period,
        presliding_stiffness=device.presliding.estimate,
        viscous_damping=device.damping.estimate,
        late=question.late,
    )
    return [TopicClaim("any motion, sampled", claim, time="sampled")]
