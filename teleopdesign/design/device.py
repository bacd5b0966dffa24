"""The device that a design is for: an identified body within its errors, in its recorded reach.

Every number of it that keeps a control law safe is the unfavourable end of its interval.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body, compose_equation
from ..controllers import why_not_cancelled
from ..effects import SIGNALS, Effect
from ..realise.damping_interval import largest_acting_force, small_motion_damping
from ..realise.friction_interval import FrictionInterval, friction_interval, lowest_of
from ..realise.lti import S
from ..realise.reach import Reach
from ..simulate import Sampling
from .assumptions import Assumptions, StatedMotion, sampling_of, stated_motion

#: load of a hand over the inertia of the device, if no load is stated
LOAD = 3.0
#: bandwidth of the velocity filter if none is stated: the smaller of FILTER (Hz) and FILTER_SHARE
#: times the sample rate
FILTER, FILTER_SHARE = 50.0, 0.1


@dataclass(frozen=True)
class Device:
    """A body with the reach of its records, and the assumptions of its design."""

    body: Body
    reach: Reach
    stated: Assumptions

    @cached_property
    def assumptions(self) -> Assumptions:
        """The stated assumptions, with missing ones derived from the record and the body."""
        stated = self.stated
        period = stated.sample_period or self.reach.sample_period
        return replace(
            stated,
            sample_period=period,
            delay=period if stated.delay is None else stated.delay,
            velocity_bandwidth=stated.velocity_bandwidth or min(FILTER, FILTER_SHARE / period),
            load=self.load,
        )

    @cached_property
    def sampling(self) -> Sampling:
        """Sampling of its controllers in simulation."""
        return sampling_of(self.assumptions, self.reach)

    @cached_property
    def motion(self) -> StatedMotion:
        """The motion for which its compensation is predicted."""
        return stated_motion(self.reach, self.assumptions, self.body.axis)

    @cached_property
    def inertia(self) -> float:
        """Inertia, including the part behind a compliance or gap, kg or kg m^2."""
        body = self.body
        for effect in [e for e in body.effects if e.role == "structure"]:
            body = body.without_effect(effect.name)
        return float(body.equation().inertia.subs(body.numbers()))

    @property
    def load(self) -> float:
        """Inertia that stands for the hand, kg or kg m^2."""
        return self.stated.load or float(f"{LOAD * self.inertia:.2g}")

    @cached_property
    def friction(self) -> FrictionInterval | None:
        """The range of its friction level; None where it has no friction."""
        return friction_interval(self.body, self.reach, errors=self.stated.errors)

    @cached_property
    def damping(self) -> float:
        """Least damping in small motion, N s/m or N m s/rad."""
        return small_motion_damping(self.body, errors=self.stated.errors)

    @cached_property
    def delay(self) -> float:
        """Computing delay plus the delay of the identified actuation, s."""
        assert self.assumptions.delay is not None
        return self.assumptions.delay + identified_delay(self.body)

    @property
    def held_delay(self) -> float:
        """The delay, and one sample for which a command is held, s."""
        return self.delay + self.sampling.period

    @cached_property
    def gain(self) -> float:
        """Upper bound of the acting force per commanded force, with its gains divided out by C.

        raises ModelError: no bound is known for an effect of the actuation
        """
        rest, ratio = self._with_gains_divided_out()
        return ratio * acting_gain(rest, self.reach, errors=self.stated.errors)

    def _with_gains_divided_out(self) -> tuple[Body, float]:
        """The body without the gains that C divides out, their largest ratio to the estimates."""
        body = self.body
        stages = tuple(e for e in body.effects if e.role == "actuation" and self.cancels(e))
        if not stages:
            return body, 1.0
        gain = compose_equation(stages).acting / SIGNALS["command"]
        ratio = sp.simplify(gain / gain.subs(body.numbers()))
        least = self.least(-ratio)
        for effect in stages:
            body = body.without_effect(effect.name)
        return body, -least

    def least(self, law: sp.Expr, body: Body | None = None) -> float:
        """The least that a law of the body takes within reach and errors; body: of its symbols.

        raises ModelError: no bound is known
        """
        interval, _ = lowest_of(body or self.body, law, self.reach, errors=self.stated.errors)
        return interval.low

    def cancels(self, effect: Effect) -> bool:
        """Whether C makes up for a force or a gain of the actuator, by the law of the effect."""
        stores = effect.role == "force" and effect.energy == "stores"
        return (stores or effect.role == "actuation") and not self.why_not(effect)

    def why_not(self, effect: Effect) -> str:
        """Why no law cancels an effect of the body; "": one does."""
        numbers = {n: self.body.parameters[f"{effect.name}.{n}"].value for n in effect.parameters}
        return why_not_cancelled(effect, [n for n, value in numbers.items() if value])


def acting_gain(body: Body, reach: Reach, *, errors: float) -> float:
    """Upper bound of the acting force per commanded force, over the intervals of the parameters.

    raises ModelError: no bound is known for an effect of the actuation
    """
    # a small one: saturation only takes from it; any, where the motor was off
    command = 1e-3 * (reach.command or 1.0)
    gain = largest_acting_force(body, command, reach, errors=errors) / command
    if not math.isfinite(gain):
        raise ModelError("design: no bound is known of the force that the actuation makes")
    return gain


def identified_delay(body: Body) -> float:
    """Delay at low frequency of the body's identified actuation (dead time and lag), s."""
    form, _ = body.actuation(S)
    form = sp.sympify(form, strict=True).subs(body.numbers())
    return float(sp.limit(-sp.diff(form, S) / form, S, 0))
