"""Bounds of what adds or removes energy: viscous damping from below, the acting force from above.

Forces of velocity are added first: a damping that differs with the direction reduces the damping of
another force in one direction, and drag that grows with speed adds nothing at rest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body
from ..effects import SIGNALS, Effect, delayed, sort_by_action
from .extremes import Ranges
from .friction_interval import DIRECTION, SPEED, Interval, lowest_of, parameter_box, stays_within
from .reach import Reach, signal_ranges
from .simulated import without_absent


@dataclass(frozen=True)
class DampingInterval:
    """Viscous damping at its lowest, and the effects that may supply energy.

    least: force against the motion over speed, the least at any speed, N s/m; not below zero
    supplying: names of forces that may release energy
    """

    least: Interval
    supplying: tuple[str, ...]


def damping_interval(body: Body, reach: Reach | None = None, *, errors: float) -> DampingInterval:
    """Damping of all forces of a body without hidden states, and the forces that may supply energy.

    A force that is not declared to store or dissipate supplies none where all counted forces
    together dissipate, for all parameters within `errors` standard errors.
    """
    body = without_absent(body, surely=True)
    forces = [e for e in body.effects if e.role == "force" and e.energy != "stores"]
    plain = [e for e in forces if not e.states]
    open_ones = [e for e in forces if e.energy == "supplies"]
    for counted in (
        [e for e in plain if least_damping(body, [e], reach, errors)],
        [e for e in plain if e.energy == "dissipates"],
    ):
        least = least_damping(body, counted, reach, errors)
        if least is not None and least.low >= 0:
            left = tuple(e.name for e in open_ones if e not in counted)
            return DampingInterval(least, left)
    return DampingInterval(Interval(0.0, 0.0, 0.0), tuple(e.name for e in open_ones))


def small_motion_damping(body: Body, *, errors: float) -> float:
    """Least damping in small motion, N s/m: of forces, and of friction before it slides."""
    damping = damping_interval(body, errors=errors).least.low
    for effect in body.effects:
        if effect.role == "friction_shape":
            at_rest = effect.expression().subs(dict.fromkeys(effect.state_symbols().values(), 0))
            slope = sp.diff(at_rest, SIGNALS["velocity"])
            damping += max(lowest_of(body, slope, None, errors=errors)[0].low, 0.0)
    return damping


def least_damping(
    body: Body, effects: Sequence[Effect], reach: Reach | None, errors: float
) -> Interval | None:
    """The least damping of these forces together at any speed, N s/m; None: no bound is known."""
    try:
        force = sum((e.expression() for e in effects), sp.S(0))
        against = DIRECTION * force.subs(SIGNALS["velocity"], DIRECTION * SPEED)
        law = sp.expand(against / SPEED)
        lowest, _ = lowest_of(body, law, reach, errors=errors)
    except ModelError:
        return None
    return lowest if math.isfinite(lowest.low) else None


def largest_acting_force(
    body: Body, command: float, reach: Reach | None = None, *, errors: float
) -> float:
    """Upper bound of abs(acting force), N, under any command of at most this size (N), also late.

    errors: range of the parameters to either side, in standard errors
    returns: inf where no bound is known
    """
    body = without_absent(body, surely=True)
    box = signal_ranges(reach) | parameter_box(body, errors=errors)
    largest = command
    for effect in sort_by_action(body.effects, "actuation"):
        law, states = effect.expression(), effect.state_symbols().values()
        # states of a stage lie in the range of the command
        within = dict.fromkeys((SIGNALS["command"], *states), (-largest, largest))

        def largest_of(signal: sp.Expr, within: Ranges = within) -> float:
            ends = (
                lowest_of(body, way * signal, reach, errors=errors, ranges=within)[0].low
                for way in (1, -1)
            )
            return max(map(abs, ends))

        try:
            if not all(stays_within(effect, s, box | within) for s in states):
                return math.inf
            # a delayed signal is another value of its range
            while earlier := law.atoms(delayed):  # the innermost first
                one = min(earlier, key=lambda x: (sp.count_ops(x), str(x)))
                size, late = largest_of(one.args[0]), sp.Dummy(real=True)
                law, within = law.subs(one, late), {**within, late: (-size, size)}
            largest = largest_of(law, within)
        except ModelError:
            return math.inf
    return largest
