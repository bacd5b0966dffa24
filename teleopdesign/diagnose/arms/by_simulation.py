"""An arm compared by simulation: all joints move freely under their recorded commands.

As in `compare_by_simulation`, each joint starts on the measured motion and moves freely for a
horizon. All joints move together, so a joint that deviates pulls the others along.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp

from ...arms import base_parameters
from ...base.errors import ModelError, did_you_mean, quote
from ...blocks import Body
from ...effects import SIGNALS
from ...measurement.experiment import Experiment
from ...measurement.filtering import Array
from ...measurement.motion import Motion
from ...measurement.prepare import Stretch
from ...model import Model
from ..by_simulation import (
    BRISTLE_SHARE,
    HORIZONS,
    HorizonError,
    RecordedLoop,
    SimulationComparison,
    horizon_error,
)
from ..error import force_error
from ..record_offsets import apply_record_offsets
from .course import ArmLinks, LedArm, courses, led_arm
from .fit import error_over_joints, remove_links
from .other_motion import follows_another
from .prepared import PreparedArm, prepare_arm, with_bodies_of


def compare_arm_by_simulation(
    model: Model,
    experiment: Experiment | PreparedArm,
    *,
    loop: RecordedLoop | Mapping[str, RecordedLoop] | None = None,
) -> SimulationComparison:
    """Drive the model of an arm by the recorded forces, over horizons of 0.1 s to the whole record.

    model: of all joints, with base parameters where they are estimated
    loop: the controller that held each joint, or a mapping joint -> controller; None: no controller
    raises ExperimentError: the experiment lacks what the comparison needs
    raises ModelError: an effect has no simulated form, or a loop names no joint
    """
    prepared = experiment if isinstance(experiment, PreparedArm) else prepare_arm(experiment)
    if not model.links:
        model = model.with_links(prepared.initial)
    prepared = with_bodies_of(model, prepared)
    holding = _answers(loop, tuple(prepared.joints))
    alone = {
        j: Model(
            {j: model.bodies[j]},
            model.known,
            {n: x for n, x in model.record_shift.items() if n == j},
        ).with_links(model.links)
        for j in prepared.joints
    }
    errors = [one for use in ("fit", "check") for one in _errors_of(alone, prepared, use, holding)]
    by_force = {
        use: error_over_joints(
            {j: force_error(alone[j], remove_links(p.of(use))) for j, p in prepared.joints.items()}
        )
        for use in ("fit", "check")
    }
    return SimulationComparison(
        model, prepared, by_force["fit"], by_force["check"], tuple(errors), loop
    )


def _answers(
    loop: RecordedLoop | Mapping[str, RecordedLoop] | None, joints: Sequence[str]
) -> Array:
    """Stiffness and damping (k, 2) of the controller of each joint.

    raises ModelError: the loop names no joint
    """
    if not isinstance(loop, Mapping):
        loop = dict.fromkeys(joints, loop or RecordedLoop(0.0))
    for name in loop:
        if name not in joints:
            raise ModelError(
                f"loop: no joint {quote(name)}, has {', '.join(joints)}{did_you_mean(name, joints)}"
            )
    each = [loop.get(j, RecordedLoop(0.0)) for j in joints]
    return np.array([[one.stiffness, one.damping] for one in each])


@dataclass(frozen=True)
class _Along:
    """An arm along one stretch, with its first row that counts and the row after the last one."""

    led: LedArm
    first: int
    end: int

    @property
    def length(self) -> float:
        """Seconds from the first to the last row that counts."""
        return (self.end - 1 - self.first) * self.led.motions[0].sample_time


def _errors_of(
    models: Mapping[str, Model], prepared: PreparedArm, use: str, answers: Array
) -> list[HorizonError]:
    """Errors of all joints on the records of one use, the shortest horizon first.

    answers: (k, 2) stiffness and damping of the joints' controllers
    """
    along = _follow_stretches(models, prepared, use, answers)
    longest = max((one.length for one in along), default=0.0)
    horizons = [h for h in HORIZONS if h < longest] + [np.inf] * bool(along)
    parts = [_deviations(one, horizons) for one in along]
    errors = []
    for j, joint in enumerate(models):
        rows = [(one.led.motions[j], one.first, one.end) for one in along]
        for h, horizon in enumerate(horizons):
            x, v = (np.concatenate([part[h][i][j] for part in parts]) for i in range(2))
            errors.append(horizon_error(use, joint, horizon, x, v, rows))
    return errors


def _follow_stretches(
    models: Mapping[str, Model], prepared: PreparedArm, use: str, answers: Array
) -> list[_Along]:
    """The arm along each stretch of one use, each joint corrected by its record's offsets."""
    stretches: list[tuple[Stretch, ...]] = [
        remove_links(p.of(use)) for p in prepared.joints.values()
    ]
    located = [apply_record_offsets(m, s) for m, s in zip(models.values(), stretches, strict=True)]
    along = []
    for i, stretch in enumerate(stretches[0]):
        bodies, motions = zip(*(one[i] for one in located), strict=True)
        parted = [_without_coupling(body) for body in bodies]
        led = led_arm(
            _links(models, prepared, motions, [inertia for _, inertia in parted]),
            [body for body, _ in parted],
            motions,
            bristles=[max(m.step, BRISTLE_SHARE * float(np.ptp(m.position))) for m in motions],
            answers=answers,
        )
        along.append(_Along(led, int(stretch.keep[0]), int(stretch.keep[-1]) + 1))
    return along


def _without_coupling(body: Body) -> tuple[Body, float]:
    """A body without effects of another joint's motion, and their force per its acceleration.

    raises ModelError: such an effect is no inertia, and has no simulated form
    """
    whole = sp.Float(0.0)
    for effect in body.effects:
        if follows_another(effect):
            whole += effect.expression().subs(body.numbers())
            body = body.without_effect(effect.name)
    inertia = sp.diff(whole, SIGNALS["other_acceleration"])
    if not inertia.is_number:
        raise ModelError(f"{body}: an effect of another motion that is no inertia: not simulated")
    return body, float(inertia)


def _links(
    models: Mapping[str, Model],
    prepared: PreparedArm,
    motions: Sequence[Motion],
    coupled: Sequence[float],
) -> ArmLinks:
    """The links of the arm for a simulation, along the motions of all joints.

    coupled: of each joint, the force on it per acceleration of the other joint
    """
    description, joints = prepared.experiment.arm, list(prepared.joints)
    assert description is not None
    values, chosen = description.arm.inertial, np.arange(len(description.arm.inertial))
    if prepared.base is not None:
        values = np.array(next(iter(models.values())).links)
        chosen = base_parameters(description.arm).chosen
    carried = np.zeros((len(joints), len(joints)))
    for j, (joint, motion) in enumerate(zip(joints, motions, strict=True)):
        assert motion.links is not None
        carried[j, j] = motion.links.inertia
        if coupled[j]:
            carried[j, joints.index(prepared.others[joint])] -= coupled[j]
    return ArmLinks(prepared, values, chosen, carried)


def _deviations(one: _Along, horizons: Sequence[float]) -> list[tuple[Array, Array]]:
    """Simulated less measured position and velocity (k, rows), for each horizon (s)."""
    begins: list[int] = []
    ends: list[int] = []
    owner: list[int] = []
    for h, horizon in enumerate(horizons):
        rows = one.end - one.first
        step = one.led.motions[0].sample_time
        each = rows if np.isinf(horizon) else max(round(horizon / step), 2)
        starts = list(range(one.first, one.end - 1, each))
        begins += starts
        # one extra row, which is not counted: no command follows the last row of a course
        ends += [min(begin + each + 1, one.end) for begin in starts]
        owner += [h] * len(starts)
    at = np.array(begins), np.array(ends)
    x, v = courses(one.led, at[0], at[1] - 1 - at[0])
    position = np.array([m.position for m in one.led.motions])
    velocity = np.array([m.velocity for m in one.led.motions])
    parts: list[tuple[Array, Array]] = []
    for h in range(len(horizons)):
        mine = [i for i, of in enumerate(owner) if of == h]
        dx, dv = (
            np.concatenate(
                [s[:, i, : ends[i] - begins[i]] - m[:, begins[i] : ends[i]] for i in mine], axis=1
            )
            for s, m in ((x, position), (v, velocity))
        )
        parts.append((dx, dv))
    return parts
