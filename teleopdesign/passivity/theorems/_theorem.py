"""A question about a device, the claims that answer it, and how a theorem makes a claim."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

import sympy as sp

from ...base.errors import ModelError
from ...base.frozen import ByValue
from ...blocks import Body, Value
from ...controllers import Stage, controller, laws_that_declare
from ...diagrams import Diagram, haptic_interface
from ...effects import EFFECTS
from ...simulate import Sampling
from ..claims.claim import Claim, Counterexample, Proof, Refutation, Unknown
from ..identified import IdentifiedDevice
from ..law_facts import ANY_TIME, LawFacts, law_facts
from ..rate_independent import Coulomb, Cycle, Dahl
from ..search.by_simulation import SimulatedMotion, confirmed_motion, search_counterexample
from ..search.growing_wave import wave_of
from ..search.stroke_motion import Strokes

Time = Literal["continuous", "sampled", "any"]


@dataclass(frozen=True)
class Wall:
    """A virtual wall.

    stiffness: K, N/m;  damping: B, N s/m;  cancelled: friction that a compensator cancels, N
    """

    stiffness: float
    damping: float
    cancelled: float = 0.0


@dataclass(frozen=True)
class Question:
    """A question about passivity: of a device alone, with a law that cancels friction, or a wall.

    device: bounds of its friction;  cancellation: the law;  wall: the virtual wall
    computer: period, delay (whole periods) and encoder of law and wall; None: continuous time
    estimates: whether to ask at the estimates, too, or only for all values within the intervals
    """

    device: IdentifiedDevice
    cancellation: Stage | None = None
    wall: Wall | None = None
    computer: Sampling | None = None
    estimates: bool = True

    @property
    def law(self) -> LawFacts:
        """What follows from the equations of the cancellation, in the time of the question."""
        if self.cancellation is None:
            return LawFacts()
        period = self.computer.period if self.computer else 0.0
        return law_facts(self.cancellation, (period, period))

    @property
    def time_of_bound(self) -> Time:
        """In which time the bound of the cancellation holds: "any", or that of the question."""
        if self.cancellation is None or law_facts(self.cancellation, ANY_TIME).bound is not None:
            return "any"
        return "sampled" if self.computer else "continuous"

    @property
    def bristle(self) -> tuple[float, float] | None:
        """(level, stiffness) of a cancellation that is a Dahl bristle, N and N/m; else None."""
        level, stiffness = self.law.bound, self.law.bristle_stiffness
        return None if level is None or stiffness is None else (level, stiffness)

    @property
    def lengths(self) -> list[float]:
        """Travels over which friction, and the cancelling force, build up, m or rad."""
        lengths = []
        if self.device.presliding is not None:
            lengths.append(self.device.lowest.estimate / self.device.presliding.estimate)
        if self.bristle is not None:
            lengths.append(self.bristle[0] / self.bristle[1])
        return lengths

    @property
    def late(self) -> int | None:
        """Delay of the computer in whole samples; None where it is not a whole number of samples.

        0 in continuous time.
        """
        if self.computer is None:
            return 0
        samples = self.computer.delay / self.computer.period
        # 1e-9: a delay written as a multiple of the period, rounded
        return round(samples) if abs(samples - round(samples)) <= 1e-9 * max(samples, 1) else None


@dataclass(frozen=True, eq=False)
class TopicClaim(ByValue):
    """A claim with its topic.

    replayed: energy that the motion of a refutation released in simulation, J; NaN: not replayed
    motion: the simulated motion
    spends_damping: whether the proof uses the viscous damping of the device; no second proof of the
        same sum of parts may then use it
    time: of the controllers: "sampled", "continuous", or "any" where the claim holds for both
    of_any_law: whether it is about any law within a bound: another law than that of the question
        may then be the one that refutes it
    covers: names of further effects of the device that its theorem covers
    """

    topic: str
    claim: Claim
    replayed: float = float("nan")
    motion: SimulatedMotion | None = None
    spends_damping: bool = False
    time: Time = "continuous"
    of_any_law: bool = False
    covers: Sequence[str] = ()

    @property
    def refutes(self) -> bool:
        """Whether what refutes the claim is the law of its question."""
        return self.claim.status == "refuted" and not self.of_any_law

    @classmethod
    def from_search(
        cls, topic: str, statement: str, diagram: Diagram, **settings: Any
    ) -> TopicClaim:
        """A claim that `search_counterexample` decides, whose motion is replayed in simulation.

        statement: of the claim where the simulation does not take the diagram
        """
        try:
            claim = search_counterexample(diagram, **settings)
        except ModelError as problem:
            claim = Claim(statement, Unknown(str(problem)))
        verdict = claim.verdict
        if isinstance(verdict, Refutation) and isinstance(verdict.record, SimulatedMotion):
            return cls(topic, claim, verdict.replayed, verdict.record)
        return cls(topic, claim)

    @property
    def heading(self) -> str:
        """Status of the claim in words; a proof for continuous time alone says so."""
        limited = self.claim.status == "proved" and self.time == "continuous"
        return f"{self.claim.heading}{' (in continuous time)' * limited}"


def decide(
    statement: str,
    holds: bool,
    *,
    proof: Callable[[], Proof],
    motion: Callable[[], Any],
    how: str | Callable[[Any], str],
    why_open: str = "",
) -> Claim:
    """The claim of a theorem: proved where its condition holds, else as `refute` says."""
    return Claim(statement, proof()) if holds else refute(statement, motion(), how, why_open)


def refute(
    statement: str, record: Any, how: str | Callable[[Any], str], why_open: str = ""
) -> Claim:
    """A claim that a motion refutes, or that is unknown.

    record: a motion that releases energy, or None where the search has none
    how: of the refutation, in words;  why_open: what an unknown claim says
    """
    if record is None:
        return Claim(statement, Unknown(why_open))
    return Claim(statement, Refutation(how if isinstance(how, str) else how(record), record))


def refute_by_wave(
    statement: str, z: sp.Expr, points: Iterable[tuple[Fraction, Fraction]]
) -> Claim:
    """A claim about an impedance (N s/m) that a growing wave refutes, or that is unknown.

    points: rate (1/s) and frequency (rad/s), at which a wave is searched in turn
    """
    matrix = sp.ImmutableMatrix([[z]])
    waves = (wave_of(matrix, rate, frequency) for rate, frequency in points)
    wave = next((wave for wave in waves if wave is not None), None)
    how = wave and f"a growing wave at {float(wave.frequency) / (2 * math.pi):.4g} Hz"
    return refute(statement, wave, how or "", "the condition fails, but no wave was found")


def simulate_cycle(cycle: Counterexample) -> SimulatedMotion | None:
    """Simulate a refuting cycle of one friction element with a Dahl compensator.

    returns: the confirmed motion. None where the simulation does not confirm a release of energy
        (as close to a limit), would take too long, or where the counterexample is no cycle of one
        element
    """
    if not isinstance(cycle, Cycle) or len(cycle.friction) != 1:
        return None
    friction, helps = cycle.friction[0], cycle.compensator
    if not isinstance(friction, Coulomb | Dahl):
        return None
    body = Body("prismatic", {"inertia": Value(1e-3)})
    body = body.with_effect(EFFECTS["coulomb"], {"level": friction.level})
    lengths = [helps.level / helps.stiffness]
    if isinstance(friction, Dahl):
        presliding = EFFECTS["presliding"].without("bristle_damping")
        body = body.with_effect(presliding, {"stiffness": friction.stiffness})
        lengths.append(friction.level / friction.stiffness)
    bristle = laws_that_declare("bristle_stiffness")[0]
    values = {bristle.bound: helps.level, bristle.bristle_stiffness: helps.stiffness}
    law = controller(bristle.name, values)
    # friction does not depend on speed: a stroke takes about 10 ms
    strokes = Strokes(cycle.turning_points, speed=300 * max(map(abs, cycle.turning_points)))
    deflection = min(*lengths, *map(abs, cycle.turning_points)) / 1000
    try:
        return confirmed_motion(haptic_interface(body, cancellation=law), strokes, give=deflection)
    except ModelError:  # lengths so far apart that a simulation of it would take too many steps
        return None
