"""Rank candidate effects: each is added, and all parameters are re-estimated.

Candidates that count come first, in the order of their errors on the check records.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial

from ..base.errors import ModelError
from ..effects import Effect
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate, bodies_with_measured_force, candidates, make_starts
from .cores import map_on_cores, one_thread_of_algebra
from .criteria import CRITERIA
from .decision import find_superfluous_effect, lowers_check_squares, rank_key, refusal
from .draws import explain_records, search_among_draws
from .evidence import check_score, check_squares, whole_score
from .fit import Fit, estimate, fit_squares
from .identifiability import explain_open_width, is_identifiable
from .linear_start import Promises
from .plausibility import implausible_effects
from .ranking import Ranked, Ranking
from .search import Base, base_of, estimate_from_starts, keep_absent
from .search_plan import PLAN


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


def _fit_each(
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
    made: list[tuple[Candidate, Fit]] = []
    linear = [c for c in possible if c.effect.strength is not None]
    # effects with hidden states take longest, so they begin first
    others = sorted((c for c in possible if c not in linear), key=lambda c: not c.effect.states)

    def fit_all(wanted: Sequence[Candidate], base: Base) -> None:
        def fit_candidate(candidate: Candidate) -> Fit:
            added = base.fit.model.with_effect(candidate.effect, at=candidate.at)
            return estimate_from_starts(added, prepared, base, worth=worth)

        def begun(i: int) -> None:
            if progress is not None:
                line, number = str(wanted[i]), len(made) + i + 1
                progress(ProgressLine(line, begun=number, total=len(possible)))

        before = partial(_derive_laws, wanted, base, prepared.coarse)
        fits = map_on_cores(fit_candidate, wanted, begun=begun, before=before)
        made.extend(zip(wanted, fits, strict=True))

    fit_all(linear, base)
    # the lack of one that explains the records is what led the base away from the user's values
    fit_all(others, replace(base, stated=None) if explain_records(made, base) else base)
    return sorted(made, key=lambda cf: possible.index(cf[0]))


def _derive_laws(possible: Sequence[Candidate], base: Base, prepared: Prepared) -> None:
    """Derive and compile the laws of candidates, once in this process, by using them."""
    promises = Promises(prepared, base.coarse)
    for candidate in possible:
        if candidate.effect not in _with_laws:
            _with_laws.add(candidate.effect)
            added = base.coarse.model.with_effect(candidate.effect, at=candidate.at)
            promises.squares(make_starts(added, prepared.scales)[0])


_with_laws: set[Effect] = set()


def _absent_if_it_runs_away(attempt: tuple[Candidate, Fit], base: Fit) -> tuple[Candidate, Fit]:
    """The fit, or that of the absent effect where no error is a number: a hidden body runs away."""
    candidate, fit = attempt
    if math.isfinite(fit.fit_error) and math.isfinite(fit.check_error):
        return attempt
    return candidate, keep_absent(base.model.with_effect(candidate.effect, at=candidate.at), base)


def _refine_candidate(
    attempt: tuple[Candidate, Fit], worthless: float, prepared: Prepared
) -> tuple[Candidate, Fit]:
    """A fine fit for a candidate that is present and leaves at most `worthless` squares."""
    candidate, rough = attempt
    if (candidate.effect.name, candidate.at) in rough.model.absent:
        return attempt
    if fit_squares(rough) > worthless:
        return candidate, rough
    return candidate, estimate(rough.model, prepared)


def _contenders_refined(
    attempts: list[tuple[Candidate, Fit]],
    base: Fit,
    worthless: float,
    prepared: Prepared,
) -> list[tuple[Candidate, Fit]]:
    """The attempts, with fine fits of the best ones."""
    most = (1.0 + PLAN.contending) * _least_squares_that_count(attempts, base, prepared)
    chosen = [i for i, (_, fit) in enumerate(attempts) if fit_squares(fit) <= most]
    finer = map_on_cores(lambda i: _refine_candidate(attempts[i], worthless, prepared), chosen)
    made = dict(zip(chosen, finer, strict=True))
    return [made.get(i, attempt) for i, attempt in enumerate(attempts)]


def _least_squares_that_count(
    attempts: Collection[tuple[Candidate, Fit]], base: Fit, prepared: Prepared
) -> float:
    """Least squares of an attempt that counts; of all attempts where none counts.

    An attempt does not count if it is refused, not identifiable or implausible, or leaves more on
    the check records.
    """
    for candidate, fit in sorted(attempts, key=lambda attempt: fit_squares(attempt[1])):
        if (
            not refusal(base, fit)
            and is_identifiable(fit, base)
            and check_squares(fit) < check_squares(base)
            and not _implausible(base, candidate, fit, prepared)
            and not explain_open_width(fit, candidate, prepared)
        ):
            return fit_squares(fit)
    return min((fit_squares(f) for _, f in attempts), default=0.0)


@one_thread_of_algebra()
def rank_candidates(
    base: Fit,
    prepared: Prepared,
    *,
    among: Collection[Candidate] | None = None,
    body: str | None = None,
    stated: Model | None = None,
    worth: float | None = None,
    widely: bool = False,
    progress: Callable[[ProgressLine], None] | None = None,
) -> Ranking:
    """Add every candidate in turn to a fitted model, and rank the fits.

    base: the fitted model that may lack an effect
    among: the candidates to rank; None: all that the model could take
    body: the body whose candidates are ranked; None: all bodies
    stated: the model as its user gave it; its values are used as starts too
    worth: part of the base's squares on the fit records below which a gain is not pursued; None:
        that of the criteria
    widely: where no candidate explains the records, draw further starts of gaps
    progress: called before each candidate
    """
    worth = CRITERIA.worth if worth is None else worth
    possible = candidates(
        base.model,
        [s.motion for s in prepared.stretches],
        separate_zeros={s.motion.file for s in prepared.stretches if s.has_zero_offset},
        measured=bodies_with_measured_force(prepared.experiment),
    )
    wanted = {c.key for c in (possible if among is None else among)}
    here = {body} if body is not None else set(base.model.bodies)
    possible = tuple(c for c in possible if c.key in wanted and base.model.holder(c.at) in here)
    start = base_of(base, prepared, stated)
    fits = _fit_each(possible, start, prepared, worth=worth, progress=progress)
    if widely:
        fits = search_among_draws(fits, start, prepared)
    fits = [_absent_if_it_runs_away(cf, base) for cf in fits]
    worthless = (1.0 - worth) * fit_squares(base)
    fits = _contenders_refined(fits, base, worthless, prepared)
    fits = [_absent_if_it_runs_away(cf, base) for cf in fits]
    results = sorted((_ranked_best(base, cf, prepared) for cf in fits), key=rank_key)
    entries = [
        replace(r, behind=whole_score(r.fit, results[0].fit) if i else 0.0)
        for i, r in enumerate(results)
    ]
    return Ranking(base, tuple(entries))


def make_ranked(
    base: Fit,
    candidate: Candidate,
    fit: Fit,
    *,
    prepared: Prepared,
    instead_of: Candidate | None = None,
    has_open_width: bool = True,
) -> Ranked:
    """A candidate that was added to a base, as the first of a ranking.

    instead_of: effect of the base that the fitted model lacks
    has_open_width: whether it may have a parameter whose value stays open; asked if the gain is
        large enough
    """
    implausible = _implausible(base, candidate, fit, prepared)
    gains = lowers_check_squares(base, fit)
    if has_open_width and gains and not implausible:
        implausible = explain_open_width(fit, candidate, prepared)
    return Ranked(
        candidate=candidate,
        fit=fit,
        score=check_score(base, fit),
        behind=0.0,
        is_identifiable=is_identifiable(fit, base),
        refused=refusal(base, fit),
        implausible=implausible,
        instead_of=instead_of,
    )


def _implausible(base: Fit, candidate: Candidate, fit: Fit, prepared: Prepared) -> str:
    """Why the candidate, or an effect of the base beside it, is implausible; "": neither is.

    Effects that were implausible in the base do not count against the candidate.
    """
    stands_for = implausible_effects(fit.model, prepared)
    if candidate.key in stands_for:
        return stands_for[candidate.key]
    before = implausible_effects(base.model, prepared) if stands_for else {}
    new = (key for key in stands_for if key not in before)
    return next((f"with it, {key[0]} is implausible: {stands_for[key]}" for key in new), "")


def _ranked_best(base: Fit, fitted: tuple[Candidate, Fit], prepared: Prepared) -> Ranked:
    """The candidate added to the base, or in place of an effect that it makes superfluous."""
    candidate, fit = fitted
    beside = make_ranked(base, candidate, fit, prepared=prepared)
    gains = lowers_check_squares(base, fit)
    if candidate.key in fit.model.absent or beside.refused or not gains:
        return beside
    superfluous = find_superfluous_effect(base, fit, candidate)
    if superfluous is None:
        return beside
    name, at = superfluous.key
    try:
        less = fit.model.without_effect(name, at=at)
    except ModelError:  # another effect needs it
        return beside
    alone = estimate(less, prepared)
    if check_squares(alone) > (1.0 + CRITERIA.relative_improvement) * check_squares(fit):
        return beside
    return make_ranked(base, candidate, alone, prepared=prepared, instead_of=superfluous)
