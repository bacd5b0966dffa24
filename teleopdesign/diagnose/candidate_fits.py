"""Rough fits of all candidates of a ranking, on all cores."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..effects import Effect
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate, make_starts
from .cores import map_on_cores
from .fit import Fit
from .progress import ProgressLine
from .promise import Promises
from .search import Base, estimate_from_starts


def fit_each(
    possible: Sequence[Candidate],
    base: Base,
    prepared: Prepared,
    stated: Model | None,
    *,
    worth: float,
    progress: Callable[[ProgressLine], None] | None,
) -> list[tuple[Candidate, Fit]]:
    """Candidates with their rough fits, in the order of the candidates.

    base: the fitted model to which each is added
    stated: the model as its user gave it; its values are used as starts too
    worth: part of the base's squares on the fit records below which a gain is not pursued
    progress: called before each candidate
    """
    # effects with hidden states take longest, so they begin first
    ordered = sorted(possible, key=lambda c: not c.effect.states)

    def fit_candidate(candidate: Candidate) -> Fit:
        added = base.fit.model.with_effect(candidate.effect, at=candidate.at)
        return estimate_from_starts(added, prepared, base, stated, worth=worth)

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
