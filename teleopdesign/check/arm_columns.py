"""Columns of an arm with the wrong sign, joint or scale: which change leaves less?

    force at joint j = Y_j(positions of all joints) b + friction_j(v_j) + spring_j q_j + constant_j

The base parameters b of the links act at all joints, so a wrong column contradicts the others. And
friction takes energy out: its level, damping and drag are not negative. The least squares of this
balance compare changes of the columns: the opposite sign of a force, a position or both, the
columns of two joints exchanged, and another scale of a force. Neither an inertial parameter nor an
effect of the user's model is needed; what the balance lacks remains with each change.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from ..arms.regressor import base_parameters, columns_with_motors
from ..base.errors import ExperimentError
from ..base.finding import Finding
from ..base.sentences import join_names, percent
from ..measurement.bandwidth import bandwidth_of
from ..measurement.experiment import Experiment, excerpt, isolate_joint
from ..measurement.filtering import Array
from ..measurement.limits import NEARLY_ALL
from ..measurement.prepare import Stretch, prepare
from ._recording import CheckedRecording, RecordingCheck

#: part of the error of the recorded columns that changes of them leave at most, where a column is
#: wrong. Higher: an effect that the balance lacks passes for a wrong column; lower: a wrong scale
#: of joints that hardly push each other is left to the diagnosis
SWAPPED = 0.5
#: part of the force that is left unexplained, above which positions are read otherwise, too: wrong
#: ones left 0.09 and more of simulated arms, 0.14 and more of an industrial arm. Higher: they go
#: unnoticed; lower: sound arms take seconds
UNEXPLAINED = 0.05
#: quotient of two errors up to which both changes may be right: friction that the balance lacks
#: decides. It is also the largest scale that is left to the diagnosis, as `actuator_gain`
ALIKE = 1.25
#: powers of ten of the scales of a force from which the best one is searched
POWERS = [0.25 * k for k in range(-12, 13)]
#: fewest rows in motion of a joint that is compared; low-passed share of motion of such a row
FEWEST, CLEAR_MOTION = 50, 0.98
#: least strength of each column of a joint: level, damping and drag brake, and a spring holds; a
#: constant force, and a difference of the directions, have any sign
LEAST = (0.0, 0.0, 0.0, 0.0, -np.inf, -np.inf)


@dataclass(frozen=True)
class Change:
    """A change of the columns of one quantity.

    joints: one, or two whose columns are exchanged
    factor: on the column; -1: it has the opposite sign; None: the columns are exchanged
    """

    quantity: str
    joints: tuple[str, ...]
    factor: float | None = -1.0

    def __str__(self) -> str:
        keys = join_names([f"{joint}.{self.quantity}" for joint in self.joints])
        if self.factor is None:
            return f"the columns of {keys} are exchanged"
        if self.factor < 0.0:
            return f"{keys} has the opposite sign (sign = -1)"
        times = f"{self.factor:.4g}"
        return (
            f"{keys} is multiplied by {times} (scale = {times} or the torque constant; "
            "actuator_gain in the model if the actuator gives another force)"
        )


#: changes of the columns as recorded; those of a step are made together, and undone by making them
#: again
Changes = tuple[Change, ...]


def with_step(changes: Changes, step: Changes) -> Changes:
    """The changes with those of a step; one that is there already is undone."""
    return (*(c for c in changes if c not in step), *(c for c in step if c not in changes))


def find_wrong_columns(recording: CheckedRecording) -> Iterator[Finding]:
    """Columns of an arm that contradict each other, and the changes by which they agree."""
    if recording.experiment.arm is None:
        return
    try:
        balance = ArmBalance(excerpt(recording.experiment))
    except ExperimentError:  # the records cannot be compared, as the diagnosis says
        return
    first, alike = balance.with_stated_gains(recording), list[list[Changes]]()
    # of several faults each hides the others: any of those alike may be the first
    ways = [balance.follow(with_step(first, step)) for step in balance.better(first)]
    changes = min(ways, key=balance.error, default=first)
    before, after = balance.error(first), balance.error(changes)
    new = tuple(c for c in changes if c not in first and after <= SWAPPED * before)
    for joints in dict.fromkeys(change.joints for change in new):
        step = tuple(c for c in new if c.joints == joints)
        others = tuple(c for c in changes if c not in step)
        if after <= SWAPPED * balance.error(others):
            steps = (s for s in balance.better(others) if set(s) != set(step))
            good = (s for s in steps if balance.error(with_step(others, s)) <= ALIKE * after)
            alike.append([step, *good])
    if not alike:
        return
    shares = [percent(part, ".2g") for part in (before, after)]
    what = "; and ".join(
        " or ".join(" and ".join(map(str, step)) for step in steps) for steps in alike
    )
    sentence = (
        f"The columns of the joints contradict each other: {shares[0]} of the forces is left "
        f"unexplained, {shares[1]} if {what}. Mend this at channels: until then, these records "
        "tell no effect."
    )
    numbers = {"as_given": before, "otherwise": after}
    yield Finding("arm columns", "warning", sentence, numbers, stops=True)


CHECK = RecordingCheck(order=205, find=find_wrong_columns, may_stop=True)


class ArmBalance:
    """Forces along the fit records of an arm, and what they leave with changes of the columns.

    raises ExperimentError: the records cannot be compared
    """

    def __init__(self, experiment: Experiment) -> None:
        assert experiment.arm is not None
        self.experiment, self.arm = experiment, experiment.arm.arm
        self.joints = tuple(experiment.bodies)
        self.chosen = base_parameters(self.arm).chosen
        band = bandwidth_of(experiment)
        joints = [prepare(isolate_joint(experiment, j), bandwidth=band) for j in self.joints]
        self.together = list(zip(*(p.of("fit") for p in joints), strict=True))
        self.rows_of_positions: dict[tuple[tuple[int, float], ...], list[Array]] = {}

    def with_stated_gains(self, recording: CheckedRecording) -> Changes:
        """The columns as recorded, with the best scale where the model has an `actuator_gain`."""
        changes: Changes = ()
        for j, body in ({} if recording.model is None else recording.model.bodies).items():
            if body.has("actuator_gain"):
                changes = (*changes, *self._best_scale(j, changes))
        return changes

    def follow(self, changes: Changes) -> Changes:
        """The changes with the best further ones, until none leaves less."""
        while better := self.better(changes):
            changes = with_step(changes, better[0])
        return changes

    def better(self, changes: Changes) -> list[Changes]:
        """The step that leaves least beside changes, then those alike; []: none leaves less."""
        error, steps = self.error(changes), [self._best_scale(j, changes) for j in self.joints]
        places = [*((j,) for j in self.joints), *combinations(self.joints, 2)]
        alone, both = (("actuator_force",), ("position",)), ("position", "actuator_force")
        for some in (*alone, both) if error > UNEXPLAINED else alone[:1]:
            for place in places:
                factor = -1.0 if len(place) == 1 else None
                steps.append(tuple(Change(quantity, place, factor) for quantity in some))
            steps.append(tuple(Change(some[0], (j,)) for j in self.joints if len(some) == 1))
        left = {step: self.error(with_step(changes, step)) for step in steps if step}
        least = min(left.values())
        if least > NEARLY_ALL * error:  # each of two faults hides the other
            return []
        return [s for s in sorted(left, key=lambda s: left[s]) if left[s] <= ALIKE * least]

    def error(self, changes: Changes) -> float:
        """Part of the force that columns with changes leave unexplained, rms over joints."""
        k, rows, targets = len(self.joints), list[Array](), list[Array]()
        forces = self._columns("actuator_force", changes)
        for j, columns in enumerate(self._rows(self._columns("position", changes))):
            source, factor = forces[j]
            links, friction, force = np.split(columns, [len(self.chosen), -k - 1], axis=1)
            target = factor * force[:, source] + force[:, -1]
            size = float(np.linalg.norm(target))
            if len(columns) == 0 or size == 0.0:
                continue
            beside = np.zeros((len(columns), k, len(LEAST)))
            beside[:, j] = friction
            rows.append(np.hstack([links, beside.reshape(len(columns), -1)]) / size)
            targets.append(target / size)
        if not rows:
            return 0.0
        squares = _least_squares(np.vstack(rows), np.concatenate(targets), k)
        return float(np.sqrt(squares / len(rows)))

    def _best_scale(self, joint: str, changes: Changes) -> Changes:
        """The change of a joint's force to its best scale; (): it is near 1, or beyond all."""
        from scipy.optimize import minimize_scalar

        change = Change("actuator_force", (joint,))

        def error(power: float) -> float:
            return self.error((*changes, replace(change, factor=10.0**power)))

        best = int(np.argmin([error(power) for power in POWERS]))
        if not 0 < best < len(POWERS) - 1:
            return ()
        power = minimize_scalar(error, bounds=(POWERS[best - 1], POWERS[best + 1])).x
        factor = float(10.0**power)
        return () if 1.0 / ALIKE < factor < ALIKE else (replace(change, factor=factor),)

    def _columns(self, quantity: str, changes: Changes) -> tuple[tuple[int, float], ...]:
        """For each joint, the joint whose column is read, and the factor on its signal."""
        source, factor = list(range(len(self.joints))), [1.0] * len(self.joints)
        for change in (c for c in changes if quantity == c.quantity):
            here = [self.joints.index(j) for j in change.joints]
            if change.factor is None:
                source[here[0]], source[here[1]] = source[here[1]], source[here[0]]
            else:
                factor = [f * change.factor if j in here else f for j, f in enumerate(factor)]
        keys = [f"{j}.{quantity}" for j in self.joints]
        units = [self.experiment.channels[key].conversion.factor for key in keys]
        return tuple(
            (s, f * units[j] / units[s])
            for j, (s, f) in enumerate(zip(source, factor, strict=True))
        )

    def _rows(self, positions: tuple[tuple[int, float], ...]) -> list[Array]:
        """Of each joint in motion the columns of links and friction, the k forces and the hand's.

        They are the triangular factor of all rows, which leaves the same squares.
        """
        if positions not in self.rows_of_positions:
            parts = [self._low_passed(stretches, positions) for stretches in self.together]
            whole = [np.vstack(rows) for rows in zip(*parts, strict=True)]
            self.rows_of_positions[positions] = [
                np.asarray(np.linalg.qr(x, mode="r") if len(x) >= FEWEST else x[:0]) for x in whole
            ]
        return self.rows_of_positions[positions]

    def _low_passed(
        self, stretches: tuple[Stretch, ...], positions: tuple[tuple[int, float], ...]
    ) -> list[Array]:
        """The rows of each joint along one stretch, (rows, columns)."""
        motions = [s.motion for s in stretches]
        q, v, a, sign = (
            np.array([factor * getattr(motions[source], name) for source, factor in positions])
            for name in ("position", "velocity", "acceleration", "direction")
        )
        columns = columns_with_motors(self.arm, q, v, a)[:, self.chosen]
        commands = np.array([m.at_rows(m.command) for m in motions])
        rows = []
        for j, (source, _) in enumerate(positions):
            motion, keep = motions[source], stretches[j].keep
            speed, constant = np.abs(v[j]), np.ones(len(v[j]))
            friction = np.vstack([sign[j], v[j], v[j] * speed, q[j], constant, speed])
            every = np.vstack([columns[j], friction, commands, motions[j].interaction[None]])
            moving = motion.lowpassed(np.abs(motion.direction).astype(np.float64), keep)
            rows.append(motion.lowpassed(every, keep).T[moving > CLEAR_MOTION])
        return rows


def _least_squares(matrix: Array, target: Array, joints: int) -> float:
    """Least squares of a balance whose last columns are those of each joint itself."""
    from scipy.optimize import lsq_linear

    size = np.linalg.norm(matrix, axis=0)
    size[size == 0.0] = 1.0
    least = np.full(len(size), -np.inf)
    least[len(size) - joints * len(LEAST) :] = LEAST * joints
    return float(2.0 * lsq_linear(matrix / size, target, (least, np.inf), method="bvls").cost)
