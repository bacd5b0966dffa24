"""Simulated motion of an arm: the motion of its model under the recorded commands of all joints.

The bodies of all joints are one diagram, joined by the inertia matrix of the links. Friction and
every other effect at a joint belong to its body, in the loop that simulates any diagram. The force
of the links changes slowly compared with friction. So over a row of the record, their inertia
matrix and their force at zero acceleration are those in the middle of the row, at a motion
extrapolated from the last rates.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arms.regressor import columns_with_motors
from ..blocks import Body, matrix_impedance
from ..controllers import controller
from ..diagrams import Block, Control, Diagram, Junction, Linked, Moving
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..realise.bristle import with_bristle
from ..realise.kernel import Timing, fastest_rate, first_memory, grid
from ..realise.program import Program
from ..realise.simulated import without_absent
from ..realise.steps import FASTEST
from ..realise.tips import tip
from ..simulate import Sampling, Setup, prepare
from .parts import PreparedParts
from .simulated_course import MOST_STEPS, dead_times


@dataclass(frozen=True)
class ArmLinks:
    """The links of an arm: values of their inertial parameters, and the columns of these.

    values: (b,);  chosen: (b,) columns of the regressor
    carried: (k, k) inertia of the links that the joints' bodies have already, less the inertia of
        couplings
    """

    prepared: PreparedParts
    values: Array
    chosen: NDArray[np.intp]
    carried: Array

    def needed(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Inertia matrix (n, k, k) and force at zero acceleration (k, n), less that of the bodies.

        position, velocity: (k, n)
        """
        arm = self.prepared.experiment.arm
        assert arm is not None
        k, n = position.shape
        rates = np.zeros((2, k, k + 2, n))
        rates[0, :, 0] = velocity
        rates[1, :, 2:] = np.eye(k)[:, :, None]
        poses = np.repeat(position[:, None], k + 2, axis=1).reshape(k, -1)
        columns = columns_with_motors(arm.arm, poses, *rates.reshape(2, k, -1))
        force = np.einsum("p,kpn->kn", self.values, columns[:, self.chosen]).reshape(k, k + 2, n)
        inertia = np.moveaxis(force[:, 2:] - force[:, 1:2], 2, 0)
        return inertia - self.carried, force[:, 0]


@dataclass(frozen=True, eq=False)
class LedArm:
    """The bodies of an arm along one stretch of a record, ready to simulate.

    motions: of the joints, at the same rows
    answers: (k, 2) stiffness and damping of the joints' controllers
    late: (k,) s, dead time of each joint's actuator;  wholes: (k,) inertias of the bodies
    least_steps: least number of inner steps in a row; fast oscillations need more
    beyond: speed over the fastest recorded one beyond which a course ends
    """

    links: ArmLinks
    motions: tuple[Motion, ...]
    setup: Setup
    answers: Array
    late: Array
    wholes: Array
    least_steps: int = 5
    beyond: float = 1e3

    @property
    def count(self) -> int:
        """Number of joints."""
        return len(self.motions)


def led_arm(
    links: ArmLinks,
    bodies: Sequence[Body],
    motions: Sequence[Motion],
    *,
    bristles: Sequence[float],
    answers: Array,
) -> LedArm:
    """Wire the joints' bodies.

    bristles: length of the bristle of ideal friction at each joint (m or rad)
    answers: (k, 2) stiffness and damping of the controller that holds each joint on its recorded
        motion
    This controller acts in continuous time, because a robot's loop is faster than its log. A dead
    time of an actuator delays the recorded command, but not the response of this controller.
    """
    late = [sum(body.parameters[n].value for n in dead_times(body)) for body in bodies]
    present = [
        with_bristle(without_absent(body.with_values(dict.fromkeys(dead_times(body), 0.0))), length)
        for body, length in zip(bodies, bristles, strict=True)
    ]
    zeros = {"F_led": lambda t: 0.0 * t, "F": lambda t: 0.0 * t}
    k, row = len(bodies), motions[0].sample_time
    setup = prepare(
        _wire_led_arm(present, answers),
        duration=row,
        inputs={f"{name}{j + 1}": zero for name, zero in zeros.items() for j in range(k)},
        computer=Sampling(period=row),
        step=row,
    )
    wholes = np.array([body.parameters["inertia"].value for body in bodies])
    return LedArm(links, tuple(motions), setup, answers, np.array(late), wholes)


def _wire_led_arm(bodies: Sequence[Body], answers: Array) -> Diagram:
    """The bodies on X1, X2 ... with U = F_led - (stiffness + damping s) X, joined by the links."""
    k = len(bodies)
    blocks: list[Block] = []
    for j, (body, (stiffness, damping)) in enumerate(zip(bodies, answers.tolist(), strict=True), 1):
        holds = controller("spring_damper", {"stiffness": stiffness, "damping": damping})
        loads = {f"F{j}": 1, f"F_L{j}": 1}
        blocks += [
            Moving(f"Z{j}", body, f"X{j}", f"U{j}", loads, f"F{j}"),
            Control(f"led{j}", holds, f"X{j}", f"F_X{j}", f"X{j}", analog=True),
        ]
    names = [f"X{j + 1}" for j in range(k)]
    # all entries, also those that are zero at one pose: the values change from row to row
    links = matrix_impedance(mass=np.ones((k, k)))
    blocks.append(Linked("Z_L", links, tuple(names), tuple(f"F_L{j + 1}" for j in range(k))))
    sums = [Junction(f"U{j + 1}", {f"F_led{j + 1}": 1, f"F_X{j + 1}": -1}) for j in range(k)]
    outside = {f"{name}{j + 1}": "force" for name in ("F_led", "F") for j in range(k)}
    return Diagram("led arm", tuple(blocks), tuple(sums), outside, tuple(names))


@dataclass(frozen=True, eq=False)
class _Loop:
    """The compiled loop of an arm, and the indices of its states and parameters.

    timing: of one row of the record
    parameters: of the whole loop;  entries: (k, k) indices of the links' inertia matrix in them
    joints: (2, k) indices of position and velocity of each joint
    ends: (2, k) the same of the bodies that carry the links: tips, where a structure divides a
        joint
    commands: (k, n) held from each row to the next
    followed: (k, n) force of the controllers at the measured motion;  interactions: (k, n)
    """

    made: Program
    timing: Timing
    parameters: Array
    entries: NDArray[np.intp]
    joints: NDArray[np.intp]
    ends: NDArray[np.intp]
    commands: Array
    followed: Array
    interactions: Array


def courses(
    led: LedArm, begins: NDArray[np.intp], lengths: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Simulated courses of one arm from several rows of its stretch, side by side.

    begins, lengths: (m,) first row of each course, and how many rows follow; hidden states start at
        zero
    returns: position and velocity of each joint (k, m, rows + 1); NaN after the end of a course,
        and after it exceeds `LedArm.beyond` or reaches a pose where the inertia matrix is not
        positive
    """
    loop = _loop_of(led, int(begins[0]))
    k, m, rows = led.count, len(begins), int(lengths.max())
    state = _first_states(led, loop, begins)
    x, v = np.full((2, k, m, rows + 1), np.nan)
    here, last = np.arange(m), np.zeros((k, m))
    before = state[:, loop.ends[1]].T.copy()
    row = led.motions[0].sample_time
    # a course with a speed so far beyond the recorded speeds grows without bound
    most = led.beyond * np.array([np.abs(m.velocity).max() for m in led.motions])
    for r in range(rows + 1):
        here = here[(np.abs(state[here][:, loop.ends[1]]) <= most).all(axis=1)]
        x[:, here, r], v[:, here, r] = (state[here][:, at].T for at in loop.joints)
        here = here[r < lengths[here]]
        if len(here) == 0:
            break
        place, speed = (state[here][:, at].T for at in loop.ends)
        if r > 0:
            last[:, here] = (speed - before[:, here]) / row
        before[:, here] = speed
        middle = place + 0.5 * row * speed, speed + 0.5 * row * last[:, here]
        inertia, force = led.links.needed(*middle)
        is_whole = _are_positive(inertia + np.diag(led.wholes))
        here, inertia, force = here[is_whole], inertia[is_whole], force[:, is_whole]
        for i, lane in enumerate(here.tolist()):
            _advance(loop, state[lane], int(begins[lane]) + r, inertia[i], force[:, i])
    return x, v


def _loop_of(led: LedArm, first: int) -> _Loop:
    made, values = led.setup.program, dict(led.setup.diagram.values)
    pose = np.array([[m.position[first]] for m in led.motions])
    inertia, _ = led.links.needed(pose, np.zeros_like(pose))
    names = [
        [f"Z_L.mass_{i}_{j}" for j in range(1, led.count + 1)] for i in range(1, led.count + 1)
    ]
    values |= dict(zip(np.ravel(names).tolist(), np.ravel(inertia).tolist(), strict=True))
    # the fastest oscillation at the first pose determines the number of steps in a row
    rate, _ = fastest_rate(made, values)
    steps = int(np.ceil(rate * led.motions[0].sample_time / FASTEST))
    layout = made.layout
    commands, followed = [], []
    for motion, late, (stiffness, damping) in zip(led.motions, led.late, led.answers, strict=True):
        then = motion.time + motion.command_late - late
        commands.append(np.interp(then, motion.time, motion.command))
        followed.append(stiffness * motion.position + damping * motion.velocity)
    return _Loop(
        made=made,
        timing=led.setup.timing(min(max(steps, led.least_steps), MOST_STEPS)),
        parameters=np.array([values[p] for p in layout.parameters]),
        entries=np.array([[layout.parameters.index(n) for n in row] for row in names]),
        joints=_rows_of(layout.states, led.count, tips=False),
        ends=_rows_of(layout.states, led.count, tips=True),
        commands=np.array(commands),
        followed=np.array(followed),
        interactions=np.array([m.interaction for m in led.motions]),
    )


def _rows_of(states: Sequence[str], count: int, *, tips: bool) -> NDArray[np.intp]:
    """Indices of position and velocity (2, k) of each joint, or of its tip where it has one."""
    motions = [f"X{j + 1}" for j in range(count)]
    if tips:
        motions = [tip(m) if tip(m) in states else m for m in motions]
    return np.array([[states.index(f"{m}{end}") for m in motions] for end in ("", "_velocity")])


def _first_states(led: LedArm, loop: _Loop, begins: NDArray[np.intp]) -> Array:
    """States (m, states): on the measured motion, all hidden states zero."""
    state = np.zeros((len(begins), len(loop.made.layout.states)))
    for j, motion in enumerate(led.motions):
        for at in (loop.joints, loop.ends):
            state[:, at[0, j]] = motion.position[begins]
            state[:, at[1, j]] = motion.velocity[begins]
    return state


def _are_positive(matrices: Array) -> NDArray[np.bool_]:
    """Whether each of the matrices (n, k, k) is finite and positive definite."""
    is_number = np.all(np.isfinite(matrices), axis=(1, 2), keepdims=True)
    size = np.where(is_number, matrices, 0.0)
    return np.asarray(np.linalg.eigvalsh(0.5 * (size + np.swapaxes(size, 1, 2)))[:, 0] > 0.0)


def _advance(loop: _Loop, state: Array, row: int, inertia: Array, force: Array) -> None:
    """Advance a state (states,) by one row, in place.

    inertia: (k, k) of the links beyond the bodies';  force: (k,) of the links; both constant over
        the row
    """
    made, timing, layout = loop.made, loop.timing, loop.made.layout
    parameters = loop.parameters.copy()
    parameters[loop.entries] = inertia
    part = np.linspace(0.0, 1.0, 2 * timing.inner + 1)
    interaction, followed = (
        x[:, row, None] + part * (x[:, row + 1, None] - x[:, row, None])
        for x in (loop.interactions, loop.followed)
    )
    signals = {"F": interaction - force[:, None], "F_led": loop.commands[:, row, None] + followed}
    memory = first_memory(made, 1, parameters, {})
    memory[: len(state)] = state
    nowhere, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
    with np.errstate(all="ignore"):  # a course that grows without bound ends in inf or NaN
        made.loop.run(
            *grid(made, timing, 1),
            False,
            _arrange_signals(layout.inputs, signals),
            np.zeros((0, timing.samples + 1)),
            memory,
            nowhere,
            nothing,
            np.inf,
            timing.samples + 1,
            nowhere,
            nowhere,
            nowhere,
            nothing,
        )
    state[:] = memory[: len(state)]


def _arrange_signals(names: Sequence[str], signals: Mapping[str, Array]) -> Array:
    """The joints' signals (k, n) in the order of the loop's inputs; "F2" is that of joint 2."""
    places = [re.fullmatch(r"(\D+)(\d+)", name) for name in names]
    return np.array([signals[at[1]][int(at[2]) - 1] for at in places if at is not None])
