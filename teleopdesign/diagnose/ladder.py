"""The ladder: effects added one at a time, each supported by records that it was not fitted on."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from ..errors import ModelError
from ..measurement.experiment import Experiment
from ..model import Model
from .candidates import Candidate
from .diagnosis import (
    MOSTLY,
    Diagnosis,
    Rung,
    explained,
    is_adequate,
    is_noise,
    moment_above_noise,
    verdict,
)
from .excerpt import excerpt
from .exchange import best_exchange, rivals_of
from .fit import Fit, estimate, fit_squares
from .force_error import Prepared, at_command, force_error, prepare
from .noise_floor import NoiseFloor, noise_floor
from .outside_tone import Tone, acts_by_the_clock, best_tone
from .probability import probable
from .rank import (
    Ranking,
    check_squares,
    rank_candidates,
    ranked,
)
from .reading_error import with_reading_error
from .search import estimate_from_starts
from .support import alike, equals_of, is_better, is_supported, simplicity, worth_pursuing

#: an effect that makes sensors count for this much more than they do in the user's model, and for
#: this part of what that leaves, hides what it leaves in their noise
LOUDER, HIDDEN = 1.8, 0.1
#: most effects that one diagnosis adds
MOST = 6
#: samples of all records together above which effects are sought on windows of so many
LONG, WINDOWS = 200_000, 60_000
#: candidates that are added on trial where none is supported alone: each may mask another
TRIED = 3
#: most exchanges of an accepted effect for another
EXCHANGES = 2


def find_missing(
    experiment: Experiment,
    model: Model | None = None,
    *,
    progress: Callable[[str], None] | None = None,
    seed: int = 0,
) -> Diagnosis:
    """Hold a model against an experiment and add the effects that its check records support.

    model: default: the one that the experiment describes
    Of more than `LONG` samples, effects are sought and parameters estimated on `WINDOWS` samples in
    windows spread evenly over the records; errors are those of the whole records.
    progress: called with a line of text at each step;  seed: of the draws for the noise floor
    raises ExperimentError: the experiment lacks what the comparison needs
    """
    say = progress or (lambda _: None)
    prepared = prepare(experiment)
    whole, long = prepared, sum(len(r.time) for r in experiment.records) > LONG
    if long:
        prepared = prepare(excerpt(experiment, most=WINDOWS), bandwidth=whole.bandwidth)
    say("re-estimating the model")
    stated = model or Model.from_experiment(experiment)
    rungs = [Rung(None, estimate_from_starts(stated, prepared))]
    first: NoiseFloor | None = None
    exchanges, paired = EXCHANGES, False
    while True:
        here = rungs[-1].fit
        floor = noise_floor(here.model, prepared, np.random.default_rng(seed))
        step = len(rungs)
        saying = partial(_said, say, f"step {step}: ")
        worth = worth_pursuing(here, floor)
        ranking = rank_candidates(here, prepared, stated=stated, worth=worth, progress=saying)
        floor = _bounded(floor, here, ranking)
        first = floor if first is None else first
        floor = floor.at_most(max(LOUDER * first.value, HIDDEN * rungs[0].fit.check_error))
        tone = best_tone(here, prepared)
        supported = [
            r
            for r in ranking.ranked
            if is_supported(here, r, floor)
            and (tone.is_beaten_by(r.fit) or acts_by_the_clock(r.candidate.effect))
        ]
        if len(rungs) > MOST:
            break
        if not supported:
            if _is_a_tone(here, tone, floor):
                break
            # beside effects that are accepted already a pair costs more time than it is worth
            pair = _pair(rungs[0], ranking, prepared, floor, stated, saying) if step == 1 else []
            rungs += pair
            if pair:
                continue
            changed = _exchanged(rungs, prepared, floor, stated, saying) if exchanges else []
            if changed:
                exchanges -= 1
            elif not paired:
                paired, changed = True, _settling_pair(rungs, prepared, floor, stated, saying)
            if not changed:
                break
            rungs = changed
            continue
        best = min(alike(supported), key=simplicity)
        rungs.append(Rung(best.candidate, best.fit, ranking, equals_of(best, ranking, here, floor)))
        rungs = _pruned(rungs, prepared, floor)
    say("reading the model's own motion")
    here, generator = rungs[-1].fit, np.random.default_rng(seed)
    read = with_reading_error(
        here, prepared, generator, adequate=lambda fit: is_adequate(fit, floor)
    )
    corrected = [*rungs[:-1], replace(rungs[-1], fit=read)]
    if _first_rise(corrected) is None:
        rungs = corrected
    moment = moment_above_noise(rungs[-1].fit, prepared, floor)
    if long:
        say("errors on the whole records")
        rungs = [replace(r, fit=_on_all(r.fit, whole)) for r in rungs]
        if len(steady := _without_rise(rungs)) < len(rungs):
            rungs, here = steady, steady[-1].fit
    said = verdict(rungs, floor, moment)
    found = Diagnosis(experiment, whole, said, tuple(rungs), ranking, here, floor, moment)
    named = probable(found)
    if said == "effects_missing" and not named:
        return replace(found, verdict="undecided")
    return replace(found, named=named)


def _bounded(floor: NoiseFloor, here: Fit, ranking: Ranking) -> NoiseFloor:
    """The floor, no higher than what the model leaves, or any candidate that can be told.

    Without what is missing a parameter may be led where sensor noise would ask for any force: what
    the records themselves leave shows that it does not.
    """
    left = [here.check_error, *(r.fit.check_error for r in ranking.ranked if r.counts)]
    return replace(floor, value=min(floor.value, *left))


def _is_a_tone(found: Fit, tone: Tone, floor: NoiseFloor) -> bool:
    """Whether a plain tone explains all but noise."""
    squares = check_squares(found)
    left = found.check_error * float(np.sqrt(tone.squares / squares)) if squares > 0.0 else 0.0
    return is_noise(left, floor)


def _on_all(found: Fit, whole: Prepared) -> Fit:
    """A fit that was made on windows, with the errors that it has on the whole records."""
    fit_error = force_error(found.model, whole.of("fit"))
    check = whole.of("check")
    if not check:
        return replace(found, fit_error=fit_error)
    error, seen = force_error(found.model, check), at_command(found.model, check)
    there = replace(found.seen, error=seen.error, blind=seen.blind, weak=seen.weak)
    return replace(found, fit_error=fit_error, check_error=error, seen=there)


def _pair(
    base: Rung,
    ranking: Ranking,
    prepared: Prepared,
    floor: NoiseFloor,
    stated: Model,
    say: Callable[[str], None],
    among: Collection[Candidate] | None = None,
) -> list[Rung]:
    """Two effects that are supported together though neither is alone; none where there are none.

    Each of two effects can mask the other. The best few are added on trial, and everything (or
    those in `among`) is ranked anew beside each; a pair counts where it explains most of what is
    missing and neither of the two can be left out.
    """
    here = base.fit
    if is_adequate(here, floor):
        return []
    found: list[list[Rung]] = []
    trials = [r for r in ranking.ranked if r.counts and fit_squares(r.fit) < fit_squares(here)]
    for first in trials[:TRIED]:
        again = rank_candidates(first.fit, prepared, among=among, stated=stated, progress=say)
        second = next((r for r in again.ranked if is_supported(first.fit, r, floor)), None)
        if second is None:
            continue
        rungs = [
            Rung(first.candidate, first.fit, ranking),
            Rung(second.candidate, second.fit, again, equals_of(second, again, first.fit, floor)),
        ]
        if _stands(here, rungs, prepared, floor):
            falling = _falling([base, *rungs], prepared)
            found += [falling[1:]] if falling else []
    return min(found, key=lambda rungs: check_squares(rungs[-1].fit), default=[])


def _settling_pair(
    rungs: list[Rung],
    prepared: Prepared,
    floor: NoiseFloor,
    stated: Model,
    say: Callable[[str], None],
) -> list[Rung]:
    """Two effects that leave only noise in place of rungs that leave more; none where none do.

    Where two are missing, a third can explain more than either does alone, and stand in their way.
    They are sought among those that explained something of their own.
    """
    first = rungs[1].ranking if len(rungs) > 1 else None
    if first is None or is_adequate(rungs[-1].fit, floor):
        return []
    told = [r.candidate for r in first.ranked if r.counts]
    pair = _pair(rungs[0], first, prepared, floor, stated, say, told)
    return [rungs[0], *pair] if pair and is_adequate(pair[-1].fit, floor) else []


def _stands(base: Fit, rungs: list[Rung], prepared: Prepared, floor: NoiseFloor) -> bool:
    """Whether two effects together explain most of what is missing and both are needed."""
    both, first = rungs[-1].fit, rungs[0].added
    assert first is not None
    if not is_better(base, both, floor) or explained(base, both, floor) < MOSTLY:
        return False
    if not best_tone(base, prepared).is_beaten_by(both):
        return False
    try:
        without = estimate(both.model.without_effect(first.effect.name, at=first.at), prepared)
    except ModelError:
        return True  # the second needs the first
    return is_better(without, both, floor)


def _exchanged(
    rungs: list[Rung],
    prepared: Prepared,
    floor: NoiseFloor,
    stated: Model,
    say: Callable[[str], None],
) -> list[Rung]:
    """The rungs with one effect exchanged for a better; none where there is none, or only noise."""
    last = rungs[-1].fit
    if is_adequate(last, floor):
        return []
    there = [r.added for r in rungs if r.added is not None]
    # the last was ranked beside all the others already
    rivals = {
        r.added: rivals_of(r.ranking, there, floor)
        for r in rungs[1:-1]
        if r.added is not None and r.ranking is not None
    }
    found = best_exchange(last, rivals, prepared, floor, stated=stated, progress=say)
    if found is None:
        return []
    best = found.taken
    equals = equals_of(best, found.ranking, found.without, floor)
    taken = Rung(best.candidate, best.fit, found.ranking, equals)
    kept = [r for r in rungs if r.added is not found.dropped]
    changed = _falling(_refitted([*kept, taken], taken.fit, prepared), prepared)
    return _pruned(changed, prepared, floor) if changed else []


def _said(say: Callable[[str], None], before: str, text: str) -> None:
    say(before + text)


def _pruned(rungs: list[Rung], prepared: Prepared, floor: NoiseFloor) -> list[Rung]:
    """Without an effect that those added later have made superfluous; the rest fitted again."""
    last = rungs[-1]
    for rung in rungs[1:-1]:
        assert rung.added is not None
        name, at = rung.added.key
        try:
            without = estimate(last.fit.model.without_effect(name, at=at), prepared)
        except ModelError:
            continue  # another effect needs it
        if not is_better(without, last.fit, floor):
            fewer = [r for r in rungs if r is not rung]
            return _falling(_refitted(fewer, without, prepared), prepared) or rungs
    return rungs


def _first_rise(rungs: Sequence[Rung]) -> int | None:
    """The first rung that leaves more on the check records than the one before it."""
    rises = (later.fit.check_error > rung.fit.check_error for rung, later in pairwise(rungs))
    return next((i for i, rises_here in enumerate(rises, 1) if rises_here), None)


def _falling(rungs: list[Rung], prepared: Prepared) -> list[Rung]:
    """The rungs in an order in which the check error falls with each; none where none is found.

    A rung that leaves more than the one before it was masked by what follows it: the two change
    places.
    """
    for _ in rungs:
        rise = _first_rise(rungs)
        if rise is None:
            return rungs
        if rise + 1 == len(rungs):
            return []
        masked, masking = rungs[rise], rungs[rise + 1]
        assert masked.added is not None and masking.added is not None
        before, (name, at) = rungs[rise - 1].fit, masked.added.key
        try:
            alone = estimate(masking.fit.model.without_effect(name, at=at), prepared)
        except ModelError:
            return []  # the second needs the first
        first = Rung(masking.added, alone, _ranked_alone(before, masking.added, alone))
        second = Rung(masked.added, masking.fit, _ranked_alone(alone, masked.added, masking.fit))
        rungs = [*rungs[:rise], first, second, *rungs[rise + 2 :]]
    return []


def _ranked_alone(base: Fit, candidate: Candidate, found: Fit) -> Ranking:
    """The ranking of one candidate that was fitted already."""
    return Ranking(base, (ranked(base, candidate, found),))


def _without_rise(rungs: list[Rung]) -> list[Rung]:
    """The rungs up to the first that leaves more than the one before it."""
    return rungs[: _first_rise(rungs)]


def _refitted(rungs: list[Rung], last: Fit, prepared: Prepared) -> list[Rung]:
    """The rungs with each fit made again, from the values of the last, without what comes later."""
    found = [replace(rungs[-1], fit=last)]
    model = last.model
    for later, rung in zip(rungs[:0:-1], rungs[-2:0:-1], strict=False):
        assert later.added is not None
        model = model.without_effect(later.added.effect.name, at=later.added.at)
        found.append(replace(rung, fit=estimate(model, prepared)))
    return [rungs[0], *reversed(found)]
