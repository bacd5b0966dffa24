"""A claim and its verdict: proved, refuted, evidence, or unknown.

A proof is exact and has a certificate, which `checker` verifies without the package. A refutation
is a motion that releases energy; the motion is stored, so anyone can replay it. Evidence states
what was computed or searched, and the margin. Evidence is never called a proof.

Theorems write claims for a prismatic axis. The numbers are the same on a revolute axis, and
`use_units_of` changes the units: 0.5 N becomes 0.5 N m.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from ...base.errors import ModelError
from ...base.frozen import ByValue
from ...base.shown import Shown
from ...base.units import unit_of
from .certificate import Certificate


class NotTrueOrFalse:
    """A result with four statuses: `if claim:` is refused, it would pass if refuted, too."""

    def __bool__(self) -> bool:
        raise ModelError(
            f"{type(self).__name__}: a claim is proved, refuted, evidence or unknown, neither true "
            "nor false: ask for its status, or whether it holds (.status, .holds)"
        )


class Counterexample(Protocol):
    """A motion that releases energy."""

    @property
    def energy(self) -> float:
        """Energy released, J, > 0."""
        ...

    def replay(self) -> float:
        """The released energy, J, computed anew along the motion."""
        ...

    def as_dict(self) -> dict[str, object]:
        """Plain data, to be written as JSON."""
        ...


@dataclass(frozen=True, eq=False)
class Proof(ByValue):
    """A verdict: the claim is proved, exactly.

    method: in words;  certificates: of the proof, each verified by `checker`
    margin: distance of the statement from failing, in `unit`; NaN where no margin was computed
    equality: where the inequality holds with equality; "" where nowhere, or not computed
    """

    method: str
    certificates: tuple[Certificate, ...]
    margin: float = float("nan")
    unit: str = ""
    equality: str = ""

    status = "proved"
    holds = True

    def __str__(self) -> str:
        number = len(self.certificates)
        lines = [f"by {self.method}; {number} certificate{'s' * (number > 1)}"]
        if not math.isnan(self.margin):
            lines.append(f"margin {self.margin:.4g} {self.unit}".rstrip())
        if self.equality:
            lines.append(f"with equality {self.equality}")
        return "; ".join(lines)


@dataclass(frozen=True, eq=False)
class Refutation(ByValue):
    """A verdict: the claim is refuted by a motion that releases energy.

    method: in words;  record: the motion, which releases `record.energy` > 0 J
    replayed: energy that `record.replay()` released, J; a claim is refuted only if it is > 0
    """

    method: str
    record: Counterexample
    replayed: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "replayed", float(self.record.replay()))

    status = "refuted"
    holds = False

    def __str__(self) -> str:
        return f"{self.method}: releases {self.record.energy:.4g} J"


@dataclass(frozen=True, eq=False)
class Evidence(ByValue):
    """A verdict: numbers speak for or against the claim, without a proof.

    holds: whether the numbers speak for the claim
    searched: what was computed, and over which range
    margin: distance of the statement from failing, in `unit`; negative where it fails
    """

    holds: bool
    searched: str
    margin: float
    unit: str = ""

    status = "evidence"

    def __str__(self) -> str:
        side = "in favour" if self.holds else "against"
        margin = "" if math.isnan(self.margin) else f"; margin {self.margin:.4g} {self.unit}"
        return f"{side}: {self.searched}{margin}".rstrip()


@dataclass(frozen=True)
class Unknown:
    """A verdict: the claim is neither proved nor refuted; `why` says what stands in the way."""

    why: str

    status = "unknown"
    holds = None

    def __str__(self) -> str:
        return self.why


Verdict = Proof | Refutation | Evidence | Unknown


@dataclass(frozen=True, eq=False)
class Claim(Shown, NotTrueOrFalse, ByValue):
    """A statement about passivity at a port, with its proof, refutation or evidence."""

    statement: str
    verdict: Verdict

    @property
    def heading(self) -> str:
        """Status in words; "evidence against" where evidence speaks against the statement."""
        is_against = self.status == "evidence" and not self.holds
        return "evidence against" if is_against else self.status

    def __post_init__(self) -> None:
        verdict = self.verdict
        if isinstance(verdict, Refutation) and not (verdict.replayed > 0 < verdict.record.energy):
            why = (
                f"{verdict.method}: a motion that should release {verdict.record.energy:.4g} J "
                f"releases {verdict.replayed:.4g} J in its replay: no refutation"
            )
            object.__setattr__(self, "verdict", Unknown(why))

    @property
    def status(self) -> str:
        """Status: "proved", "refuted", "evidence" or "unknown"."""
        return self.verdict.status

    @property
    def holds(self) -> bool | None:
        """Whether the statement holds, as the verdict says; None where this is unknown."""
        return self.verdict.holds

    @property
    def certificates(self) -> tuple[Certificate, ...]:
        """The certificates of a proved claim; none otherwise."""
        return self.verdict.certificates if isinstance(self.verdict, Proof) else ()

    @property
    def record(self) -> Counterexample:
        """The motion that refutes the claim; ModelError where there is none."""
        if not isinstance(self.verdict, Refutation):
            raise ModelError(f"claim: {self.status}, so no motion refutes it: {self.statement}")
        return self.verdict.record


@dataclass(frozen=True, eq=False)
class Region(Shown, ByValue):
    """Status of a claim at each point of a grid of two parameters.

    x, y: values of the parameters, (n,) and (m,)
    status: "proved", "refuted", "evidence" or "unknown", (m, n)
    holds: 1 where the claim holds, 0 where not, NaN where unknown, (m, n)
    """

    x: np.ndarray
    y: np.ndarray
    status: np.ndarray
    holds: np.ndarray


def region(claim: Callable[[float, float], Claim], x: np.ndarray, y: np.ndarray) -> Region:
    """Judge claim(x, y) at every point of a grid, each point alone.

    Between the points nothing is known.

    claim: a function of two numbers that returns a `Claim`
    x, y: values of the parameters, (n,) and (m,)
    """
    claims = [[claim(float(a), float(b)) for a in x] for b in y]
    status = np.array([[c.status for c in row] for row in claims])
    holds = np.array(
        [[np.nan if c.holds is None else float(c.holds) for c in row] for row in claims]
    )
    return Region(np.asarray(x, dtype=float), np.asarray(y, dtype=float), status, holds)


_QUANTITIES = ("damping", "stiffness", "force", "velocity", "inertia", "position")
#: unit on a prismatic axis -> unit on a revolute axis, as claims write them
_ROTARY = {
    unit_of(q, "prismatic").replace("*", " "): unit_of(q, "revolute").replace("*", " ")
    for q in _QUANTITIES
}
_UNIT = "|".join(sorted(map(re.escape, _ROTARY), key=len, reverse=True))
#: a unit that follows a number and is not a part of a longer unit
_MEASURE = re.compile(rf"(?<=\d )({_UNIT})(?![\w/^*]| m\b| s/)")


def use_units_of(axis: str, claim: Claim) -> Claim:
    """The claim with its statement and verdict in the units of an axis.

    axis: "prismatic" or "revolute"
    """
    if axis != "revolute":
        return claim
    verdict: Any = claim.verdict
    texts = (n for n in ("method", "searched", "why") if hasattr(verdict, n))
    changed = {name: use_rotary_units(getattr(verdict, name)) for name in texts}
    if isinstance(verdict, Proof | Evidence):
        first, _, rest = verdict.unit.partition(" of ")
        unit = _ROTARY.get(first, first)
        changed["unit"] = f"{unit} of {rest}" if rest else unit
    return Claim(use_rotary_units(claim.statement), replace(verdict, **changed))


def use_rotary_units(text: str) -> str:
    """The text with the units after numbers changed to those of a revolute axis."""
    return _MEASURE.sub(lambda match: _ROTARY[match.group(1)], text)
