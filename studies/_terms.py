"""Effects as terms of a linear regression, for methods that choose from a library of terms.

    actuator + interaction force = (the model's own terms) + sum of coefficient * term

Every effect that has an algebraic form along the measured motion is here, in the form that suits
it best: a constant inside it (a period, a speed, a limit) is scanned beforehand, for each effect on
its own, on the fit record. Motion and direction are those that the package's diagnosis uses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from teleopdesign import EFFECTS, Experiment, load_experiment
from teleopdesign.measurement.motion import Motion, motions

Array = NDArray[np.float64]
Columns = list[Array]


@dataclass(frozen=True)
class Signals:
    """What terms are made of, n samples; sign: direction of motion, 0 where it cannot be told.

    command: as it acts at the rows;  held: as commanded, from each row until the next
    at_rows: a held signal as it acts at the rows
    depth: of the tip in the modelled environment (zeros where there is none)
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    sign: Array
    command: Array
    held: Array
    at_rows: Callable[[Array], Array]
    depth: Array
    sample_time: float


@dataclass(frozen=True)
class Term:
    """An effect as columns of a regression; constants: what is scanned (one NaN: nothing is)."""

    columns: Callable[[Signals, float], Columns]
    constants: Callable[[Signals], Array] = lambda now: np.array([np.nan])


def _wave(now: Signals, period: float, factor: Array | float) -> Columns:
    turn = 2 * np.pi * now.position / period
    return [factor * np.sin(turn), factor * np.cos(turn)]


def _periods(now: Signals) -> Array:
    """Half a turn over the whole travel to twelve, closer than two periods can be told."""
    travel = float(np.ptp(now.position))
    return travel / np.arange(0.5, 12.1, 0.25)


def _speeds(now: Signals) -> Array:
    return float(np.sqrt(np.mean(now.velocity**2))) * np.geomspace(0.01, 1.0, 15)


def _falling(now: Signals, speed: float) -> Array:
    return now.sign * np.exp(-((now.velocity / speed) ** 2))


def _slope(now: Signals, y: Array) -> Array:
    return np.gradient(y, now.sample_time)


def _beyond(now: Signals, limit: float) -> Array:
    return now.at_rows(now.held - np.clip(now.held, -limit, limit))


TERMS: dict[str, Term] = {
    "viscous": Term(lambda now, _: [now.velocity]),
    "coulomb": Term(lambda now, _: [now.sign]),
    "stribeck": Term(lambda now, speed: [_falling(now, speed)], _speeds),
    "viscous_asymmetry": Term(lambda now, _: [np.abs(now.velocity)]),
    "quadratic_drag": Term(lambda now, _: [now.velocity * np.abs(now.velocity)]),
    "shear_thinning": Term(
        lambda now, n: [np.sign(now.velocity) * np.abs(now.velocity) ** n],
        lambda _: np.linspace(0.2, 0.8, 4),
    ),
    "position_dependent_friction": Term(lambda now, p: _wave(now, p, now.sign), _periods),
    "load_dependent_friction": Term(lambda now, _: [now.sign * np.abs(now.command)]),
    "friction_drift": Term(
        lambda now, tau: [now.sign * np.exp(-now.time / tau)],
        lambda now: float(now.time[-1]) * np.geomspace(0.1, 2.0, 8),
    ),
    "bias": Term(lambda now, _: [np.ones_like(now.position)]),
    "spring": Term(lambda now, _: [now.position]),
    "gravity": Term(lambda now, _: [np.sin(now.position), np.cos(now.position)]),
    "hardening_spring": Term(lambda now, _: [now.position**3]),
    "cogging": Term(lambda now, p: _wave(now, p, 1.0), _periods),
    "added_inertia": Term(lambda now, _: [now.acceleration]),
    "actuation_delay": Term(
        lambda now, _: [_slope(now, now.command), _slope(now, _slope(now, now.command))]
    ),
    "actuator_saturation": Term(
        lambda now, limit: [_beyond(now, limit)],
        lambda now: np.quantile(np.abs(now.held), np.linspace(0.3, 0.99, 24)),
    ),
    "actuator_gain": Term(lambda now, _: [now.command]),
    "position_dependent_gain": Term(
        lambda now, _: [now.command * now.position, now.command * now.position**2]
    ),
    "torque_ripple": Term(lambda now, p: _wave(now, p, now.command), _periods),
    "contact_damping": Term(lambda now, _: [now.velocity * (now.depth > 0)]),
    "contact_hardening": Term(lambda now, _: [now.depth**2]),
}
#: terms that stand for two effects at once: no linear regression could tell the second
ALIKE = {"bias": "coulomb_asymmetry"}
#: effects with a state of their own: no term of the measured motion is theirs
WITH_MEMORY = frozenset(
    "presliding friction_memory transmission_compliance backlash tip_friction maxwell_slip".split()
)  # fmt: skip
CONTACT = frozenset({"contact_damping", "contact_hardening"})


@dataclass(frozen=True)
class Library:
    """Target and terms of one body with the model's own terms taken out, on fit and check rows.

    fit, check: (n, k), each column of unit rms on the fit rows;  effect: of each column, (k,)
    size: rms that each column had, (k,)
    fit_target, check_target: what the model's own terms leave, (n,)
    """

    body: str
    effect: tuple[str, ...]
    size: Array
    fit: Array
    check: Array
    fit_target: Array
    check_target: Array

    def of(self, *effects: str) -> NDArray[np.intp]:
        """The columns of some effects."""
        return np.flatnonzero([e in effects for e in self.effect])


@dataclass(frozen=True)
class _Part:
    """One record of one body: low-passes columns and keeps the rows on which direction is told."""

    motion: Motion
    signals: Signals
    rows: NDArray[np.intp]

    def low(self, columns: Columns) -> Array:
        kept = [self.motion.lowpassed(c)[self.rows] for c in columns]
        return np.stack(kept, axis=1) if kept else np.zeros((len(self.rows), 0))

    @property
    def target(self) -> Array:
        motion = self.motion
        return self.low([motion.at_rows(motion.command) + motion.interaction])[:, 0]


def _part(experiment: Experiment, body: str, use: str) -> _Part:
    """The only stretch of the record of a use (the cases have one each)."""
    (record,) = (r for r in experiment.records if r.use == use)
    bandwidth = experiment.bandwidth
    assert bandwidth is not None  # the cases state it
    resolution = experiment.channels[f"{body}.position"].resolution
    (motion,) = motions(record, body, bandwidth=bandwidth, resolution=resolution)
    depth = np.zeros_like(motion.position)
    if experiment.environment is not None and body == "slave":
        start = experiment.environment.values["contact_position"].value
        depth = np.maximum(motion.position - start, 0.0)
    signals = Signals(
        time=motion.time,
        position=motion.position,
        velocity=motion.velocity,
        acceleration=motion.acceleration,
        sign=motion.direction.astype(float),
        command=motion.at_rows(motion.command),
        held=motion.command,
        at_rows=motion.at_rows,
        depth=depth,
        sample_time=motion.sample_time,
    )
    trim = round(0.25 / motion.sample_time)
    # little above Nyquist's rate of what the low-pass leaves: closer rows would say the same twice
    stride = max(1, int(1 / (2.5 * bandwidth * motion.sample_time)))
    rows = np.arange(trim, len(motion.time) - trim, stride)
    return _Part(motion, signals, rows[motion.direction[rows] != 0])


def _known_terms(experiment: Experiment, body: str, now: Signals) -> Columns:
    """Terms of the user's model, all coefficients free; a fixed inertia's force is no term."""
    described = experiment.bodies[body]
    terms = [] if described.inertia is not None and described.inertia.fixed else [now.acceleration]
    for effect in described.effects:
        if effect == "stribeck":
            # its speed is wrong or not stated: a few terms span what lies between
            speeds = float(np.sqrt(np.mean(now.velocity**2))) * np.geomspace(0.03, 0.5, 5)
            terms += [_falling(now, speed) for speed in speeds]
        elif effect in TERMS:  # one with a state of its own has no term to take out
            terms += TERMS[effect].columns(now, float("nan"))
    if now.depth.any():
        terms += [now.depth, (now.depth > 0).astype(float)]
    return terms


def _absent(experiment: Experiment, body: str, now: Signals) -> list[str]:
    """Effects that the library has and the model has not."""
    described = experiment.bodies[body]
    free = described.inertia is None or not described.inertia.fixed
    skip = set(described.effects) | ({"added_inertia"} if free else set())
    skip |= set() if now.depth.any() else CONTACT
    skip |= {n for n in TERMS if described.axis in EFFECTS[n].counterparts}
    if f"{body}.interaction_force" not in experiment.channels:
        # command and inertia would then explain each other and all of the target
        skip.add("actuator_gain")
    return [name for name in TERMS if name not in skip]


def library(experiment: Experiment, body: str) -> Library:
    """Target and terms of one body of an experiment with one fit and one check record."""
    fit, check = (_part(experiment, body, use) for use in ("fit", "check"))
    known_fit = fit.low(_known_terms(experiment, body, fit.signals))
    known_check = check.low(_known_terms(experiment, body, check.signals))
    fixed = experiment.bodies[body].inertia
    targets = [fit.target, check.target]
    if fixed is not None and fixed.fixed:
        for i, part in enumerate((fit, check)):
            targets[i] = targets[i] - fixed.value * part.low([part.signals.acceleration])[:, 0]
    inverse = np.linalg.pinv(known_fit)
    target = targets[0] - known_fit @ (inverse @ targets[0])
    effects: list[str] = []
    columns, on_check, sizes = [], [], []
    for name in _absent(experiment, body, fit.signals):
        constant, free = _scanned(TERMS[name], fit, known_fit, inverse, target)
        raw_check = check.low(TERMS[name].columns(check.signals, constant))
        raw = fit.low(TERMS[name].columns(fit.signals, constant))
        size = np.sqrt(np.mean(free**2, axis=0)) + 1e-300
        effects += [name] * free.shape[1]
        sizes.append(size)
        columns.append(free / size)
        on_check.append((raw_check - known_check @ (inverse @ raw)) / size)
    return Library(
        body=body,
        effect=tuple(effects),
        size=np.concatenate(sizes),
        fit=np.concatenate(columns, axis=1),
        check=np.concatenate(on_check, axis=1),
        fit_target=target,
        check_target=targets[1] - known_check @ (inverse @ targets[0]),
    )


def _scanned(
    term: Term, fit: _Part, known_fit: Array, inverse: Array, target: Array
) -> tuple[float, Array]:
    """The constant whose columns leave least of the target, and these without the model's own.

    The best of a grid, then the best between its neighbours.
    """

    def free(constant: float) -> Array:
        raw = fit.low(term.columns(fit.signals, constant))
        return raw - known_fit @ (inverse @ raw)

    def left(constant: float) -> float:
        columns = free(constant)
        rest = target - columns @ np.linalg.lstsq(columns, target, rcond=1e-9)[0]
        return float(rest @ rest)

    grid = np.sort([float(c) for c in term.constants(fit.signals)])
    if len(grid) == 1:
        return grid[0], free(grid[0])
    best = int(np.argmin([left(c) for c in grid]))
    between = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    minimum = minimize_scalar(left, bounds=between, method="bounded", options={"maxiter": 12})
    constant = float(minimum.x) if minimum.fun < left(grid[best]) else float(grid[best])
    return constant, free(constant)


def libraries(folder: Path) -> list[Library]:
    """The library of each body of an experiment's folder."""
    experiment = load_experiment(folder)
    return [library(experiment, body) for body in experiment.bodies]
