"""Rough fits of all candidates of a ranking, on all cores, and how many of them have begun."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..effects import Effect
from ..measurement.prepare import Prepared
from .candidates import Candidate, make_starts
from .cores import map_on_cores
from .fit import Fit
from .promise import Promises
from .search import Base, estimate_from_starts


class ProgressLine(str):
    """A line of text with a count, such as "step 2: stribeck at device (14 of 38)".

    stage: the stage that the line belongs to, such as "step 2"; "": none
    begun, total: parts of this stage: those that have started, and all
    """

    stage: str
    begun: int
    total: int

    def __new__(cls, text: str, *, begun: int, total: int, stage: str = "") -> ProgressLine:
        head = f"{stage}: " if stage else ""
        line = super().__new__(cls, f"{head}{text} ({begun} of {total})")
        line._text, line.stage, line.begun, line.total = text, stage, begun, total
        return line

    _text: str

    def within(self, stage: str) -> ProgressLine:
        """The same line as part of a stage."""
        return ProgressLine(self._text, begun=self.begun, total=self.total, stage=stage)


def fit_each(
    possible: Sequence[Candidate],
    base: Base,
    prepared: Prepared,
    *,
    worth: float,
    progress: Callable[[ProgressLine], None] | None,
) -> list[tuple[Candidate, Fit]]:
    """Candidates with their rough fits, in the order of the candidates.

    base: the fitted model to which each is added
    worth: part of the base's squares on the fit records below which a gain is not pursued
    progress: called before each candidate
    """
    # effects with hidden states take longest, so they begin first
    ordered = sorted(possible, key=lambda c: not c.effect.states)

    def fit_candidate(candidate: Candidate) -> Fit:
        added = base.fit.model.with_effect(candidate.effect, at=candidate.at)
        return estimate_from_starts(added, prepared, base, worth=worth)

    def begun(i: int) -> None:
        if progress is not None:
            progress(ProgressLine(str(ordered[i]), begun=i + 1, total=len(ordered)))

    def derive_laws() -> None:
        for candidate in ordered:
            _derive_law(candidate, base, prepared.coarse)

    fits = map_on_cores(fit_candidate, ordered, begun=begun, before=derive_laws)
    return sorted(zip(ordered, fits, strict=True), key=lambda cf: possible.index(cf[0]))


def _derive_law(candidate: Candidate, base: Base, prepared: Prepared) -> None:
    """Derive and compile the law of a candidate, once in this process, by using it."""
    if candidate.effect not in _with_laws:
        _with_laws.add(candidate.effect)
        added = base.coarse.model.with_effect(candidate.effect, at=candidate.at)
        Promises(prepared, base.coarse).squares(make_starts(added, prepared.scales)[0])


_with_laws: set[Effect] = set()
