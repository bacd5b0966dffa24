"""Size of the search: the computing time of each number, and what a smaller one may miss.

Accuracy of a fit for each purpose: number of evaluations and relative change of squares.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..measurement.experiment import excerpt
from ..measurement.prepare import Prepared, prepare


@dataclass(frozen=True)
class SearchPlan:
    """Sizes of a search; `PLAN` are those in use. Larger ones take longer and miss less."""

    #: most effects that one diagnosis adds: each takes one ranking of the whole catalogue
    most_effects: int = 6
    #: samples of all records together above which effects are sought on windows: longer records
    #: tell no more of an effect, and a ranking takes time in proportion
    long: int = 200_000
    #: samples of the windows together
    windows: int = 60_000
    #: candidates that are followed where none is supported alone, for each may mask another: one
    #: ranking each. At each joint of an arm with more joints than that one is followed: a real arm
    #: always leaves more than noise, and with three, six joints took over twice the time
    beam: int = 3
    #: starts of an effect linear in its strength that are kept after the prediction by one linear
    #: step; of these one is kept after the first real steps. Of any other effect, of which one step
    #: says less, twice as many, and these after the first steps; of draws, twice as many, too
    followed: int = 2
    #: part of the force below which the strength of an effect that a new one needs counts as taken
    #: away. Of 30 simulated springs that slip late in a stroke, a bristle left 86 to 88 % of four
    #: from the usual starts, and leaves 9 to 15 % with the further ones; no error grew by 0.2 %
    taken_away: float = 0.2
    #: parts of a strength at which a search begins anew that ended above the model without the
    #: effect. Of nine simulated springs beside a bristle, six ended above it (up to 4.5 times its
    #: squares), one with the first two parts, none with three; two smaller ones changed nothing
    smaller: tuple[float, ...] = (0.3, 0.1, 0.03)
    #: the same where hidden states are corrected, or where parameters are more than starts: states
    #: may fall out of step, and squares are rugged. All are followed: the first steps from a good
    #: start may all fail (one search of a gap ended at 43 % with three, at 4 % with six; one of
    #: slipping springs at 6.5 % with two, at 2.5 % with four)
    wide: int = 6
    #: parts of the time by which a log may be late at which the user's model begins, too: 12 and
    #: 35 ms of 50. From none alone, a log late by 8 rows of 2 ms ended at one row
    late_starts: tuple[float, ...] = (0.25, 0.7)
    #: part by which a user's value may be wrong: what moved further may have been led astray, and
    #: starts from the user's value too
    moved: float = 0.25
    #: factors on each parameter of an effect with rugged squares, from which a better place is
    #: sought
    restart_factors: tuple[float, ...] = (0.85, 1.18)
    #: part of the squares that a sweep of such restarts must take away for another to follow
    restart_gain: float = 0.1
    #: part of the squares before that the best candidate leaves at least where nothing explains the
    #: records: there a gap is also sought among draws, and effects that are linear in no strength
    #: from the user's values. A lower limit searches more records twice
    unexplained: float = 0.1
    #: draws of the parameters of a gap, and evaluations that improve each of those followed. Of
    #: eight wide gaps four ended above 1.4 times the error of a fit from the true values, with 200
    #: draws one. A draw takes 5 ms on 6 s of records. 0: none
    draws: int = 200
    draw_evaluations: int = 60
    #: first step of a search without derivatives, in the logarithm of each value: a third of it
    simplex: float = 0.3
    #: factor by which draws go beyond the usual starts on both sides
    draws_beyond: float = 3.0
    #: squares on the fit records above the least that a rough fit leaves, as a part of these, up to
    #: which another candidate is fitted finely. A fine fit took away 2.7 % of what a rough one left
    #: at most, in 136 fits on simulated and real records, but for four: those of the candidates
    #: that led
    contending: float = 0.15
    #: turns of finding the force of a tone on one stretch
    tone_turns: int = 4
    #: turns of finding that force and estimating the model beside it
    tone_estimates: int = 2
    #: most models that one open question holds: an experiment separates each from the others
    rivals: int = 4

    @property
    def distinct_minimum(self) -> float:
        """Part of the squares by which two fits must differ to count as two places.

        Ten times what a rough fit leaves open.
        """
        return 10.0 * EFFORTS.rough.tolerance

    def for_joints(self, count: int) -> SearchPlan:
        """The plan for each joint of an arm with `count` joints.

        An arm's records are searched whole, so the plan has the default sizes of windows.
        """
        beam = self.beam if count <= self.beam else min(self.beam, 1)
        return replace(self, long=SearchPlan.long, windows=SearchPlan.windows, beam=beam)

    def omissions(self) -> tuple[str, ...]:
        """Parts of the search with `PLAN` that this plan leaves out, in words; empty: none."""
        words = []
        if self.most_effects < PLAN.most_effects:
            words.append(f"no more than {self.most_effects} effects were added")
        if self.beam == 0:
            words.append("pairs of effects that mask each other were not searched")
        elif self.beam < PLAN.beam:
            best = "the best candidate" if self.beam == 1 else f"the best {self.beam}"
            words.append(f"pairs of effects that mask each other were searched with {best} only")
        if self.long < PLAN.long:
            words.append(
                f"records of more than {self.long} samples were searched on {self.windows} samples "
                "in windows"
            )
        return tuple(words)


#: the sizes in use
PLAN = SearchPlan()
#: sizes of a quick first search. It may miss a weak effect, a third or later one, and two effects
#: that mask each other
QUICK = SearchPlan(
    most_effects=2,
    long=8_000,
    windows=8_000,
    beam=0,
    draws=0,
)


def cut_to_windows(whole: Prepared, plan: SearchPlan = PLAN) -> Prepared:
    """The windows of prepared records that are searched; the whole records where they are short."""
    if sum(len(r.time) for r in whole.experiment.records) <= plan.long:
        return whole
    return prepare(excerpt(whole.experiment, most=plan.windows), bandwidth=whole.bandwidth)


@dataclass(frozen=True)
class Effort:
    """When a fit ends: relative change of the sum of squares, and most evaluations."""

    tolerance: float
    evaluations: int


@dataclass(frozen=True)
class Efforts:
    """An effort for each purpose; `EFFORTS` are those in use. Less effort is faster."""

    #: a few real steps: enough to see which of many starts lead down
    first_steps: Effort = Effort(1e-3, 4)
    #: blocks that are held out in turn: each fit begins next to its optimum
    held_out: Effort = Effort(1e-3, 5)
    #: candidates before they are ranked: closer than they differ
    rough: Effort = Effort(1e-4, 12)
    #: candidates that were followed to the optimum on few samples: what all samples move is less
    #: than that; those that contend are fitted finely afterwards
    continued: Effort = Effort(1e-3, 6)
    #: readings of a simulated motion: closer than their spread
    again: Effort = Effort(1e-5, 12)
    #: what is reported: far below standard errors
    fine: Effort = Effort(1e-7, 60)
    #: residuals and derivatives alone: the values stay where they are
    evaluation: Effort = Effort(1.0, 1)


#: the efforts in use
EFFORTS = Efforts()
