"""Bounds of an identified device for claims of passivity: friction, stiffness and damping."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import sympy as sp

from ..base.errors import ModelError
from ..base.frozen import Frozen
from ..base.units import unit_of
from ..blocks import NINETY_FIVE, Body
from ..effects import Effect
from ..realise.damping_interval import damping_interval, largest_acting_force
from ..realise.friction_cells import FrictionCells
from ..realise.friction_interval import (
    SPEED,
    FrictionInterval,
    Interval,
    friction_interval,
    lowest_of,
    value_interval,
)
from ..realise.reach import ANY_MOTION, Reach
from ..realise.simulated import without_absent
from .claims.claim import Claim, Unknown, use_units_of
from .declarations import is_shipped, underived_energy

#: digits of a measured number in a claim. A standard error is rarely known to more than two digits,
#: and an estimate to more than three or four. Rounding outward to four digits costs a thousandth of
#: a level at most
DIGITS = 4
#: roles of effects that change the friction level: the interval of the level covers them
_LEVEL = ("friction_level", "friction_factor", "friction_speed")


@dataclass(frozen=True)
class Basis:
    """What limits of an identified device rest on: the diagnosis that it comes from.

    verdict: of the diagnosis;  left: what its model leaves, in noise floors
    is_adequate: whether this counts as noise
    cells: friction that model and residual show together; None: the answer does not say it
    """

    verdict: str
    left: float
    is_adequate: bool
    cells: FrictionCells | None = None

    @property
    def bound(self) -> float | None:
        """Least friction that the residual leaves, N or N m; None: it sets, or shows, no bound."""
        if self.is_adequate or self.cells is None or not self.cells.covered:
            return None
        return self.cells.least

    @property
    def is_open(self) -> bool:
        """Whether more than noise is left, and nothing bounds the friction with it."""
        return not self.is_adequate and self.bound is None

    def sentence(self, axis: str) -> str:
        """What the limits rest on, in words."""
        left = f"{self.left:.3g} noise floors left"
        if self.is_adequate:
            return f"the limits rest on a model whose error is noise ({left})"
        answer = {"undecided": "an undecided answer"}.get(self.verdict, "an incomplete model")
        start = f"the limits rest on {answer} with unexplained force ({left})"
        if self.cells is None:
            return f"{start}, which says nothing of the friction by place: none is certain"
        covered, count = len(self.cells.covered), len(self.cells.cells)
        if not covered:
            return f"{start}, with too few samples in all {count} cells: none is certain"
        open_ = self.cells.left_open(unit_of("position", axis))
        rest = f"; not covered: {open_}" if open_ else ""
        return (
            f"{start}: on the friction with it in {covered} of {count} cells of position and "
            f"direction{rest}"
        )


@dataclass(frozen=True)
class IdentifiedDevice:
    """Friction of an identified device, as bounds for claims of passivity.

    reach: range of the motions in the claims; None: every motion
    lowest, highest: friction level that can occur over the reach and the 95 % intervals, N or N m
    presliding: stiffness of friction before it slides, N/m or N m/rad; None for ideal friction
    over: the reach in words
    least_resistance: least force of friction level and viscous damping together at any speed, N
    damping: damping that is present at every speed, N s/m; 0 where the model has none
    bristle_damping: damping of friction before it slides, N s/m; 0 where the model has none
    left_open: effects that may supply energy, or that no theorem covers -> what could not be
        derived of them, "" where they declare nothing
    unknown: names of parameters without a standard error
    basis: the diagnosis that the bounds rest on; None: the values are taken as they are
    """

    body: Body
    reach: Reach | None
    lowest: Interval
    highest: Interval
    presliding: Interval | None
    over: str
    least_resistance: Interval
    damping: Interval
    bristle_damping: Interval
    left_open: Mapping[str, str]
    unknown: tuple[str, ...]
    basis: Basis | None = None

    @property
    def set_aside(self) -> tuple[str, ...]:
        """Names of effects that may supply energy, or that no theorem covers."""
        return tuple(self.left_open)

    @property
    def actuation(self) -> tuple[str, ...]:
        """Names of effects of the actuation, between a command and the acting force."""
        return tuple(e.name for e in self.body.effects if e.role == "actuation")

    def acting_force(self, command: float) -> float:
        """Largest acting force, N, for commands up to this size (N), in the 95 % intervals.

        inf where no bound is known.
        """
        return largest_acting_force(self.body, command, self.reach, errors=NINETY_FIVE)

    def unit(self, quantity: str) -> str:
        """Unit of a quantity on the axis of the device."""
        return unit_of(quantity, self.body.axis)


def identify_device(
    body: Body, reach: Reach | None = None, basis: Basis | None = None
) -> IdentifiedDevice:
    """Bounds of friction level, presliding stiffness and damping of a body, in 95 % intervals.

    reach: range of the motions in the claims; None: every motion
    basis: the diagnosis of the body. Where its model leaves more than noise, the lowest level is at
        most the friction that the residual shows too, and holds in the cells that it covers
    raises ModelError: a body without friction, or with a friction level that may be zero, or with
        friction that deflects before it slides and a level without an upper bound
    """
    body = without_absent(body, surely=True)
    friction = _friction_of(body, reach, basis)
    damping = damping_interval(body, reach, errors=NINETY_FIVE)
    bristle = body.parameters.get("presliding.bristle_damping")
    bristles = Interval(0.0, 0.0, 0.0)
    if bristle is not None:
        bristles = value_interval(bristle, errors=NINETY_FIVE)
    # of friction level and damping together at any speed
    at_estimate, at_low = (
        lowest_of(body, body.level() + sp.Float(b) * SPEED, reach, errors=NINETY_FIVE)[0]
        for b in (damping.least.estimate, damping.least.low)
    )
    resistance = Interval(at_estimate.estimate, at_low.low, at_estimate.high)
    left_open = dict(effects_left_open(body, reach, errors=NINETY_FIVE))
    if basis is not None and not basis.is_adequate:
        resistance = replace(resistance, low=min(resistance.low, friction.lowest.low))
        if basis.is_open or friction.presliding is not None:
            left_open["what the diagnosis leaves unexplained"] = ""
    return IdentifiedDevice(
        body,
        reach,
        friction.lowest.round_outward(digits=DIGITS),
        friction.highest.round_outward(digits=DIGITS),
        friction.presliding and friction.presliding.round_outward(digits=DIGITS),
        friction.over,
        resistance.round_outward(digits=DIGITS),
        damping.least.round_outward(digits=DIGITS),
        bristles.round_outward(digits=DIGITS),
        left_open,
        tuple(
            n
            for n, v in body.parameters.items()
            if not v.fixed
            and math.isnan(v.stderr)
            and not (v.value == 0 and body.parameter(n).optional)  # one that is not there
        ),
        basis,
    )


def _friction_of(body: Body, reach: Reach | None, basis: Basis | None) -> FrictionInterval:
    """The friction that a claim may rest on;  raises ModelError: as `identify_device`."""
    friction = friction_interval(body, reach, errors=NINETY_FIVE)
    if friction is None:
        raise ModelError("passivity: the device has no friction to compensate")
    if basis is not None and basis.bound is not None:
        lowest = Interval(*(min(x, basis.bound) for x in vars(friction.lowest).values()))
        over = "" if friction.over == ANY_MOTION else f"{friction.over}, "
        over = f"{over}the cells that the residual covers"
        friction = replace(friction, lowest=lowest, over=over)
    if friction.lowest.low <= 0:
        raise ModelError(
            f"passivity: the friction level may be as low as {friction.lowest.low:.3g} "
            f"{unit_of('force', body.axis)} within its 95 % interval (at {friction.where_lowest}): "
            "nothing can be compensated for certain"
        )
    if friction.presliding is not None and math.isinf(friction.highest.high):
        raise ModelError(
            f"passivity: no upper bound of the friction level over {friction.over}: friction that "
            "gives before it slides needs one; give the experiment whose records say how far"
        )
    return friction


def effects_left_open(
    body: Body, reach: Reach | None = None, *, errors: float
) -> Mapping[str, str]:
    """Effects that may supply energy, or that no theorem on friction covers -> why, or "".

    They include a user's effects that declare to supply no energy, where this could not be derived.

    reach: range of the motions in the claims; None: every motion
    errors: standard errors of the parameters to either side
    """
    body = without_absent(body, surely=True)
    supplying = damping_interval(body, reach, errors=errors).supplying
    left = (*(e.name for e in body.effects if _is_open(e)), *supplying)
    return Frozen(dict.fromkeys(left, "") | underived_energy(body, reach, errors=errors))


def extend_to_device(claim: Claim, *, over: str, left: Mapping[str, str]) -> Claim:
    """A claim about friction, restated for the whole device.

    If the device has an effect that may supply energy, a claim that holds for friction alone
    becomes unknown.

    over: reach of the motions, `FrictionInterval.over`
    left: effects that the claim does not cover -> what could not be derived of them, or ""
    """
    if over != ANY_MOTION:
        claim = replace(claim, statement=f"{claim.statement} (levels over {over})")
    if not left or not claim.holds:
        return claim
    why = f"holds for friction alone, {claim.verdict}; but {', '.join(left)} may supply energy, or "
    why += "are in no theorem"
    for name, step in left.items():
        why += f"; {name} declares to supply none, which does not follow: {step}" if step else ""
    return Claim(claim.statement, Unknown(why))


def restate_for_device(
    device: IdentifiedDevice, claim: Claim, *, besides: Sequence[str] = ()
) -> Claim:
    """A claim about friction, restated for the whole device and in the units of its axis.

    besides: names of further effects that the theorem of this claim covers
    """
    left = {name: why for name, why in device.left_open.items() if name not in besides}
    claim = use_units_of(device.body.axis, claim)
    return extend_to_device(claim, over=device.over, left=left)


def _is_open(effect: Effect) -> bool:
    """Whether no theorem covers an effect; `damping_interval` judges forces."""
    if effect.role == "friction_shape":
        return effect.name != "presliding" or not is_shipped(effect)
    if effect.role in (*_LEVEL, "force"):
        return False
    return effect.energy == "supplies"
