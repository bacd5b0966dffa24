"""The bodies of a model along the stretches of its records, ready to be driven by their forces.

A body that nothing joins to another moves alone. The joints of an arm move together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..blocks import Body
from ..effects import SIGNALS
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..model import Model
from .linked_course import courses, led_arm
from .other_motion import follows_another
from .parts import ArmLinks, PreparedParts, links_of, remove_links
from .record_offsets import apply_record_offsets
from .simulated_course import LedBody, course_of, led_body, with_whole_dead_times

#: deflection of ideal friction before it slides, as a part of the travel: far below any error of a
#: free motion. A smaller part needs shorter steps
BRISTLE_SHARE = 2e-5


@check_types
@dataclass(frozen=True)
class RecordedLoop:
    """The controller of the device during the recording, as a spring and a damper.

    stiffness: N/m or N m/rad;  damping: N s/m or N m s/rad;  both finite and not negative
    """

    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        if not (0.0 <= self.stiffness < np.inf and 0.0 <= self.damping < np.inf):
            raise ModelError(
                "RecordedLoop: expected stiffness and damping of zero or more, found "
                f"{self.stiffness:g}, {self.damping:g}"
            )


@dataclass(frozen=True, eq=False)
class Driven:
    """Bodies that move together along one stretch, and the rows first to end that count in errors.

    places, motions: of the k bodies, at the same rows
    courses: of spans of rows, the simulated position and velocity (2, k, rows), each from the
        measured motion on
    """

    places: tuple[str, ...]
    motions: tuple[Motion, ...]
    first: int
    end: int
    courses: Callable[[Sequence[slice]], Sequence[Array]]

    @property
    def length(self) -> float:
        """Seconds from the first to the last row that counts."""
        return (self.end - 1 - self.first) * self.motions[0].sample_time


def driven_stretches(
    models: Mapping[str, Model],
    prepared: PreparedParts,
    use: str,
    gains: Mapping[str, tuple[float, float]],
) -> list[list[Driven]]:
    """Groups of bodies that move together, each along its stretches of one use.

    models: part -> its model
    gains: place -> stiffness and damping of the controller that holds it on its recorded motion
    Bodies are corrected by the offsets of their records.
    raises ModelError: an effect has no simulated form
    """
    stretches = [remove_links(p.of(use)) for p in prepared.parts.values()]
    located = [apply_record_offsets(m, s) for m, s in zip(models.values(), stretches, strict=True)]
    kept = [(int(s.keep[0]), int(s.keep[-1]) + 1) for s in stretches[0]]
    if prepared.joints:
        rows = zip(kept, zip(*located, strict=True), strict=True)
        return [[_drive_arm(models, prepared, one, gains, ends) for ends, one in rows]]
    alone = [
        _drive_body(body, motion, gains[motion.body], ends)
        for (body, motion), ends in zip(located[0], kept, strict=True)
    ]
    (model,) = models.values()
    return [[one for one in alone if one.places == (place,)] for place in model.bodies]


def _bristle(motion: Motion) -> float:
    return max(motion.step, BRISTLE_SHARE * float(np.ptp(motion.position)))


def _drive_body(
    body: Body, motion: Motion, gains: tuple[float, float], ends: tuple[int, int]
) -> Driven:
    stiffness, damping = gains
    led = led_body(
        with_whole_dead_times(body, motion),
        bristle=_bristle(motion),
        stiffness=stiffness,
        damping=damping,
    )
    return Driven((motion.body,), (motion,), *ends, partial(_courses_of_body, led, motion))


def _courses_of_body(led: LedBody, motion: Motion, spans: Sequence[slice]) -> list[Array]:
    each = [course_of(led, motion, span) for span in spans]
    return [np.array([[course.position], [course.velocity]]) for course in each]


def _drive_arm(
    models: Mapping[str, Model],
    prepared: PreparedParts,
    located: Sequence[tuple[Body, Motion]],
    gains: Mapping[str, tuple[float, float]],
    ends: tuple[int, int],
) -> Driven:
    bodies, motions = zip(*located, strict=True)
    parted = [_without_coupling(body) for body in bodies]
    led = led_arm(
        _links(models, prepared, motions, [inertia for _, inertia in parted]),
        [body for body, _ in parted],
        motions,
        bristles=[_bristle(motion) for motion in motions],
        answers=np.array([gains[joint] for joint in models]),
        first=ends[0],
    )
    return Driven(tuple(models), motions, *ends, partial(courses, led))


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
    prepared: PreparedParts,
    motions: Sequence[Motion],
    coupled: Sequence[float],
) -> ArmLinks:
    """The links of the arm for a simulation, along the motions of all joints.

    coupled: of each joint, the force on it per acceleration of the other joint
    """
    joints = list(prepared.parts)
    carried = np.zeros((len(joints), len(joints)))
    for j, (joint, motion) in enumerate(zip(joints, motions, strict=True)):
        assert motion.links is not None
        carried[j, j] = motion.links.inertia
        if coupled[j]:
            carried[j, joints.index(prepared.others[joint])] -= coupled[j]
    links = links_of(prepared.experiment, next(iter(models.values())).links)
    return replace(links, carried=carried)
