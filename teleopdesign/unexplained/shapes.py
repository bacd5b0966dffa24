"""Shapes of a missing force: a carrier times a function of one variable.

    missing force = carrier * f(variable)

The carrier is the kind of physics (a force, a friction, a damping, a mass, ...). f is a line
between knots, or a sinusoid whose wave number is searched; without a variable it is a constant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from .rows import Rows, StretchSignals


@dataclass(frozen=True)
class Carrier:
    """The factor of f in a missing force.

    name: in results;  quantity: of f;  signal: factor besides push (or grip)
    friction: whether it acts as friction, with grip in place of push
    """

    name: str
    quantity: str
    signal: str = ""
    friction: bool = False

    def along(self, signals: Callable[[str], Array]) -> Array:
        """The residual per f, before the low-pass, from signals by their names (n,)."""
        shown = signals("grip" if self.friction else "push")
        return shown * signals(self.signal) if self.signal else shown


FORCE = Carrier("force", "force")
FRICTION = Carrier("friction", "force", friction=True)
DAMPING = Carrier("damping", "damping", "velocity")
MASS = Carrier("mass", "inertia", "acceleration")
LOST = Carrier("lost command", "dimensionless", "actuator_force")
LATENESS = Carrier("lateness", "time", "force_rate")


@dataclass(frozen=True)
class Variable:
    """The variable that f depends on.

    name: a signal of `StretchSignals`;  knots: their number;  signed: f has a branch for each sign
    bent: knots are closer where the variable is small, because effects at low speed cover little of
        the range;  wave: f is a sinusoid
    expected: the signal as predicted by the model, for a variable that contains the residual
    """

    name: str
    quantity: str
    knots: int = 16
    signed: bool = False
    bent: bool = False
    wave: bool = False
    expected: str = ""


POSITION = Variable("position", "position", knots=40)
POSITION_WAVE = Variable("position", "position", wave=True)
SPEED = Variable("speed", "velocity", bent=True)
VELOCITY = Variable("velocity", "velocity", knots=10, signed=True, bent=True)
ACCELERATION = Variable("acceleration", "acceleration")
COMMAND = Variable("actuator_force", "force", expected="expected_force")
LOAD = Variable("load", "force", expected="expected_load")
INTERACTION = Variable("interaction_force", "force")
TIME = Variable("time", "time", knots=32)
TIME_WAVE = Variable("time", "time", wave=True)
SINCE = Variable("since_reversal", "time", knots=12, bent=True)
TRAVEL = Variable("travel", "position", knots=12, bent=True)


@dataclass(frozen=True)
class Shape:
    """A carrier and the variable of f; None: f is constant."""

    carrier: Carrier
    variable: Variable | None = None

    @property
    def of_command(self) -> bool:
        """Whether the shape may describe another gain of the actuator."""
        return self.carrier == LOST or (self.carrier == FORCE and self.variable == COMMAND)

    @property
    def is_wave(self) -> bool:
        """Whether f is a sinusoid, whose wave number is searched."""
        return self.variable is not None and self.variable.wave

    @property
    def name(self) -> str:
        """Name such as "friction over speed", or "force repeating over position"."""
        if self.variable is None:
            return self.carrier.name
        how = "repeating over" if self.is_wave else "over"
        return f"{self.carrier.name} {how} {self.variable.name}"


#: dependences that are tested; of two that look alike the simpler one comes first. Last come time,
#: which repeats with a periodic motion, and the command, which contains the residual
SHAPES = (
    *(Shape(c) for c in (FORCE, FRICTION, DAMPING, MASS, LOST, LATENESS)),
    *(Shape(FRICTION, v) for v in (SPEED, POSITION, POSITION_WAVE)),
    *(Shape(FORCE, v) for v in (POSITION, POSITION_WAVE, SPEED, ACCELERATION)),
    Shape(DAMPING, POSITION),
    *(Shape(MASS, v) for v in (POSITION, SPEED)),
    *(Shape(LOST, v) for v in (POSITION, POSITION_WAVE)),
    Shape(FORCE, VELOCITY),
    *(Shape(FRICTION, v) for v in (SINCE, TRAVEL, TIME)),
    *(Shape(FORCE, v) for v in (TIME, TIME_WAVE)),
    Shape(DAMPING, TIME),
    Shape(FORCE, COMMAND),  # an actuator's limit also looks like friction under load
    Shape(FRICTION, LOAD),
    Shape(FORCE, INTERACTION),
)


def shapes_of(rows: Rows) -> tuple[Shape, ...]:
    """The dependences that are tested; on a friction curve those on the speed."""
    speeds = (None, SPEED, VELOCITY)
    alone = (FORCE, FRICTION, DAMPING)
    of_speed = (s for s in SHAPES if s.carrier in alone and s.variable in speeds)
    return tuple(of_speed) if rows.is_curve else SHAPES


def knots_of(variable: Variable, rows: Rows) -> Array:
    """Knots of f over the range of the learning rows; empty where these have no range."""
    values = rows.at(variable.name)
    shown = (rows.root > 0) & rows.learnt & np.isfinite(values)
    if np.count_nonzero(shown) < variable.knots or np.ptp(values[shown]) == 0.0:
        return np.zeros(0)
    if not variable.bent:
        low, high = np.quantile(values[shown], [0.0005, 0.9995]).tolist()
        return np.linspace(low, high, variable.knots)
    # the first knot holds rows enough to know f there, down to rest: as motions are determined
    first, top = np.quantile(np.abs(values[shown]), [0.01, 0.9995]).tolist()
    small = min(smallest_resolved(variable, rows), 0.1 * top)
    ends = np.arcsinh([first / small, top / small])
    return np.asarray(small * np.sinh(np.linspace(ends[0], ends[1], variable.knots)))


def smallest_resolved(variable: Variable, rows: Rows) -> float:
    """The smallest value of the variable that the comparison resolves."""
    if rows.is_curve:
        return float(np.min(rows.at("speed")))
    step = max(a.stretch.motion.step for a in rows.alongs)
    time = 1.0 / (2 * np.pi * rows.bandwidth)
    return {"position": step, "velocity": step / time, "time": time}[variable.quantity]


def basis(variable: Variable, knots: Array, values: Array) -> Array:
    """Functions of the variable (k, n) whose weighted sum is f; zero where a value is not known.

    knots: for a sinusoid, its wave number in cycles per unit
    """
    known = np.isfinite(values)
    values = np.where(known, values, 0.0)
    if variable.wave:
        turn = 2 * np.pi * knots[0] * values
        return np.vstack([np.cos(turn), np.sin(turn)]) * known
    size = np.abs(values) if variable.signed else values
    # at rest friction is that of the slowest sure motion
    hats = _hats(np.maximum(size, knots[0]) if variable.bent else size, knots) * known
    return np.vstack([hats * (values > 0), hats * (values < 0)]) if variable.signed else hats


def _hats(values: Array, knots: Array) -> Array:
    """Hat functions of lines between knots, continued beyond the outer knots: (k, n)."""
    place = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, len(knots) - 2)
    part = (values - knots[place]) / (knots[place + 1] - knots[place])
    hats = np.zeros((len(knots), len(values)))
    each = np.arange(len(values))
    hats[place, each] = 1.0 - part
    hats[place + 1, each] = part
    return hats


def functions_of(shape: Shape, knots: Array, values: Array) -> Array:
    """Functions (k, n) at values of the variable (n,) whose weighted sum is f."""
    variable = shape.variable
    if variable is None:
        return np.ones((1, len(values)))
    functions = basis(variable, knots, values)
    # without a command there is none to lose
    of_command = shape.carrier == FORCE and shape.of_command
    return functions - basis(variable, knots, np.zeros(1)) * of_command


def columns_of(shape: Shape, knots: Array, rows: Rows) -> Array:
    """The residual per coefficient of f (n, k), low-passed."""
    name = "time" if shape.variable is None else shape.variable.name
    return columns_from(shape, rows, lambda a: functions_of(shape, knots, a.signals[name]))


def columns_from(shape: Shape, rows: Rows, functions: Callable[[StretchSignals], Array]) -> Array:
    """The residual (n, k) by functions (k, samples) times the shape's carrier, low-passed."""
    columns = rows.lowpassed(lambda a: shape.carrier.along(a.signals.__getitem__) * functions(a))
    return _relative_to_force(columns, rows) if shape.of_command else columns


def _relative_to_force(columns: Array, rows: Rows) -> Array:
    """Columns of a change of the acting force, relative to the remaining acting force.

    Where no other force is measured, a smaller command with smaller other forces leaves a smaller
    residual and explains nothing: see `residual.relative_residuals`.
    """
    learnt = rows.learnt
    carried = (rows.root**2 * rows.measured)[learnt]
    whole = float(carried @ rows.measured[learnt])
    if not whole > 0.0:  # no force acts where the motion is known
        return columns
    share = carried @ columns[learnt] / whole
    return columns - np.outer(rows.residual, share)


def roughness(shape: Shape, knots: Array) -> Array:
    """Penalty (k, k) on the second differences of f between neighbouring knots."""
    if shape.variable is None:
        return np.zeros((1, 1))
    if shape.is_wave:
        return np.zeros((2, 2))
    second = np.diff(np.eye(len(knots)), 2, axis=0)
    one: Array = second.T @ second
    return np.asarray(np.kron(np.eye(2), one), dtype=float) if shape.variable.signed else one
