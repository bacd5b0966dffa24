"""Rank candidate effects: each is added, everything is re-estimated, the check records decide."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np

from ..by_value import ByValue
from ..model import Model
from ..notebook import html_table
from .candidates import Candidate, candidates
from .evidence import gain_score
from .fit import ROUGH, Fit, estimate, fit_squares
from .force_error import Prepared
from .search import WORTH, at_stated, estimate_from_starts
from .threads import in_threads


@dataclass(frozen=True, eq=False, repr=False)
class Ranked(ByValue):
    """A candidate with the model fitted with it.

    score: how surely it lowers the error on the check records (standard deviations)
    behind: how surely the best candidate has the smaller error on all records; 0 for the best
    told: its parameters are determined, and told from those of the model it was added to
    refused: why it does not count though it may leave less force (a key of `REFUSALS`), or ""
    """

    candidate: Candidate
    fit: Fit
    score: float
    behind: float
    told: bool
    refused: str = ""

    @property
    def counts(self) -> bool:
        """Whether the records can speak for it: told, and not refused."""
        return self.told and not self.refused

    @property
    def note(self) -> str:
        """What is to be said beside the numbers; "" where nothing is."""
        if self.candidate.key in self.fit.model.absent:
            return "gains nothing"
        return REFUSALS.get(self.refused, "" if self.told else "not determined")

    def __repr__(self) -> str:
        return f"Ranked {self.candidate}: score {self.score:.1f}, behind {self.behind:.1f}"


@dataclass(frozen=True, eq=False)
class Ranking(ByValue):
    """Candidates, best first, and the fit that they are compared with."""

    base: Fit
    ranked: tuple[Ranked, ...]

    @property
    def best(self) -> Ranked:
        """The candidate with the smallest error."""
        return self.ranked[0]

    def _repr_html_(self) -> str:
        base = (f"{self.base.fit_error:.4f}", f"{self.base.check_error:.4f}")
        rows: list[tuple[str, ...]] = [("(the model)", *base, "", "", "")]
        for r in self.ranked:
            errors = (f"{r.fit.fit_error:.4f}", f"{r.fit.check_error:.4f}")
            rows.append((str(r.candidate), *errors, f"{r.score:.1f}", f"{r.behind:.1f}", r.note))
        head = ("candidate", "fit error", "check error", "score", "behind", "")
        return html_table("Candidates, best first", head, rows)

    def __repr__(self) -> str:
        lines = [f"{'candidate':<40}{'fit error':>10}{'check error':>13}{'score':>8}{'behind':>8}"]
        lines.append(
            f"{'(the model)':<40}{self.base.fit_error:>10.4f}{self.base.check_error:>13.4f}"
        )
        for r in self.ranked:
            note = f"  {r.note}" if r.note else ""
            lines.append(
                f"{r.candidate!s:<40}{r.fit.fit_error:>10.4f}{r.fit.check_error:>13.4f}{r.score:>8.1f}{r.behind:>8.1f}{note}"
            )
        return "\n".join(lines)


def check_squares(found: Fit) -> float:
    """Sum of squares on the check records, relative to the force that acts by the model."""
    return float(found.check_residual @ found.check_residual)


def check_score(before: Fit, after: Fit) -> float:
    """How surely `after` has the smaller error on the check records."""
    return gain_score(before.check_residual, after.check_residual, after.check_blocks)


def seen_score(before: Fit, after: Fit) -> float:
    """How surely `after` has the smaller error on the check records, seen at the command.

    On the rows that both can tell: what a model is blind to speaks for neither.
    """
    rows = before.seen.told & after.seen.told
    return gain_score(
        before.seen.residual[rows], after.seen.residual[rows], after.check_blocks[rows]
    )


def seen_gain(before: Fit, after: Fit) -> float:
    """Part of the squares seen at the command that `after` takes away, on rows that both tell.

    No more than the error itself says of each model on its own rows: to be blind to where most is
    left is no gain.
    """
    rows = before.seen.told & after.seen.told
    whole, left = (float(np.sum(f.seen.residual[rows] ** 2)) for f in (before, after))
    own = 1.0 - (after.seen.error / before.seen.error) ** 2
    return min(own, 1.0 - left / whole) if whole > 0.0 else 0.0


#: share of the samples where the body slides that may be blind: of more, a model says too little
BLIND = 0.25
#: part of the squares before from which a gain counts: less is no answer to where a model fails
RELEVANT = 0.03
#: reasons for which an effect does not count, in words
REFUSALS = {
    "blind": "the command has no influence in more than a quarter of the motion",
    "weak": "the actuator could not give what the model needs to slide",
    "hides": "explains no more of the command: less force acts, and so less is left",
}


def refusal(base: Fit, other: Fit) -> str:
    """Why what was added to `base` does not count (a key of `REFUSALS`); "" where nothing bars it.

    What makes the recorded force unpredictable has not explained it.
    """
    already = base.seen.blind if base.seen.blind > BLIND else 0.0
    if other.seen.blind - already > BLIND:
        return "blind"
    if other.seen.weak and not base.seen.weak:
        return "weak"
    less = check_squares(other) < (1.0 - RELEVANT) * check_squares(base)
    return "hides" if less and not seen_gain(base, other) > RELEVANT else ""


def whole_score(before: Fit, after: Fit) -> float:
    """How surely `after` has the smaller error on all records together."""
    shift = int(after.fit_blocks.max()) + 1
    return gain_score(
        np.concatenate([before.fit_residual, before.check_residual]),
        np.concatenate([after.fit_residual, after.check_residual]),
        np.concatenate([after.fit_blocks, after.check_blocks + shift]),
    )


#: part of a new parameter's column that must lie outside the span of the model's own
TOLD = 0.02
#: standard errors by which a parameter that makes an effect what it is must differ from zero
SURELY = 5.0


def is_told(found: Fit, base: Fit) -> bool:
    """Whether the new parameters are determined and do what the base's cannot imitate.

    Each must be further from absence than its standard error (an angle within half a turn) unless
    the effect is there without it, what is essential to it surely so, and some must change the
    residual in a way of its own.
    """
    new = [i for i, n in enumerate(found.free) if n not in base.free]
    for i in new:
        name = found.free[i]
        value, declared = found.model.parameters[name], found.model.declared(name)
        if declared.optional:
            continue
        away = np.pi if declared.quantity == "angle" else found.model.from_absence(name)
        if not value.stderr * (SURELY if declared.search.essential else 1.0) < away:
            return False
    old = [i for i, n in enumerate(found.free) if n in base.free]
    for i in new:
        column = found.jacobian[:, i]
        size = float(np.linalg.norm(column))
        if size == 0.0:
            continue
        if not old:
            return True
        own = found.jacobian[:, old]
        rest = column - own @ np.linalg.lstsq(own, column, rcond=1e-10)[0]
        if float(np.linalg.norm(rest)) > TOLD * size:
            return True
    return False


def _is_part_of(small: Candidate, large: Candidate) -> bool:
    """Whether one effect has the parameters of another, at the same place, and more."""
    ours, theirs = ({n: p.quantity for n, p in c.effect.parameters.items()} for c in (small, large))
    alike = small.at == large.at and small.effect.role == large.effect.role
    return alike and ours.items() < theirs.items()


def _from_kin(
    tried: tuple[Candidate, Fit], all_tried: Collection[tuple[Candidate, Fit]], prepared: Prepared
) -> tuple[Candidate, Fit]:
    """Started anew where an effect that it is a part of has come to lie lower.

    The larger one may find a way round: a gap that closes leads to the compliance behind it.
    """
    candidate, rough = tried
    kin = [(c, f) for c, f in all_tried if _is_part_of(candidate, c)]
    larger, found = min(kin, key=lambda cf: fit_squares(cf[1]), default=tried)
    if fit_squares(found) >= fit_squares(rough):
        return tried
    (there, other) = (f"{c.at}.{c.effect.name}." for c in (candidate, larger))
    values = {
        n: found.model.parameters[n.replace(there, other, 1)].value for n in rough.model.parameters
    }
    again = estimate(rough.model.with_values(values), prepared, effort=ROUGH)
    return candidate, min((rough, again), key=fit_squares)


#: squares on the fit records above the best candidate's up to which another is fitted finely too
CONTENDING = 0.5


def _refined(
    tried: tuple[Candidate, Fit],
    leading: float,
    worthless: float,
    prepared: Prepared,
    stated: Model | None,
) -> tuple[Candidate, Fit]:
    """Fitted finely, where it leaves no more than `leading` and less than `worthless` squares."""
    candidate, rough = tried
    present = (candidate.effect.name, candidate.at) not in rough.model.absent
    if not present or fit_squares(rough) > leading:
        return tried
    if stated is not None:
        model = at_stated(rough.model, stated)
        # an effect stated without values was led astray by what is missing: it starts anew as well
        again = (
            estimate_from_starts(model, prepared)
            if model.absent
            else estimate(model, prepared, effort=ROUGH)
        )
        if fit_squares(again) < fit_squares(rough):
            rough = again
    if fit_squares(rough) > worthless:
        return candidate, rough
    return candidate, estimate(rough.model, prepared)


def rank_candidates(
    base: Fit,
    prepared: Prepared,
    *,
    among: Collection[Candidate] | None = None,
    stated: Model | None = None,
    worth: float = WORTH,
    progress: Callable[[str], None] | None = None,
) -> Ranking:
    """Try every candidate on top of a fitted model.

    base: the fitted model that something may be missing in
    among: those that are tried, of all that the model could take
    stated: the model as its user gave it; its values are starts too
    worth: part of the base's squares on the fit records below which a gain is not pursued
    progress: called with a line of text before each candidate
    """

    def tried(candidate: Candidate) -> tuple[Candidate, Fit]:
        if progress is not None:
            progress(str(candidate))
        added = base.model.with_effect(candidate.effect, at=candidate.at)
        return candidate, estimate_from_starts(added, prepared, base, stated, worth=worth)

    possible = candidates(base.model, [s.motion for s in prepared.of("fit")])
    if among is not None:
        wanted = {c.key for c in among}
        possible = tuple(c for c in possible if c.key in wanted)
    # those with hidden states take longest: begun last, they would be waited for
    fits = in_threads(tried, sorted(possible, key=lambda c: not c.effect.states))
    fits.sort(key=lambda cf: possible.index(cf[0]))
    fits = in_threads(lambda cf: _from_kin(cf, fits, prepared), fits)
    # one that does not count is no measure of what others must reach
    counted = [f for _, f in fits if not refusal(base, f)] or [f for _, f in fits]
    leading = (1.0 + CONTENDING) * min((fit_squares(f) for f in counted), default=0.0)
    worthless = (1.0 - worth) * fit_squares(base)
    fits = in_threads(lambda cf: _refined(cf, leading, worthless, prepared, stated), fits)
    told = {c.key: is_told(f, base) for c, f in fits}
    refused = {c.key: refusal(base, f) for c, f in fits}

    def place(tried: tuple[Candidate, Fit]) -> tuple[bool, float]:
        key = tried[0].key
        return not told[key] or bool(refused[key]), check_squares(tried[1])

    fits.sort(key=place)
    found = [ranked(base, c, f, fits[0][1] if i else None) for i, (c, f) in enumerate(fits)]
    return Ranking(base, tuple(found))


def ranked(base: Fit, candidate: Candidate, found: Fit, best: Fit | None = None) -> Ranked:
    """A candidate as a ranking has it.

    best: fit of the candidate that the ranking begins with; None: this one
    """
    return Ranked(
        candidate=candidate,
        fit=found,
        score=check_score(base, found),
        behind=whole_score(found, best) if best is not None else 0.0,
        told=is_told(found, base),
        refused=refusal(base, found),
    )
