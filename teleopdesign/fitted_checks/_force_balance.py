"""Scale, sign and timing of each force, from the balance of all forces along the motion.

    lead(t + shift) + gain other(t + shift') = sum of strength_j column_j + rest of the model

This is solved by linear least squares, without bounds, on the rows where the body surely moves.
`lead` is the actuator force (the interaction force where nothing is commanded). The columns are the
tangents of the user's model by its inertia and by every strength in which its force is linear, and
a constant force where the model has none. A force with the wrong sign gives a negative gain, a
motion with the wrong sign negative strengths, and a wrong unit a strength that is wrong by its
factor. Shifts come from the forces' derivatives, solved again at each shift, first at low
frequency, where a period is long.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..blocks import Body
from ..diagnose.criteria import CRITERIA
from ..diagnose.fit import block_numbers, standard_errors
from ..effects import EFFECTS
from ..measurement.filtering import Array
from ..measurement.first_guess import SURELY_LESS, least_squares
from ..measurement.limits import HALF
from ..measurement.prepare import Prepared, Stretch
from ..model import Model
from ._force_timing import (
    BANDS,
    ON_TIME,
    BalanceFit,
    BandTransforms,
    fit_balance,
    rows_of,
    sum_of_forces,
    transform_in_band,
    with_shifts,
)

#: fewest rows for any finding; least size of a force, relative to the largest one, to be present
FEWEST, LEAST = 50, 1e-5
#: effects whose force depends on position alone, by axis
PLACE = {"prismatic": ("spring",), "revolute": ("spring", "gravity")}


@dataclass(frozen=True)
class Estimate:
    """A number with its standard error."""

    value: float
    error: float

    @property
    def sure(self) -> int:
        """Sign of an estimate that differs from zero by five standard errors, else 0."""
        return int(np.sign(self.value)) if abs(self.value) > 5.0 * self.error else 0


@dataclass(frozen=True)
class ForceBalance:
    """The balance of the forces on one body.

    lead: channel that the other forces balance;  other: the second measured force, or ""
    gain: of the other force, 1 where its scale and sign are right, and 1 where there is none
    strengths: "inertia", "coulomb.level" ... -> estimate (SI)
    power: mean power (W) of the inertia, and of each strength that always dissipates
    shifts: "actuator_force", "interaction_force" -> s by which its log lags the motion; "position"
        -> s by which the position's log lags, where one common shift explains the rest; empty: no
        shift
    left, unshifted: residual over measured force (rms), with and without the shifts
    """

    body: str
    lead: str
    other: str
    gain: Estimate
    strengths: Mapping[str, Estimate]
    power: Mapping[str, Estimate]
    shifts: Mapping[str, Estimate]
    left: float
    unshifted: float


def strengths_of(body: Body) -> list[str]:
    """The inertia, and the parameters at whose zero an effect has no force."""
    names = ["inertia"]
    for effect in body.effects:
        if effect.role in ("force", "friction_level"):
            names += [f"{effect.name}.{p}" for p, zero in effect.absent.items() if zero == 0.0]
    return [n for n in names if n in body.parameters]


def force_balance(
    body: Body, stretches: Sequence[Stretch], *, timed: bool = True
) -> ForceBalance | None:
    """The balance of one body; None where it hardly moves or no force is measured.

    A constant force that the model lacks, such as a weight of many times the friction, would give
    friction the wrong sign. Likewise, the gravity of a pendulum would give its inertia the wrong
    sign. So a bias is always added, and a force of position where it removes most of the residual.

    stretches: of this body;  timed: whether shifts are estimated
    """
    stated = strengths_of(body)
    body = _with_lacking(body, ["bias"])
    plain = _balance_of(body, stated, stretches, timed=timed)
    if plain is None or any(body.has(n) for n in PLACE["revolute"]):
        return plain
    there = _balance_of(_with_lacking(body, PLACE[body.axis]), stated, stretches, timed=timed)
    if there is not None and there.left**2 < (1.0 - CRITERIA.mostly) * plain.left**2:
        return there
    return plain


def _with_lacking(body: Body, names: Sequence[str]) -> Body:
    """The body with all of these effects."""
    for name in names:
        body = body if body.has(name) else body.with_effect(EFFECTS[name])
    return body


def _balance_of(
    body: Body, stated: Sequence[str], stretches: Sequence[Stretch], *, timed: bool
) -> ForceBalance | None:
    """The balance of a body;  stated: names of strengths that the user's model has."""
    names = [*stated, *(n for n in strengths_of(body) if n not in stated)]
    bands = {
        b: [transform_in_band(body, s, names, b) for s in stretches]
        for b in dict.fromkeys(BANDS if timed else (1.0,))
    }
    parts = bands[1.0]
    if sum(len(p.keep) for p in parts) < FEWEST:
        return None
    rows = rows_of(parts, ON_TIME)
    size = dict(zip(ON_TIME, np.sqrt(np.mean(rows[:2] ** 2, axis=1)).tolist(), strict=True))
    forces = [n for n in ON_TIME if size[n] > LEAST * max(size.values())]
    if not forces:
        return None
    measured = float(np.sqrt(np.mean((rows[0] + rows[1]) ** 2)))
    plain = fit_balance(bands, forces, [], ON_TIME, BANDS[-1:])
    law = _left_of_law(rows)
    if len(forces) > 1 and law < HALF * size[forces[0]] and not plain.size < SURELY_LESS * law:
        # one force is computed from the other, so that the motion tells no gain: their sum counts
        bands = {b: [sum_of_forces(p) for p in parts] for b, parts in bands.items()}
        forces = forces[:1]
        plain = fit_balance(bands, forces, [], ON_TIME, BANDS[-1:])
    fit = plain
    if timed:
        fit = with_shifts(bands, forces, plain, measured)
    numbers = np.unique(_blocks(stretches, parts), return_inverse=True)[1]
    errors = standard_errors(fit.jacobian, fit.left, numbers)
    estimates = [Estimate(float(v), float(e)) for v, e in zip(fit.solution, errors, strict=True)]
    strengths = dict(zip(names, estimates, strict=False))
    power = _power(parts, fit.rows[5:], strengths)
    both = len(forces) > 1
    return ForceBalance(
        body=stretches[0].motion.body,
        lead=forces[0],
        other=forces[1] if both else "",
        gain=estimates[len(names)] if both else Estimate(1.0, 0.0),
        strengths={n: strengths[n] for n in stated},
        power={n: power[n] for n in stated if n == "inertia" or _brakes(body, n)},
        shifts=_name_shifts(fit, estimates[len(names) + both :]),
        left=fit.size / measured,
        unshifted=plain.size / measured,
    )


def _left_of_law(rows: Array) -> float:
    """Rms that a law of the second force and its rate leaves of the first one; rows: `rows_of`."""
    law = np.stack([rows[1], rows[3], np.ones(rows.shape[1])])
    return least_squares(law, rows[0], 1.0)[2]  # in any unit of time: its errors do not count


def _brakes(body: Body, strength: str) -> bool:
    """Whether a strength is that of an effect that always dissipates."""
    return body.effect(strength.partition(".")[0]).energy == "dissipates"


def force_balances(
    model: Model, prepared: Prepared, *, timed: bool = True, use: str = "fit"
) -> dict[str, ForceBalance]:
    """The balance of every body that has one, on the records of this use."""
    balances = {}
    for place, body in model.bodies.items():
        stretches = [s for s in prepared.of(use) if s.motion.body == place]
        balance = force_balance(body, stretches, timed=timed) if stretches else None
        if balance is not None:
            balances[place] = balance
    return balances


def _name_shifts(fit: BalanceFit, steps: Sequence[Estimate]) -> dict[str, Estimate]:
    """The shifts by channel; a shift of both forces is the position's, with opposite sign."""
    shifts: dict[str, Estimate] = {}
    for group, step in zip(fit.groups, steps, strict=True):
        late = fit.shifts[group[0]]
        if len(group) > 1:
            shifts["position"] = Estimate(-late, step.error)
        else:
            shifts[group[0]] = Estimate(late, step.error)
    return shifts


def _blocks(stretches: Sequence[Stretch], parts: Sequence[BandTransforms]) -> NDArray[np.intp]:
    is_part = [np.isin(s.keep, p.keep) for s, p in zip(stretches, parts, strict=True)]
    return block_numbers(stretches)[np.concatenate(is_part)]


def _power(
    parts: Sequence[BandTransforms], columns: Array, strengths: Mapping[str, Estimate]
) -> dict[str, Estimate]:
    """Mean power (W) that each strength dissipates in the motion."""
    velocity = np.concatenate([p.motion.velocity[p.keep] for p in parts])
    mean = columns @ velocity / len(velocity)
    return {
        n: Estimate(e.value * float(m), e.error * abs(float(m)))
        for (n, e), m in zip(strengths.items(), mean, strict=True)
    }
