"""The search for the channels of a diagram: the likeliest columns, by names and cuts.

    ln p(channels) = sum of ln p(signal | name of its column) + sum over the cuts of k ln(1 / error)

A name is a prior: its words are compared with the name, the text and the quantity of each signal.
The error of a cut is that of the stated diagram. k + 1 columns are as many independent signals: a
prediction made of wrong ones comes within an error e of the recorded one by a chance of e^k.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from ..base.errors import TeleopDesignError
from ..base.units import measures, unit_of
from ..diagnose.error import force_error
from ..diagrams import Diagram
from ..measurement.column_names import is_another_quantity, is_wanted, likeness, words_of
from ..measurement.filtering import Array
from ..measurement.prepare import prepare
from ..measurement.survey.content import SURE_NAME
from ..measurement.survey.position_entry import unit_of_reach
from .body import body_experiment, model_of_body
from .computer_fit import data_of_computer
from .cuts import Cut, Cuts, cuts_of
from .diagram_experiment import DiagramExperiment, axis_of
from .reading import diagram_experiment
from .what_to_log import what_to_log, zero_signals

#: part of columns whose name suggests another signal, and of right cuts that explain nothing
WRONG = 0.02
#: part of signals that are logged with the other sign
TURNED = 0.1
#: how much a word for the force of an actuator says of a force that is none
OF_ANY_FORCE = 0.4
#: share of a name above which the column is a channel without a test: more than half
NAMED = 0.5
#: rows that are compared, columns a signal may have, and proposals that are kept in the search
ROWS, COLUMNS, KEPT = 4000, 6, 20
#: error below which nothing more is told: the diagram's values are starts
LEAST_ERROR = 1e-3


@dataclass(frozen=True)
class ColumnChoice:
    """A column as a signal;  unit: of the column;  sign: -1: positive the other way."""

    column: str
    unit: str
    sign: int = 1

    @property
    def table(self) -> dict[str, Any]:
        """As in [channels] of an experiment."""
        return {"column": self.column, "unit": self.unit} | ({"sign": -1} if self.sign < 0 else {})


class ChannelSearch:
    """The columns of a log as signals of a diagram, with the errors of cuts that were computed.

    data: column -> readings (n,), the time too;  units: column that may be a signal -> unit or None
    clock: "time" or "sample_rate" -> its table in [channels]
    stated: signal -> its column or "none"
    """

    def __init__(
        self,
        diagram: Diagram,
        data: Mapping[str, Array],
        units: Mapping[str, str | None],
        clock: Mapping[str, Any],
        stated: Mapping[str, str],
    ) -> None:
        self.diagram, self.units, self.clock, self.stated = diagram, units, clock, stated
        self.data = {name: values[:ROWS] for name, values in data.items()}
        self.bodies = diagram.moving
        self.sensed = [one.name for one in what_to_log(diagram).signals]
        alike = {_letters(n) for n in units}
        more = [s for s in diagram.signals if s in stated or _letters(s) in alike]
        single = [j for j in diagram.junctions if len(j.terms) == 1 and j.output in self.sensed]
        again = {s for j in single for s in j.terms}  # the same signal under another name
        every = dict.fromkeys([*(s for s in self.sensed if s not in again), *more])
        # a cut closes as early as possible: motions, forces on bodies, commands, then the rest
        first = [b.motion for b in self.bodies] + [s for b in self.bodies for s in b.loads]
        first += [b.command for b in self.bodies]
        self.signals = sorted(every, key=lambda s: first.index(s) if s in first else len(first))
        self.names = {(s, n): self._likeness(s, n) for s in self.signals for n in units}
        sums = {n: sum(self.names[s, n] ** 2 for s in self.signals) for n in units}
        self.prior = {
            key: max(like**2 / (sums[key[1]] + WRONG), WRONG) for key, like in self.names.items()
        }
        self.power = max(min(len(units), len(self.sensed)) - 1, 1)
        self.known: dict[Any, float] = {}

    def quantity(self, signal: str) -> str:
        """ "position" or "force"."""
        outside = self.diagram.outside.get(signal) == "position"
        return "position" if outside or self.diagram.is_position(signal) else "force"

    def _likeness(self, signal: str, column: str) -> float:
        """How much the name of a column suggests a signal, 0 to 1."""
        if _letters(column) == _letters(signal):
            return 1.0
        text = {w for w in words_of(self.diagram.texts.get(signal, "")) if len(w) > 2}
        words = words_of(column)
        text |= {*words_of(signal)} if len(words) > 1 else set()  # a letter alone is no index
        values = [max(self._of_quantity(signal, w), _is_in_text(w, text)) for w in words]
        whole = "".join(words) if all(len(w) == 1 for w in words) else ""
        return max(sum(values) / max(len(words), 1), self._of_quantity(signal, whole))

    def _of_quantity(self, signal: str, word: str) -> float:
        """How much a word says of the quantity of a signal."""
        if self.quantity(signal) == "position":
            return likeness(word, "position")
        actuator = likeness(word, "actuator_force")
        if any(b.command == signal for b in self.bodies):
            return actuator
        held = any(signal in b.loads for b in self.bodies)
        return max(held * likeness(word, "interaction_force"), OF_ANY_FORCE * actuator)

    def choices(self, signal: str) -> list[ColumnChoice]:
        """Columns that may hold a signal, the likeliest names first, in a unit that it can have."""
        made: list[ColumnChoice] = []
        quantity, axis = self.quantity(signal), axis_of(self.diagram, signal)
        for name in sorted(self.units, key=lambda n: -self.prior[signal, n]):
            unit = self.units[name]
            if unit is None and not is_another_quantity(name) and not _is_velocity(name):
                reach = float(np.ptp(self.data[name]))
                usual = (
                    unit_of(quantity, axis) if quantity == "force" else unit_of_reach(reach, axis)
                )
                made.append(ColumnChoice(name, usual))
            elif unit is not None and measures(unit, quantity, axis):
                made.append(ColumnChoice(name, unit))
        return made

    def score(self, chosen: Mapping[str, ColumnChoice]) -> float:
        """ln of the probability of these channels, less that of none."""
        key = frozenset(chosen.items())
        if key not in self.known:
            priors = [
                self.prior[s, one.column] * (TURNED if one.sign < 0 else 1.0) / NAMED
                for s, one in chosen.items()
            ]
            errors = np.clip(list(self.errors(chosen).values()), LEAST_ERROR, None)
            fits = np.maximum(-self.power * np.log(errors), np.log(WRONG))
            self.known[key] = float(np.sum(np.log(priors)) + np.sum(fits))
        return self.known[key]

    def zero(self, chosen: Mapping[str, ColumnChoice]) -> tuple[str, ...]:
        """Outside signals at zero: those that no column could hold and that a cut needs."""
        sensed = [s for s in self.signals if s in chosen or s in self.sensed]
        return zero_signals(self.diagram, list(chosen), sensed)

    def errors(self, chosen: Mapping[str, ColumnChoice]) -> dict[str, float]:
        """Cut -> relative error of the stated diagram; 1 where it cannot be predicted."""
        zero = self.zero(chosen)
        made = {}
        for cut in cuts_of(self.diagram, list(chosen), zero).tested:
            key = (cut, zero, *(chosen[s] for s in (cut.signal, *cut.inputs)))
            if key not in self.known:
                channels = {**self.clock, **{s: one.table for s, one in chosen.items()}}
                experiment = diagram_experiment(
                    self.diagram, self.data, channels=channels, outside=list(zero)
                )
                self.known[key] = error_at(experiment, cut)
            made[cut.name] = self.known[key]
        return made

    def best(self) -> dict[str, ColumnChoice]:
        """The likeliest channels: signal by signal, the likeliest kept; then by single changes.

        A column whose name tells its signal is that signal, until the single changes.
        """
        named = {s: n for n in self.units for s in self.signals if self.tells(s, n)}
        named |= self.stated
        kept: list[dict[str, ColumnChoice]] = [{}]
        for signal in self.signals:
            others = {n for s, n in named.items() if s != signal}
            options = [c for c in self.choices(signal) if c.column not in others]
            if signal in named:
                options = [c for c in options if c.column == named[signal]]
            if self.quantity(signal) == "force":  # a motion turned is all forces turned
                options += [replace(one, sign=-1) for one in options]
            grown = [] if signal in named and options else kept
            grown = grown + [{**state, signal: o} for state in kept for o in _free(options, state)]
            kept = sorted(grown, key=self.score, reverse=True)[:KEPT]
        best = kept[0]
        while True:
            better = max(self.changes(best), key=self.score, default=best)
            if self.score(better) <= self.score(best):
                return best
            best = better

    def tells(self, signal: str, column: str) -> bool:
        """Whether the name of a column tells its signal, and no other one as well."""
        like = self.names[signal, column]
        rivals = [self.names[s, column] for s in self.signals if s != signal]
        rivals += [self.names[signal, n] for n in self.units if n != column]
        return like >= SURE_NAME and like > max(rivals, default=0.0)

    def changes(self, chosen: Mapping[str, ColumnChoice]) -> Iterator[dict[str, ColumnChoice]]:
        """Channels with one sign or column changed, one more, or two columns exchanged."""
        for signal, one in chosen.items():
            yield {**chosen, signal: replace(one, sign=-one.sign)}
        open_ = [s for s in self.signals if s not in self.stated]
        for signal in open_:
            for one in _free(self.choices(signal)[:COLUMNS], chosen):
                yield {**chosen, signal: one}
        for a, b in combinations([s for s in open_ if s in chosen], 2):
            for one in self.choices(a):
                for other in self.choices(b):
                    if (one.column, other.column) == (chosen[b].column, chosen[a].column):
                        yield {**chosen, a: one, b: other}


def _free(options: list[ColumnChoice], chosen: Mapping[str, ColumnChoice]) -> list[ColumnChoice]:
    """The options whose columns are in no channel."""
    used = {one.column for one in chosen.values()}
    return [one for one in options if one.column not in used]


def _is_velocity(name: str) -> bool:
    return likeness(name, "velocity") >= SURE_NAME


def error_at(experiment: DiagramExperiment, cut: Cut) -> float:
    """Relative error of the stated diagram at a cut; 1 where nothing can be predicted."""
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")  # of columns that are no such signal
            if cut.kind == "body":
                fitted = prepare(body_experiment(experiment, cut)).of("fit")
                error = force_error(model_of_body(experiment.diagram, cut), fitted)
            else:
                error = data_of_computer(experiment, Cuts((cut,), {}), {}).at(()).error("fit")
            return error if np.isfinite(error) else 1.0
    except TeleopDesignError:
        return 1.0


def _letters(name: str) -> str:
    """Letters and digits of a name, by which "r_a" is "R_A"."""
    return re.sub(r"[\W_]", "", name).lower()


def _is_in_text(word: str, text: set[str]) -> float:
    """Whether a word, or the longer one that it begins, stands in the text of a signal."""
    wanted = _is_reference(word) and any(map(_is_reference, text))
    return float(wanted or word in text or len(word) > 2 and any(w.startswith(word) for w in text))


def _is_reference(word: str) -> bool:
    """Whether a word says that a signal is wanted, and not that it is a command."""
    return is_wanted(word) and likeness(word, "actuator_force") == 0.0
