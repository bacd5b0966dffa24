"""A model of which only the names of effects matter, and a search whose errors a rule states."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from types import SimpleNamespace

from diagnose.stand_ins import fit, floor

from teleopdesign.base.errors import ModelError
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.decision import rank_key
from teleopdesign.diagnose.ladder_state import LadderState
from teleopdesign.diagnose.outside_tone import Tone
from teleopdesign.diagnose.ranking import Ranked, Ranking
from teleopdesign.diagnose.rung import Rung
from teleopdesign.effects import EFFECTS


@dataclass(frozen=True)
class Names:
    """The effects of a model at its one place; needs: (effect, what it is not there without)."""

    names: frozenset[str]
    needs: tuple[tuple[str, str], ...] = ()
    known: dict[str, None] = field(default_factory=lambda: {"device": None}, hash=False)
    parameters: dict[str, None] = field(default_factory=dict, hash=False)
    axis: str = "revolute"

    @property
    def effects(self):
        return [(n, "device") for n in self.names]

    def body(self, at):
        return self

    def has(self, name):
        return name in self.names

    def lacks(self, effect):
        return any(one == effect.name and n not in self.names for one, n in self.needs)

    def with_effect(self, effect, at):
        name = effect if isinstance(effect, str) else effect.name
        return replace(self, names=self.names | {name})

    def with_values(self, values):
        return self

    def without_effect(self, name, at):
        if any(needed == name and one in self.names for one, needed in self.needs):
            raise ModelError(f"{name} is needed")
        return replace(self, names=self.names - {name})


def candidate(name):
    return Candidate(EFFECTS[name], "device")


@dataclass(frozen=True)
class Table:
    """Fits whose check error is a rule of the set of effects.

    ranked: what else is to be said of a candidate where it is ranked, by name
    """

    error: Callable[[frozenset[str]], float]
    needs: tuple[tuple[str, str], ...] = ()
    ranked: dict[str, dict[str, object]] = field(default_factory=dict)

    def fit(self, *names):
        return self.estimate(Names(frozenset(names), self.needs), None)

    def estimate(self, model, prepared):
        one = fit(self.error(model.names))
        one.model = model
        return one

    def rungs(self, *names):
        """The user's model, then one rung an effect in this order."""
        fits = [self.fit(*names[:k]) for k in range(len(names) + 1)]
        first = Rung(None, fits[0])
        return (first, *(Rung(candidate(n), f) for n, f in zip(names, fits[1:], strict=True)))

    def rank(self, base, *, among, step=1):
        """The candidates beside a fit, best first."""
        rows = []
        for c in among:
            there = self.estimate(base.model.with_effect(c.effect, c.at), None)
            row = Ranked(c, there, 9.0, 0.0, is_identifiable=True)
            rows.append(replace(row, **self.ranked.get(c.effect.name, {})))
        return Ranking(base, tuple(sorted(rows, key=rank_key)))

    def search(self):
        plan = SimpleNamespace(exchanges=2)
        return SimpleNamespace(prepared=None, plan=plan, rank=self.rank)

    def state(self, rungs, **more):
        """A ladder of these rungs, beside a low floor."""
        low, nothing = floor(0.01), Ranking(rungs[-1].fit, ())
        return LadderState(tuple(rungs), low, nothing, Tone(), (), **more)
