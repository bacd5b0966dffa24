"""Simulated motion of a model under recorded forces: a record with known true parameters.

The recorded command and interaction force act on the body, and a weak spring and damper lead it
along the recorded motion, as a controller would: their force is part of the command that is kept.
So the body sticks, breaks away and reverses by the model's laws, near the places where the device
did.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..blocks import Body, matrix_impedance
from ..controllers import controller
from ..diagrams import Block, Control, Diagram, Junction, Linked, Moving
from ..effects import delayed
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..realise.bristle import with_bristle, with_least_level
from ..realise.kernel import fastest_rate
from ..realise.simulated import without_absent
from ..realise.steps import FASTEST
from ..realise.tips import tip
from ..simulate import Sampling, prepare

#: natural frequency of the spring that leads the model along the measurement, over the bandwidth of
#: the comparison
LEADS = 0.04
#: fewest inner steps in a sample, and most of them where something oscillates fast
STEPS, MOST_STEPS = 20, 400


@dataclass(frozen=True)
class Course:
    """True position, velocity and command (n,) of a simulated body."""

    position: Array
    velocity: Array
    command: Array

    def stays_near(self, motion: Motion) -> bool:
        """Whether the travel is between a tenth and 100 times the record's travel; no for NaN.

        The spring that leads a body does not hold every model: one that is held stays within a part
        of the record's travel, any other soon exceeds every bound. A body that sticks where the
        record moved says nothing about its readings: two bodies that were stuck covered 1e-4.
        """
        travel = np.ptp(motion.position)
        return bool(0.1 * travel <= np.ptp(self.position) < 100.0 * travel)


@dataclass(frozen=True)
class LedBody:
    """A body on X1 with its command U1 = F_led1 - (stiffness + damping s) X1, ready to simulate.

    stiffness, damping: of the spring and damper that lead the body (SI);  has_tip: as its structure
    bristle: length (m or rad) of the bristle of ideal friction, of the body and of its tip
    """

    diagram: Diagram
    stiffness: float
    damping: float
    has_tip: bool
    bristle: float


def grid(motion: Motion) -> float:
    """Longest simulation step (s) along a record; dead times must be multiples of it."""
    return motion.sample_time / STEPS


def simulated_course(
    body: Body, motion: Motion, *, deflection: float, damping_ratio: float = 0.0
) -> Course:
    """The course of a body under a record's forces, led along the recorded motion.

    deflection: bristle length of ideal friction, in steps of the position's reading
    damping_ratio: of the inertia on the bristle
    raises ModelError: the body cannot be simulated, or a dead time is no multiple of `grid`
    """
    frequency = 2.0 * np.pi * LEADS * motion.bandwidth
    inertia = body.parameters["inertia"].value
    led = led_body(
        body,
        bristle=deflection * motion.step,
        damping_ratio=damping_ratio,
        stiffness=inertia * frequency**2,
        damping=2.0 * inertia * frequency,
    )
    return course_of(led, motion)


def led_body(
    body: Body, *, bristle: float, damping_ratio: float = 0.0, stiffness: float, damping: float
) -> LedBody:
    """The body with the spring and damper that lead it; zero stiffness and damping: none.

    bristle: length of the bristle of ideal friction (m or rad)
    damping_ratio: of the inertia on that bristle
    stiffness, damping: SI
    """
    body = with_least_level(without_absent(body))
    body = with_bristle(body, bristle, damping_ratio=damping_ratio)
    has_tip = any(e.role == "structure" for e in body.effects)
    diagram = wire_led_bodies([body], np.array([[stiffness, damping]]), are_linked=False)
    return LedBody(diagram, stiffness, damping, has_tip, bristle)


def course_of(led: LedBody, motion: Motion, rows: slice = slice(None)) -> Course:
    """The course of a body under a record's forces, starting with the motion at the first row.

    rows: of the motion;  hidden states start at zero
    """
    step, time = grid(motion), motion.time[rows] - motion.time[rows][0]
    # where the log of the command is late: the mean command over a row
    command = motion.command
    if motion.command_late:
        command = np.interp(motion.time + motion.command_late, motion.time, command)
    position, velocity = motion.position[rows], motion.velocity[rows]
    force = command[rows] + led.stiffness * position + led.damping * velocity
    interaction = motion.interaction[rows]
    start = {"X1": float(position[0]), "X1_velocity": float(velocity[0])}
    if led.has_tip:
        start |= {tip("X1"): start["X1"], tip("X1") + "_velocity": start["X1_velocity"]}
    prepared = prepare(
        led.diagram,
        duration=float(time[-1]),
        inputs={
            "F_led1": lambda t: np.interp(t, time, force),
            "F1": lambda t: np.interp(t, time, interaction),
        },
        initial=start,
        computer=Sampling(period=motion.sample_time),
        step=step,
        give=led.bristle,
    )
    rate, _ = fastest_rate(prepared.program, prepared.diagram.values)
    finer = int(np.ceil(rate * step / FASTEST))
    # not as fine as the reload of a bristle requires: no sensor resolves the reload
    kept, _ = prepared.run(prepared.timing(STEPS * min(max(finer, 1), MOST_STEPS // STEPS)))
    columns = list(prepared.program.layout.columns)
    n = len(time)
    return Course(*(kept[:n, columns.index(name)] for name in ("X1", "X1_velocity", "U1")))


def wire_led_bodies(bodies: Sequence[Body], answers: Array, *, are_linked: bool) -> Diagram:
    """The bodies on X1, X2 ... with U = F_led - (stiffness + damping s) X.

    answers: (k, 2) stiffness and damping of what leads each
    are_linked: whether the links of an arm join them, and what leads them acts in continuous time
    """
    blocks: list[Block] = []
    for j, (body, (stiffness, damping)) in enumerate(zip(bodies, answers.tolist(), strict=True), 1):
        leads = controller("spring_damper", {"stiffness": stiffness, "damping": damping})
        loads = {f"F{j}": 1} | ({f"F_L{j}": 1} if are_linked else {})
        blocks += [
            Moving(f"Z{j}", body, f"X{j}", f"U{j}", loads, f"F{j}"),
            Control(f"led{j}", leads, f"X{j}", f"F_X{j}", f"X{j}", analog=are_linked),
        ]
    numbers = range(1, len(bodies) + 1)
    names = tuple(f"X{j}" for j in numbers)
    if are_linked:
        # all entries, also those that are zero at one pose: the values change from row to row
        links = matrix_impedance(mass=np.ones((len(bodies), len(bodies))))
        blocks.append(Linked("Z_L", links, names, tuple(f"F_L{j}" for j in numbers)))
    sums = tuple(Junction(f"U{j}", {f"F_led{j}": 1, f"F_X{j}": -1}) for j in numbers)
    outside = {f"{name}{j}": "force" for name in ("F_led", "F") for j in numbers}
    return Diagram("led bodies", tuple(blocks), sums, outside, names)


def dead_times(body: Body) -> tuple[str, ...]:
    """Names of the body's parameters that are dead times, such as "actuation_delay.delay"."""
    symbols, names = body.symbols(), []
    for effect in body.effects:
        late = {call.args[1] for call in effect.expression().atoms(delayed)}
        names += [
            n for n in (f"{effect.name}.{p}" for p in effect.parameters) if symbols[n] in late
        ]
    return tuple(names)


def as_led(motion: Motion, course: Course) -> Motion:
    """The motion with the position and command of a course, from time 0; the rest unchanged."""
    return replace(
        motion,
        time=motion.time - motion.time[0],
        position=course.position,
        command=course.command,
    )


def with_whole_dead_times(body: Body, motion: Motion) -> Body:
    """The body with its dead times rounded to multiples of the simulation step `grid`."""
    step = grid(motion)
    times = {n: step * round(body.parameters[n].value / step) for n in dead_times(body)}
    return body.with_values(times)
