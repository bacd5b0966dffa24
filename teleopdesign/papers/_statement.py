"""A numbered statement of the papers, the kind of its evidence, and the code that gives it."""

from __future__ import annotations

import inspect
import math
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

from ._proof import Correction, NotProved, ProofSteps

How = Literal["proved", "checked numerically", "refuted", "claim of the paper"]
HOW: tuple[How, ...] = ("proved", "checked numerically", "refuted", "claim of the paper")


@dataclass(frozen=True)
class Paper:
    """A paper that makes statements;  short: its name in tables;  full: its reference."""

    short: str
    full: str


BERNSTEIN = Paper(
    "Bernstein 2005",
    "N. L. Bernstein, D. A. Lawrence, L. Y. Pao, Friction modeling and compensation for haptic "
    "interfaces, Proc. World Haptics 2005",
)
MAHVASH = Paper(
    "Mahvash 2006",
    "M. Mahvash, A. M. Okamura, Friction compensation for a force-feedback telerobotic system, "
    "Proc. IEEE ICRA 2006",
)
DERIVED = Paper("derived here", "derived in this project from the models of the two papers")


@dataclass(frozen=True)
class Figure:
    """A computed number and the range in which it must lie (SI unless `unit` says otherwise)."""

    what: str
    value: float
    low: float = -math.inf
    high: float = math.inf
    unit: str = ""

    @property
    def margin(self) -> float:
        """Distance to the nearest end of the range; negative outside of the range."""
        return min(self.value - self.low, self.high - self.value)

    def __str__(self) -> str:
        bound = f"{self.low:.4g} to {self.high:.4g}"
        if math.isinf(self.low):
            bound = f"at most {self.high:.4g}"
        elif math.isinf(self.high):
            bound = f"at least {self.low:.4g}"
        return f"{self.what}: {self.value:.4g} {self.unit}".rstrip() + f", must be {bound}"


def figure_near(what: str, value: float, expected: float, within: float, unit: str = "") -> Figure:
    """A number that may differ from `expected` by at most `within`."""
    return Figure(what, float(value), expected - within, expected + within, unit)


@dataclass(frozen=True)
class Numbers:
    """Computed numbers, each with the range in which it must lie."""

    figures: tuple[Figure, ...]
    outcome: ClassVar[How] = "checked numerically"

    def verify(self) -> tuple[str, ...]:
        """No exact steps."""
        return ()


def numbers_of(*figures: Figure) -> Numbers:
    """These numbers."""
    return Numbers(figures)


StatementEvidence = ProofSteps | Correction | Numbers


#: beginning of a part of a docstring, which reaches to the next part
_PART = re.compile(r"^(formula|printed|assumes): ", re.MULTILINE)


@dataclass(frozen=True)
class Statement:
    """One statement.

    number: 1 to 65, for P1 to P65;  paper, place: source, and equation or section in it
    words: the statement in words;  formula: the form that holds
    printed: text of the paper, if it is wrong, damaged or ambiguous
    assumes: a theorem of others that the proof uses without a proof of it
    how: kind of evidence; `shown_by` must give this kind, and is None for a claim of the paper
    numbers: a computation beside a proof, for numbers in the statement
    see: statements that bear on a claim
    """

    number: int
    paper: Paper
    place: str
    words: str
    how: How
    shown_by: Callable[[], StatementEvidence] | None
    formula: str = ""
    printed: str = ""
    assumes: str = ""
    numbers: Callable[[], Numbers] | None = None
    see: tuple[int, ...] = ()

    @property
    def name(self) -> str:
        """ "P16"."""
        return f"P{self.number}"

    @property
    def code(self) -> str:
        """File and function that show the statement; "" for a claim."""
        if self.shown_by is None:
            return ""
        return f"{self.shown_by.__module__.rpartition('.')[2]}.{self.shown_by.__name__}"


@dataclass(frozen=True)
class Result:
    """The result of a check of a statement.

    outcome: kind of evidence that was obtained; "failed": a step or a number does not hold
    details: one line for each exact step, or why it failed;  figures: computed numbers
    """

    statement: Statement
    outcome: How | Literal["failed"]
    details: tuple[str, ...]
    figures: tuple[Figure, ...]
    seconds: float

    @property
    def as_stated(self) -> bool:
        """Whether the outcome is the kind of evidence that the statement names."""
        return self.outcome == self.statement.how


def shows(
    number: int,
    paper: Paper,
    place: str,
    *,
    how: How = "proved",
    numbers: Callable[[], Numbers] | None = None,
) -> Callable[[Callable[[], StatementEvidence]], Statement]:
    """A decorator: the function shows the statement in its docstring.

    The docstring has the words, and then `formula`, `printed` and `assumes`.
    """

    def made(function: Callable[[], StatementEvidence]) -> Statement:
        texts = _PART.split(inspect.getdoc(function) or "")
        words, *parts = (" ".join(map(str.strip, text.strip().splitlines())) for text in texts)
        named = dict(zip(parts[::2], parts[1::2], strict=True))
        more = named.get("formula", ""), named.get("printed", ""), named.get("assumes", "")
        return Statement(number, paper, place, words, how, function, *more, numbers)

    return made


def claim(number: int, paper: Paper, place: str, words: str, see: tuple[int, ...]) -> Statement:
    """A statement that only the experiment or the text of the paper can support."""
    return Statement(number, paper, place, words, "claim of the paper", None, see=see)


def check(statement: Statement) -> Result:
    """Run the code that shows the statement; its evidence determines the outcome."""
    start = time.perf_counter()
    outcome: How | Literal["failed"] = "claim of the paper"
    details: tuple[str, ...] = ()
    figures: tuple[Figure, ...] = ()
    try:
        for show in (statement.shown_by, statement.numbers):
            if show is not None:
                evidence = show()
                details += evidence.verify()
                figures += getattr(evidence, "figures", ())
                outcome = evidence.outcome if show is statement.shown_by else outcome
    except NotProved as error:
        outcome, details = "failed", (str(error),)
    if any(not f.margin >= 0 for f in figures):
        outcome = "failed"
    return Result(statement, outcome, details, figures, time.perf_counter() - start)
