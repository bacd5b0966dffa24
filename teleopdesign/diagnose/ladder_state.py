"""The state of a ladder during the search and at its end, and the tools that its moves share."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..base.frozen import ByValue
from ..check import CheckedRecording, why_silent
from ..effects import depends_on_time, find_effect
from ..measurement.experiment import Experiment
from ..measurement.friction_curve import count_speeds
from ..measurement.prepare import Prepared, prepare
from ..model import Model
from .candidates import Candidate, restrict_to_curve
from .decision import is_supported, worth_pursuing
from .evidence import is_adequate, is_noise, limit_noise_floor
from .fit import Fit
from .free_functions import Belief
from .noise_floor import NoiseFloor, noise_floor
from .outside_tone import Tone, best_tone
from .rank import rank_candidates
from .ranking import Ranked, Ranking
from .rung import Rung
from .search_plan import PLAN, SearchPlan, cut_to_windows
from .stated_fit import estimate_values, with_late_hand, with_late_starts, with_paying_shift
from .statements import SetAside


@dataclass(frozen=True)
class LadderSearch:
    """All that stays the same during a diagnosis.

    whole: the prepared records;  prepared: their windows that are searched
    stated: the model as its user gave it
    seed: of the random numbers; each noise floor uses the same ones
    progress: called with a line of text at each step
    silence: why the records of the arm tell no effect at this joint; "": they may tell one
    """

    experiment: Experiment
    whole: Prepared
    prepared: Prepared
    stated: Model
    seed: int = 0
    plan: SearchPlan = PLAN
    progress: Callable[[str], None] = lambda _: None
    silence: str = ""

    @property
    def is_of_body_in_time(self) -> bool:
        """Whether readings are simulated, and effects tested on all records together.

        Not at a joint of an arm: effects are tested on all joints, whose readings are drawn
        together. Not on a friction curve, which has no time.
        """
        return not (self.whole.is_linked or self.whole.is_curve)

    @property
    def draws_gaps(self) -> bool:
        """Whether gaps are sought among draws; at joints of an arm it was not measured."""
        return self.plan.draws > 0 and self.is_of_body_in_time

    def generator(self) -> np.random.Generator:
        """A new random generator that starts at the seed."""
        return np.random.default_rng(self.seed)

    def rank(
        self,
        base: Fit,
        *,
        step: int,
        among: Collection[Candidate] | None = None,
        body: str | None = None,
        worth: float | None = None,
        widely: bool = False,
    ) -> Ranking:
        """`rank_candidates` on top of a fit.

        step: number of the rung that is searched
        """
        return rank_candidates(
            base,
            self.prepared,
            among=among,
            body=body,
            stated=self.stated,
            worth=worth,
            widely=widely,
            progress=lambda line: self.progress(line.within(f"step {step}")),
        )


@dataclass(frozen=True)
class LadderState:
    """The rungs of a ladder, and the results of `look` for the last of them.

    A move changes the rungs; noise floor and rankings stay the same until the next `look`.

    rungs: the user's model first, then one rung per effect
    floor: noise floor of the last rung, at most the error that the records themselves leave
    ranking: all candidates beside the last rung;  tone: the best external tone in its residual
    supported: candidates that the records support, in the order of the ranking
    set_aside: effects that are not added again: the final errors did not support them, other values
        of the model explain as much, or they only weaken errors of the readings
    visited: effects of all earlier models: no move leads to such a set again
    """

    rungs: tuple[Rung, ...]
    floor: NoiseFloor
    ranking: Ranking
    tone: Tone
    supported: tuple[Ranked, ...]
    set_aside: tuple[SetAside, ...] = ()
    visited: frozenset[frozenset[tuple[str, str]]] = frozenset()

    @property
    def effects(self) -> frozenset[tuple[str, str]]:
        """Effects of the last rung's model, with their places."""
        return frozenset(self.fit.model.effects)

    @property
    def gone(self) -> frozenset[tuple[str, str]]:
        """Effects, with their places, that are not added again."""
        return frozenset(one.candidate.key for one in self.set_aside)

    @property
    def weakening(self) -> frozenset[tuple[str, str]]:
        """Effects, with their places, that were removed because they only weaken reading errors."""
        return frozenset(one.candidate.key for one in self.set_aside if one.of_readings)

    def with_floor_limited(self) -> LadderState:
        """The state with the noise floor that its candidates allow, without `weakening`."""
        drawn = replace(self.floor, value=self.floor.drawn)
        limited = limit_noise_floor(drawn, self.fit, self.ranking, self.weakening)
        return replace(self, floor=limited)

    @property
    def fit(self) -> Fit:
        """The last rung's fit."""
        return self.rungs[-1].fit

    @property
    def step(self) -> int:
        """Number of the rung that is searched."""
        return len(self.rungs)

    def with_rungs(self, rungs: Collection[Rung]) -> LadderState:
        """The state with other rungs, and the results of the same `look`."""
        return replace(self, rungs=tuple(rungs))


@dataclass(frozen=True, eq=False)
class LadderEnd(ByValue):
    """What a search ends with; `result.diagnosis_of` states it as a `Diagnosis`.

    last: ranking after the last rung, none of which was accepted
    estimated: the last rung's fit, parameters not yet corrected for errors of the readings
    set_aside, silence: as in `Diagnosis`
    beliefs: accepted effect (name, place) -> what it explains beside free functions
    """

    search: LadderSearch
    rungs: tuple[Rung, ...]
    last: Ranking
    estimated: Fit
    floor: NoiseFloor
    set_aside: tuple[SetAside, ...]
    beliefs: Mapping[tuple[str, str], Belief]
    silence: str

    @property
    def before(self) -> Fit:
        """The fit of the user's model, re-estimated."""
        return self.rungs[0].fit

    @property
    def after(self) -> Fit:
        """The fit of the model with every accepted effect."""
        return self.rungs[-1].fit

    def reason_set_aside(self, key: tuple[str, str]) -> str:
        """Why an effect (name, place) was accepted and removed again; "" for all other effects."""
        return next((one.reason for one in self.set_aside if one.candidate.key == key), "")

    @property
    def more_is_missing(self) -> bool:
        """Whether the final model leaves more than noise."""
        return not is_adequate(self.after, self.floor)


def search_for(
    experiment: Experiment | Prepared,
    model: Model | None = None,
    *,
    progress: Callable[[str], None] | None = None,
    seed: int = 0,
    plan: SearchPlan = PLAN,
) -> LadderSearch:
    """A search for the effects that a model lacks; without candidates where records tell nothing.

    experiment: or its records, prepared at the bandwidth of the comparison
    model: None: the model that the experiment describes
    """
    whole = experiment if isinstance(experiment, Prepared) else prepare(experiment)
    experiment = whole.experiment
    stated = model or Model.from_experiment(experiment)
    if whole.is_curve:
        stated = restrict_to_curve(stated, count_speeds(s.motion.velocity for s in whole.stretches))
    if why_silent(CheckedRecording(experiment, stated, whole)):
        stated = restrict_candidates((), stated)
    return LadderSearch(
        experiment=experiment,
        whole=whole,
        prepared=cut_to_windows(whole, plan),
        stated=stated,
        seed=seed,
        plan=plan,
        progress=progress or (lambda _: None),
    )


def restrict_candidates(among: Collection[str], model: Model) -> Model:
    """The model to which only these effects may be added.

    raises ModelError: the name of an effect is unknown
    """
    return replace(model, known={n: find_effect(n, model.known, "among") for n in among})


def begin(search: LadderSearch) -> LadderState:
    """The ladder that holds the user's model alone, re-estimated."""
    search.progress("re-estimating the model")
    fit = estimate_values(search.stated, search.prepared)
    return look(search, (Rung(None, with_late_starts(fit, search.stated, search.prepared)),))


def look(
    search: LadderSearch, rungs: tuple[Rung, ...], before: LadderState | None = None
) -> LadderState:
    """Draw the noise floor of the last rung, and rank every candidate added to its model.

    before: the state that a move led to; None: the ladder begins
    Where a low-pass of the hand's force sensor explains more than every effect and every external
    tone, the rung is fitted with this low-pass, and all candidates are ranked again.
    """
    prepared = search.prepared
    here = with_paying_shift(rungs[-1].fit, prepared)
    rungs = (*rungs[:-1], replace(rungs[-1], fit=here))
    drawn = noise_floor(here.model, prepared, search.generator())
    worth = worth_pursuing(here, drawn)
    more = not is_noise(here.check_error, drawn)
    ranking = search.rank(here, step=len(rungs), worth=worth, widely=more and search.draws_gaps)
    weakening = () if before is None else before.weakening
    floor = limit_noise_floor(drawn, here, ranking, weakening)
    tone = best_tone(here, prepared)
    gone = set() if before is None else before.gone
    supported = tuple(
        r
        for r in ranking.ranked
        if r.candidate.key not in gone
        and is_supported(here, r, floor)
        and (tone.is_beaten_by(r.fit) or depends_on_time(r.candidate.effect))
    )
    late = with_late_hand(here, supported, floor, prepared)
    if late is not None and tone.is_beaten_by(late):
        # a late log is no effect: all effects are ranked again with it
        return look(search, (*rungs[:-1], replace(rungs[-1], fit=late)), before)
    if before is None:
        there = frozenset({frozenset(here.model.effects)})
        return LadderState(rungs, floor, ranking, tone, supported, visited=there)
    state = replace(
        before, rungs=rungs, floor=floor, ranking=ranking, tone=tone, supported=supported
    )
    return replace(state, visited=before.visited | {state.effects})
