"""A diagnosis in single steps: rank the candidates, add one, look again, take it back.

A workbench is frozen; each step gives a new one, and the old one is the way back.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

from ..base.errors import ModelError, did_you_mean
from ..diagnose.climb import make_next_move
from ..diagnose.conclusion import end_of
from ..diagnose.diagnosis import Diagnosis
from ..diagnose.error import force_error
from ..diagnose.ladder_state import LadderSearch, LadderState, begin, look, search_for
from ..diagnose.ranking import Ranked
from ..diagnose.result import diagnosis_of
from ..diagnose.rung import Rung
from ..effects import EFFECTS, Effect
from ..measurement.experiment import Experiment
from ..model import Model


@dataclass(frozen=True)
class Workbench:
    """The rungs of the ladder so far, with the candidates of each.

    search: the part that stays the same;  states: one for each rung, the last is the present one
    is_ranked: whether the candidates for the last rung are known already
    """

    search: LadderSearch
    states: tuple[LadderState, ...]
    is_ranked: bool = True

    @classmethod
    def of(
        cls,
        experiment: Experiment,
        *,
        known: Mapping[str, Effect] = EFFECTS,
        among: Collection[str] | None = None,
        progress: Callable[[str], None] | None = None,
    ) -> Workbench:
        """The user's model, re-estimated, and every candidate for it; takes some seconds.

        known: effects by name, which a description may use;  among: names of the candidates
        raises ExperimentError: the experiment lacks something that the comparison needs
        """
        model = Model.from_experiment(experiment, known)
        if among is not None:
            model = replace(model, known={n: e for n, e in known.items() if n in among})
        search = search_for(experiment, model, progress=progress)
        return cls(search, (begin(search),))

    @property
    def experiment(self) -> Experiment:
        """The experiment with which all models are compared."""
        return self.search.experiment

    @property
    def state(self) -> LadderState:
        """The present state of the ladder."""
        return self.states[-1]

    @property
    def model(self) -> Model:
        """The model of the last rung."""
        return self.state.fit.model

    @property
    def rungs(self) -> tuple[Rung, ...]:
        """The user's model first, then one rung for each effect."""
        return self.state.rungs

    @property
    def candidates(self) -> tuple[Ranked, ...]:
        """Effects that may be added, best first; empty until they are ranked."""
        return self.state.ranking.ranked if self.is_ranked else ()

    def add(self, effect: str, at: str) -> Workbench:
        """With that candidate added, whose fit is known, so that this is fast.

        raises ModelError: no such candidate for the last rung
        """
        chosen = self._candidate(effect, at)
        rung = Rung(chosen.candidate, chosen.fit, self.state.ranking)
        state = self.state.with_rungs((*self.rungs, rung))
        return replace(self, states=(*self.states, state), is_ranked=False)

    def take_back(self) -> Workbench:
        """Without the last rung; raises ModelError: only the user's model is left."""
        if len(self.states) == 1:
            raise ModelError("take back: nothing was added")
        return replace(self, states=self.states[:-1], is_ranked=True)

    def rank(self, progress: Callable[[str], None] | None = None) -> Workbench:
        """With the candidates for the last rung; takes some seconds."""
        if self.is_ranked:
            return self
        search = replace(self.search, progress=progress) if progress else self.search
        state = look(search, self.rungs, self.states[-2])
        return replace(self, states=(*self.states[:-1], state), is_ranked=True)

    def go_on(self, progress: Callable[[str], None] | None = None) -> Workbench:
        """All further steps of `teleopdesign diagnose`; each can be taken back."""
        bench = self.rank(progress)
        search = replace(self.search, progress=progress) if progress else self.search
        states = bench.states
        while (moved := make_next_move(search, states[-1], pairs=True)) is not None:
            states = (*states, look(search, moved.rungs, moved))
        return replace(bench, states=states)

    def diagnosis(self, progress: Callable[[str], None] | None = None) -> Diagnosis:
        """The conclusion from the present rungs: verdict, probabilities, open questions."""
        bench = self.rank(progress)
        search = replace(self.search, progress=progress) if progress else self.search
        return diagnosis_of(end_of(search, bench.state))

    def errors(self, values: Mapping[str, float]) -> tuple[float, float]:
        """Fit and check error (relative) of the model with other parameter values (SI)."""
        model, prepared = self.model.with_values(values), self.search.whole
        return force_error(model, prepared.of("fit")), force_error(model, prepared.of("check"))

    def _candidate(self, effect: str, at: str) -> Ranked:
        for ranked in self.candidates:
            if ranked.candidate.key == (effect, at):
                return ranked
        names = [f"{r.candidate}" for r in self.candidates]
        wanted = f"{effect} at {at}"
        raise ModelError(f'add: no candidate "{wanted}"{did_you_mean(wanted, names)}')
