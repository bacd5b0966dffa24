"""Facts of the records about a body, with which an effect checks its parameters.

An effect deserves its name only if its parameters fit the name: a period must repeat in the
records, a bristle must deflect within the travel. The file of each effect states its rules as
`plausible(p, facts)`: None, or one sentence on what the values stand for instead.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.units import unit_of

Array = NDArray[np.float64]

#: number of classes of equal size into which samples are sorted by speed, and fewest samples in
#: each
SPEEDS, SAMPLES = 40, 10
#: a pattern over the place counts if at least this share of its variance is no function of the
#: speed. A sine of one amplitude has almost no such share, two amplitudes over one path 0.2 and
#: more. A lower limit takes friction of the speed for friction of the place; with a higher one,
#: sweeps that hardly differ in speed show nothing
APART = 0.1
#: share of the sliding samples that are the slowest ones: friction below their speeds counts as not
#: measured, because they are near turning points
SELDOM = 0.01
#: correlation of a friction level with the size of the gravity torque, over the places, from which
#: the two look alike: half a sine wave over a quarter turn to each side reaches 0.97. A lower limit
#: would also name uneven rails
ALIKE = 0.9
#: travel over period from which a pattern is seen to repeat: at one and a half, half of the period
#: occurs twice. With less travel, any slow force of the position fits; a higher limit would exclude
#: long true periods
REPEATS = 1.5
#: reversals from which a loop of hysteresis closes: at the second one the body has come and gone
LOOP = 2
#: steps of the readings in the shortest period that they can show: two, as for any sampled signal
READ = 2.0
#: a function of the place whose deviation from a straight line is below this part of its variation
#: is hardly distinguished from a line: models of real machines leave about as much. A higher limit
#: would also doubt functions that bend
STRAIGHT = 0.1
#: part of an extra level at rest that must act at the slowest motion that the readings show, unless
#: a rest shows this level: less is no more than the errors of a model
VISIBLE = 0.05


@dataclass(frozen=True)
class RecordFacts:
    """Facts of the records of an experiment about one body (SI, on its axis).

    travel: range of its positions over all records
    sweep: largest range in one stretch of a record: hidden states, such as the deflection of a
        bristle, begin anew at each stretch
    step: of the position readings
    stroke: mean time of motion between two reversals (s); inf: the motion never reverses
    reversals: of all stretches together
    force: largest size of the measured force, actuator and interaction together
    acting: `force` plus the largest force of the inertia and of an arm's links: no sensor measures
        the forces on a body that swings or coasts
    speed: largest speed;  film: friction (N or N m) at that speed by dissipating effects of the
        body that depend on the velocity alone, such as `viscous`
    levels: computes the friction levels (n,) in N or N m where the body slides, by all effects
        that make one; none: that of `coulomb` alone
    body: its other numbers by their names, such as "inertia" and "coulomb.level"
    duration: of the longest record (s)
    stuck: longest time (s) in which more than the Coulomb level acts and the body does not surely
        move;  resolved: shortest time (s) of a change that the bandwidth of the comparison shows
    places, speeds: (n,) of the samples in which the body slides, over all records
    """

    axis: str
    travel: float
    sweep: float
    step: float
    stroke: float
    force: float
    speed: float
    film: float
    body: Mapping[str, float]
    levels: Callable[[], Array] = lambda: np.zeros(0)
    duration: float = float("inf")
    acting: float = float("inf")
    stuck: float = float("inf")
    resolved: float = 0.0
    reversals: float = float("inf")
    places: Array = field(default_factory=lambda: np.zeros(0))
    speeds: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def friction(self) -> float:
        """The usual friction level (N or N m) where the body slides, whatever effects make it."""
        levels = self.levels()
        return float(np.median(levels)) if len(levels) else self.body["coulomb.level"]

    @property
    def slowest(self) -> float:
        """Speed below which a hundredth of the samples slide; 0 without samples."""
        return float(np.quantile(np.abs(self.speeds), SELDOM)) if len(self.speeds) else 0.0

    def apart_from_speed(self, pattern: Callable[[Array], Array]) -> float:
        """Share of the variance of a function of the position that is no function of the speed.

        Near 0: each position was passed at one speed, as by a single sine; 1: too few samples
        """
        if len(self.places) < SPEEDS * SAMPLES:
            return 1.0
        values = pattern(self.places)
        order = np.argsort(np.abs(self.speeds), kind="stable")
        groups = np.array_split(values[order], SPEEDS)
        within = sum(len(g) * float(np.var(g)) for g in groups)
        whole = len(values) * float(np.var(values))
        return within / whole if whole > 0.0 else 1.0

    def visible_way(self, period: float) -> float:
        """Longest way (m or rad) without a gap that the body slides while this period is visible.

        At a higher speed, a pattern of this period changes faster than the bandwidth of the
        comparison shows. Places of more than half a period apart leave a gap.
        """
        slow = np.sort(self.places[2.0 * self.resolved * np.abs(self.speeds) <= abs(period)])
        if not len(slow):
            return 0.0
        ways = np.split(slow, 1 + np.flatnonzero(np.diff(slow) > abs(period) / READ))
        return max(float(way[-1] - way[0]) for way in ways)

    def bend(self, pattern: Callable[[Array], Array]) -> float:
        """Share (rms) of the variation of a function of the position that a straight line lacks.

        1 without samples or travel
        """
        if len(self.places) < 3 or not np.ptp(self.places) > 0.0:
            return 1.0
        values = pattern(self.places)
        line = np.polynomial.Polynomial.fit(self.places, values, 1)
        return float(np.std(values - line(self.places)) / np.std(values))

    def text(self, value: float, quantity: str) -> str:
        """A value of this quantity (SI) with its unit on the body's axis."""
        return f"{value:.3g} {unit_of(quantity, self.axis)}"


def level_at_rest_is_observable(extra: float, there: float, facts: RecordFacts) -> str | None:
    """A sentence where only passing reversals show an extra level of friction at rest; else None.

    extra: N or N m at rest;  there: what is left of it at the slowest motion
    Between two rows of opposite directions, friction of a larger level balances more of any error.
    """
    if there > VISIBLE * extra or facts.stuck > facts.resolved:
        return None
    return (
        f"its extra friction acts below {facts.text(facts.slowest, 'velocity')}, the slowest "
        "motion that the readings show, and more than the Coulomb level holds the body for no "
        f"longer than {facts.stuck:.2g} s, where changes of {facts.resolved:.2g} s are resolved: "
        "the effect imitates an error in the time of the force at reversals"
    )


def level_at_rest_was_reached(extra: float, there: float, facts: RecordFacts) -> str | None:
    """A sentence where no measured force reached the friction at rest, extra level and all.

    extra, there: as in `level_at_rest_is_observable`;  returns: None where one did
    """
    at_rest = facts.body["coulomb.level"] + extra
    if at_rest <= facts.force:
        return None
    return (
        f"friction of {facts.text(at_rest, 'force')} at rest exceeds all measured forces, "
        f"{facts.text(facts.force, 'force')}: the level at rest and v_S are not determined; "
        f"only the fall from {facts.text(there, 'force')} extra at the slowest motion, "
        f"{facts.text(facts.slowest, 'velocity')}, is known"
    )


def slip_is_observable(subject: str, ways: Sequence[float], facts: RecordFacts) -> str | None:
    """A sentence where no deflection before sliding can be read from the records; else None.

    subject: name of the part in the sentence;  ways: deflections before sliding (m, rad)
    """
    if facts.stroke == float("inf"):
        return (
            f"{subject} deflects once only where the motion never reverses: the record shows no "
            "loop, and the effect imitates the beginning of friction in a record"
        )
    if facts.reversals < LOOP:
        return (
            f"{subject} deflects back once only where the motion reverses once: no loop closes, "
            "and the effect imitates a force of the position"
        )
    # a deflection of less than half a step is never read
    if any(0.5 * facts.step < way < facts.sweep for way in ways):
        return None
    if max(ways, default=0.0) >= facts.sweep:
        within = facts.text(facts.sweep, "position")
        return f"{subject} never slips within the travel of {within}: the effect imitates a spring"
    step = facts.text(facts.step, "position")
    return (
        f"{subject} deflects less than steps of {step} can show: the effect imitates sgn friction"
    )


def speeds_vary_by_place(pattern: Callable[[Array], Array], facts: RecordFacts) -> str | None:
    """A sentence where the records do not separate a function of position from one of speed."""
    if facts.apart_from_speed(pattern) >= APART:
        return None
    return (
        "the motion passed each position at one speed only, so variation along the travel may be "
        "variation with speed: the effect imitates friction that depends on the speed"
    )


def period_is_visible(period: float, facts: RecordFacts) -> str | None:
    """A sentence where a pattern is seen only at places that are passed slowly; None: it repeats.

    A body is slow near its turning points, again and again, and so is friction of the speed.
    """
    way = facts.visible_way(period)
    if way >= REPEATS * abs(period) or way >= facts.visible_way(float("inf")):
        return None
    return (
        f"a period of {facts.text(abs(period), 'position')} lasts less than "
        f"{2.0 * facts.resolved:.2g} s, which the bandwidth hides, except along "
        f"{facts.text(way, 'position')}: it is not seen to repeat, and the effect imitates "
        "friction that depends on the speed"
    )


def follows_gravity(level: Callable[[Array], Array], facts: RecordFacts) -> str | None:
    """A sentence on friction that is largest where the torque of gravity is; None: it is not."""
    if "gravity.phase" not in facts.body or len(facts.places) < 3:
        return None
    load = np.abs(np.sin(facts.places + facts.body["gravity.phase"]))
    levels = level(facts.places)
    if not (np.ptp(load) > 0.0 and np.ptp(levels) > 0.0):
        return None
    if not np.corrcoef(load, levels)[0, 1] >= ALIKE:
        return None
    return (
        "friction is largest where the torque of gravity is largest: friction that grows with the "
        "load (load_dependent_friction) looks much the same. A record with another load decides"
    )


def repeats_within_travel(p: Any, facts: RecordFacts) -> str | None:
    """A sentence where no period is seen to repeat within the travel; None where it is.

    p: parameters with `period` (m or rad);  for an effect's `plausible`
    """
    period = facts.text(abs(p.period), "position")
    if abs(p.period) < READ * facts.step:
        return (
            f"a period of {period} is shorter than steps of {facts.text(facts.step, 'position')} "
            "can show: the effect imitates errors of the readings"
        )
    if facts.travel >= REPEATS * abs(p.period):
        return period_is_visible(p.period, facts)
    return (
        f"a period of {period} does not repeat within the travel of "
        f"{facts.text(facts.travel, 'position')}: the effect imitates something else that varies "
        "slowly along the travel, such as gravity, a spring or friction that varies"
    )
