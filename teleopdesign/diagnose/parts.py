"""The parts of an experiment, prepared for comparison: what is searched together.

The one or two bodies of an experiment are one part. Each joint of an arm is a part, whose motion
comes with the force of the links that all joints share.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arms import BaseParameters, Chain, base_parameters
from ..arms.regressor import columns_with_motors
from ..base.errors import ExperimentError
from ..base.frozen import ByValue
from ..effects import EFFECTS
from ..measurement.bandwidth import bandwidth_of
from ..measurement.experiment import Experiment, isolate_joint
from ..measurement.filtering import Array
from ..measurement.motion import LinkForces, Motion
from ..measurement.prepare import Prepared, Stretch, prepare
from ..model import Model
from .noise_floor import DRAWS, read_again

#: poses of a record over which an inertia is averaged
POSES = 50


@dataclass(frozen=True, eq=False)
class PreparedParts(ByValue):
    """An experiment, prepared for comparison at one bandwidth (Hz).

    base: base parameters of an arm's links that are estimated; None: there are no links, or they
        are those of the description
    parts: joint -> its records, like an experiment on one body; "" -> those of all bodies
    others: joint -> the joint whose motion is its channel `other_position`
    silence: why the records of the arm tell no effect; "": they may tell one
    """

    experiment: Experiment
    bandwidth: float
    base: BaseParameters | None
    parts: Mapping[str, Prepared]
    others: Mapping[str, str] = field(default_factory=dict)
    silence: str = ""

    @property
    def joints(self) -> Mapping[str, Prepared]:
        """The parts that links join; empty where there is one part."""
        return {} if self.experiment.arm is None else self.parts

    @cached_property
    def size(self) -> dict[str, float]:
        """Part -> root of the measured squares on the fit records."""
        squares = {n: sum(s.measured for s in p.of("fit")) for n, p in self.parts.items()}
        return {name: float(np.sqrt(x)) for name, x in squares.items()}

    @property
    def initial(self) -> tuple[float, ...]:
        """Base parameters (b,) by the arm's description; empty where none is estimated."""
        return () if self.base is None else tuple(float(x) for x in self.base.initial)

    def beside(self, joint: str) -> list[tuple[Motion, ...]]:
        """For each stretch of a joint, the motions of the other joints at the same rows."""
        others = [p.stretches for j, p in self.parts.items() if j != joint]
        count = len(self.parts[joint].stretches) if others else 0
        return [tuple(stretches[i].motion for stretches in others) for i in range(count)]


def prepare_parts(
    experiment: Experiment, *, bandwidth: float | None = None, seed: int = 0
) -> PreparedParts:
    """Smooth, differentiate and cut the records of all parts, with the force of links at joints.

    bandwidth: Hz; None: the experiment's, or chosen from the records
    seed: of an arm's simulated readings for the noise floor
    raises ExperimentError: the bandwidth is too high for the sample rate, no stretch is long
        enough, or a force is zero throughout
    """
    if experiment.arm is None:
        whole = prepare(experiment, bandwidth=bandwidth)
        return PreparedParts(experiment, whole.bandwidth, None, {"": whole})
    bandwidth = bandwidth_of(experiment) if bandwidth is None else bandwidth
    arm, joints = experiment.arm.arm, tuple(experiment.bodies)
    base = base_parameters(arm) if experiment.arm.estimate == "base parameters" else None
    prepared = {j: prepare(isolate_joint(experiment, j), bandwidth=bandwidth) for j in joints}
    stretches: dict[str, list[Stretch]] = {j: [] for j in joints}
    generator = np.random.default_rng(seed)
    checked = bool(experiment.check_records)
    for together in zip(*(prepared[j].stretches for j in joints), strict=True):
        motions = [s.motion for s in together]
        links = _forces(arm, base, motions)
        drawn: list[list[LinkForces]] = []
        if (together[0].use == "check") == checked:
            for _ in range(DRAWS):
                again = [
                    read_again(s, prepared[j], generator)
                    for j, s in zip(joints, together, strict=True)
                ]
                drawn.append(_forces(arm, base, again))
        for k, (j, stretch) in enumerate(zip(joints, together, strict=True)):
            mine = replace(links[k], drawn=tuple(forces[k] for forces in drawn))
            stretches[j].append(replace(stretch, motion=replace(stretch.motion, links=mine)))
    made = {j: replace(prepared[j], stretches=tuple(stretches[j])) for j in joints}
    parts = PreparedParts(experiment, bandwidth, base, made)
    for j in joints:
        if not parts.size[j] > 0:
            raise ExperimentError(f"{experiment.folder.name}: {j}.actuator_force: zero throughout")
    return parts


def _forces(arm: Chain, base: BaseParameters | None, motions: Sequence[Motion]) -> list[LinkForces]:
    """The force of the links at each joint, along motions of all joints at the same times."""
    position, velocity, acceleration = (
        np.array([getattr(m, name) for m in motions])
        for name in ("position", "velocity", "acceleration")
    )
    columns = columns_with_motors(arm, position, velocity, acceleration)
    forces = []
    for k, motion in enumerate(motions):
        nothing: Array = np.zeros(len(motion.time))
        if base is None:
            force = arm.inertial @ columns[k, : len(arm.inertial)]
            forces.append(LinkForces(force, *np.zeros((2, 0, len(force)))))
            continue
        mine = np.ascontiguousarray(columns[k, base.chosen])
        forces.append(LinkForces(nothing, mine, motion.lowpassed(mine)))
    return forces


def with_inertias(prepared: PreparedParts, inertias: Mapping[str, float]) -> PreparedParts:
    """The records, with a part of each joint's links as the inertia of its body.

    inertias: joint -> this part (SI); the model's body has it too, and it is subtracted from the
        force of the links
    """
    parts = dict(prepared.parts)
    for joint, records in prepared.joints.items():
        stretches = []
        for stretch in records.stretches:
            links = stretch.motion.links
            assert links is not None
            drawn = tuple(replace(d, inertia=inertias[joint]) for d in links.drawn)
            links = replace(links, inertia=inertias[joint], drawn=drawn)
            stretches.append(replace(stretch, motion=replace(stretch.motion, links=links)))
        parts[joint] = replace(records, stretches=tuple(stretches))
    return replace(prepared, parts=parts)


def with_bodies_of(model: Model, prepared: PreparedParts) -> PreparedParts:
    """The records without that inertia of the links which the bodies of a fitted model have.

    This is the bodies' inertia less the inertia of their motors, which the experiment states.
    """
    if not prepared.joints:
        return prepared
    motors, values = motor_inertias(prepared.experiment, model), model.parameters
    inertias = {j: values[f"{j}.inertia"].value - motors[j] for j in prepared.joints}
    return with_inertias(prepared, inertias)


def motor_inertias(experiment: Experiment, model: Model) -> dict[str, float]:
    """Joint -> inertia of its motor, as the experiment states it; model: knows a user's effects."""
    # a search among few effects does not know the other effects of the experiment
    there = {e.name: e for body in model.bodies.values() for e in body.effects}
    stated = Model.from_experiment(experiment, {**EFFECTS, **model.known, **there}).parameters
    return {joint: stated[f"{joint}.inertia"].value for joint in experiment.bodies}


def remove_links(stretches: tuple[Stretch, ...]) -> tuple[Stretch, ...]:
    """Stretches as they were measured, without reduced weight in the directions of the links."""
    return tuple(replace(s, shared=None) for s in stretches)


def mean_inertias(prepared: PreparedParts, links: tuple[float, ...]) -> dict[str, float]:
    """Joint -> mean inertia of the links about it (kg m^2, or kg), along its first record.

    links: base parameters
    Each is at least a thousandth of the largest, so that each joint has a positive inertia.
    """
    motions = [p.stretches[0].motion for p in prepared.parts.values()]
    places = np.linspace(0, len(motions[0].time) - 1, POSES).astype(int)
    position = np.array([m.position[places] for m in motions])
    inertias = np.mean(inertias_at(prepared.experiment, links, position), axis=1).tolist()
    least = 1e-3 * max(*inertias, 1e-9)
    return {j: max(x, least) for j, x in zip(prepared.parts, inertias, strict=True)}


@dataclass(frozen=True, eq=False)
class ArmLinks:
    """The links of an arm: values of their inertial parameters, and the columns of these.

    values: (b,);  chosen: (b,) columns of the regressor
    carried: (k, k) inertia of the links that the joints' bodies have already, less the inertia of
        couplings
    """

    arm: Chain
    values: Array
    chosen: NDArray[np.intp]
    carried: Array

    def needed(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Inertia matrix (n, k, k) and force at zero acceleration (k, n), less that of the bodies.

        position, velocity: (k, n)
        """
        k, n = position.shape
        rates = np.zeros((2, k, k + 2, n))
        rates[0, :, 0] = velocity
        rates[1, :, 2:] = np.eye(k)[:, :, None]
        poses = np.repeat(position[:, None], k + 2, axis=1).reshape(k, -1)
        columns = columns_with_motors(self.arm, poses, *rates.reshape(2, k, -1))
        force = np.einsum("p,kpn->kn", self.values, columns[:, self.chosen]).reshape(k, k + 2, n)
        inertia = np.moveaxis(force[:, 2:] - force[:, 1:2], 2, 0)
        return inertia - self.carried, force[:, 0]


def links_of(experiment: Experiment, links: tuple[float, ...]) -> ArmLinks:
    """The links of an arm with these base parameters; (): those of the description."""
    assert experiment.arm is not None
    arm, count = experiment.arm.arm, len(experiment.bodies)
    values, chosen = arm.inertial, np.arange(len(arm.inertial))
    if links:
        values, chosen = np.array(links), base_parameters(arm).chosen
    return ArmLinks(arm, values, chosen, np.zeros((count, count)))


def inertias_at(experiment: Experiment, links: tuple[float, ...], position: Array) -> Array:
    """Inertia (k, n) of the links about each joint, the other joints at rest (kg m^2, or kg).

    links: base parameters, () where the links are those of the description;  position: (k, n)
    Least-squares base parameters may belong to no real links, so an inertia may be negative.
    """
    inertia, _ = links_of(experiment, links).needed(position, np.zeros_like(position))
    return np.asarray(np.einsum("njj->jn", inertia))
