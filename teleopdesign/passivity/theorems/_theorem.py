"""A theorem: which questions about a device it answers, and its claims.

A file of this folder states its mathematics as functions of numbers, each with its hypotheses. Its
`THEOREM` says which questions about a device or a diagram the theorem answers. Each file is one
theorem.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from ...by_value import ByValue
from ...controllers import Stage
from ...simulate import Sampling
from ..claims.claim import Claim, Counterexample
from ..identified import IdentifiedDevice
from ..search.by_simulation import SimulatedMotion
from ._hypotheses import hypotheses_of


@dataclass(frozen=True)
class Wall:
    """A virtual wall: K, N/m, and B, N s/m; cancelled: friction that a compensator takes, N."""

    stiffness: float
    damping: float
    cancelled: float = 0.0


@dataclass(frozen=True)
class Question:
    """What passivity is asked of: a device, alone, with a law that cancels friction, or a wall.

    computer: period, delay (whole periods) and encoder of law and wall; None: continuous
    estimates: whether also at the estimates, and not only for all values within the intervals
    """

    device: IdentifiedDevice
    cancellation: Stage | None = None
    wall: Wall | None = None
    computer: Sampling | None = None
    estimates: bool = True

    @property
    def bound(self) -> float | None:
        """The most that the cancellation commands, N; None where no such bound is declared."""
        return self.cancellation.value_of("bound") if self.cancellation else None

    @property
    def bristle_stiffness(self) -> float | None:
        """Of a cancellation that is a Dahl bristle within its bound, N/m; None for all others."""
        return self.cancellation.value_of("bristle_stiffness") if self.cancellation else None

    @property
    def bristle(self) -> tuple[float, float] | None:
        """(level, stiffness) of a cancellation that is a Dahl bristle, N and N/m."""
        level, stiffness = self.bound, self.bristle_stiffness
        return None if level is None or stiffness is None else (level, stiffness)

    @property
    def late(self) -> int | None:
        """Whole samples by which the computer is late; None where its delay is no such number."""
        if self.computer is None:
            return 0
        samples = self.computer.delay / self.computer.period
        # 1e-9: a delay written as a multiple of the period, rounded
        return round(samples) if abs(samples - round(samples)) <= 1e-9 * max(samples, 1) else None


Time = Literal["continuous", "sampled", "any"]


@dataclass(frozen=True, eq=False)
class TopicClaim(ByValue):
    """A claim in its topic; replayed: energy (J) that its motion released in simulation, NaN where
    none was replayed; motion: that simulated motion.
    time: of the controllers in it: "sampled", "continuous", or "any" where it holds in both
    spends_damping: whether its proof uses the device's viscous damping, which no other may then use
    """

    topic: str
    claim: Claim
    replayed: float = float("nan")
    motion: SimulatedMotion | None = None
    spends_damping: bool = False
    time: Time = "continuous"

    @property
    def heading(self) -> str:
        """The status; of what is proved in continuous time alone, with these words."""
        limited = self.claim.status == "proved" and self.time == "continuous"
        return f"{self.claim.heading}{' (in continuous time)' * limited}"


def simulate_nothing(counterexample: Counterexample) -> SimulatedMotion | None:
    """No simulation: the motion of a refutation is replayed by its equations alone."""
    return None


def cover_nothing(question: Question) -> Sequence[str]:
    """No effect beside those of friction."""
    return ()


def ask_nothing(question: Question) -> bool:
    """No question: a theorem on numbers alone."""
    return False


def claim_nothing(question: Question) -> Sequence[TopicClaim]:
    """No claim."""
    return ()


@dataclass(frozen=True)
class Theorem:
    """A theorem, on numbers, and as it is asked about devices and diagrams.

    mathematics: its functions of numbers, each with its hypotheses (`under`): what is claimed comes
        from them, so that nothing is claimed outside of these
    applies: whether it is about the question at all; by default it is about numbers alone
    claims: about friction, walls and computers alone, each in its topic
    order: where it stands among all: continuous time before computers, friction before walls
    covers: effects of the device that it is about, though no claim about friction alone is
    simulate: the motion of its refutations in the compiled simulation, as far as that confirms it
    """

    mathematics: tuple[Callable[..., Claim], ...]
    order: int
    applies: Callable[[Question], bool] = ask_nothing
    claims: Callable[[Question], Sequence[TopicClaim]] = claim_nothing
    covers: Callable[[Question], Sequence[str]] = cover_nothing
    simulate: Callable[[Counterexample], SimulatedMotion | None] = simulate_nothing

    def __post_init__(self) -> None:
        for function in self.mathematics:
            hypotheses_of(function)
