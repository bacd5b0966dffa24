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

from ..blocks import Body
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..realise.bristle import with_bristle
from ..realise.kernel import Timing, fastest_rate, first_memory, grid
from ..realise.program import Program
from ..realise.simulated import without_absent
from ..realise.steps import FASTEST
from ..realise.tips import tip
from ..simulate import Sampling, prepare
from .parts import ArmLinks
from .simulated_course import MOST_STEPS, dead_times, wire_led_bodies

#: least number of inner steps in a row; fast oscillations need more
LEAST_STEPS = 5
#: speed over the fastest recorded one beyond which a course ends: it grows without bound
BEYOND = 1e3


@dataclass(frozen=True, eq=False)
class LedArm:
    """The k bodies of an arm along one stretch of a record, in one compiled loop.

    motions: of the joints, at the same rows;  wholes: (k,) inertias of the bodies
    timing: of one row of the record
    parameters: of the whole loop;  entries: (k, k) indices of the links' inertia matrix in them
    joints: (2, k) indices of position and velocity of each joint among the states
    ends: (2, k) the same of the bodies that carry the links: tips, where a structure divides a
        joint
    commands: (k, n) held from each row to the next
    followed: (k, n) force of the controllers at the measured motion;  interactions: (k, n)
    """

    links: ArmLinks
    motions: tuple[Motion, ...]
    wholes: Array
    made: Program
    timing: Timing
    parameters: Array
    entries: NDArray[np.intp]
    joints: NDArray[np.intp]
    ends: NDArray[np.intp]
    commands: Array
    followed: Array
    interactions: Array


def led_arm(
    links: ArmLinks,
    bodies: Sequence[Body],
    motions: Sequence[Motion],
    *,
    bristles: Sequence[float],
    answers: Array,
    first: int,
) -> LedArm:
    """Wire the joints' bodies.

    bristles: length of the bristle of ideal friction at each joint (m or rad)
    answers: (k, 2) stiffness and damping of the controller that holds each joint on its recorded
        motion;  first: row at whose pose the fastest oscillation is sought
    This controller acts in continuous time, because a robot's loop is faster than its log. A dead
    time of an actuator delays the recorded command, but not the response of this controller.
    """
    present = [
        with_bristle(without_absent(body.with_values(dict.fromkeys(dead_times(body), 0.0))), length)
        for body, length in zip(bodies, bristles, strict=True)
    ]
    k, row = len(bodies), motions[0].sample_time
    setup = prepare(
        wire_led_bodies(present, answers, are_linked=True),
        duration=row,
        inputs={f"{name}{j + 1}": lambda t: 0.0 * t for name in ("F_led", "F") for j in range(k)},
        computer=Sampling(period=row),
        step=row,
    )
    made, values, layout = setup.program, dict(setup.diagram.values), setup.program.layout
    pose = np.array([[m.position[first]] for m in motions])
    inertia, _ = links.needed(pose, np.zeros_like(pose))
    names = [[f"Z_L.mass_{i}_{j}" for j in range(1, k + 1)] for i in range(1, k + 1)]
    values |= dict(zip(np.ravel(names).tolist(), np.ravel(inertia).tolist(), strict=True))
    # the fastest oscillation at the first pose determines the number of steps in a row
    rate, _ = fastest_rate(made, values)
    steps = int(np.ceil(rate * row / FASTEST))
    commands, followed = [], []
    for body, motion, (stiffness, damping) in zip(bodies, motions, answers, strict=True):
        late = sum(body.parameters[n].value for n in dead_times(body))
        then = motion.time + motion.command_late - late
        commands.append(np.interp(then, motion.time, motion.command))
        followed.append(stiffness * motion.position + damping * motion.velocity)
    x = [f"X{j + 1}" for j in range(k)]
    tips = [tip(name) if tip(name) in layout.states else name for name in x]
    joints, ends = (
        np.array([[layout.states.index(n + end) for n in each] for end in ("", "_velocity")])
        for each in (x, tips)
    )
    return LedArm(
        links=links,
        motions=tuple(motions),
        wholes=np.array([body.parameters["inertia"].value for body in bodies]),
        made=made,
        timing=setup.timing(min(max(steps, LEAST_STEPS), MOST_STEPS)),
        parameters=np.array([values[p] for p in layout.parameters]),
        entries=np.array([[layout.parameters.index(n) for n in each] for each in names]),
        joints=joints,
        ends=ends,
        commands=np.array(commands),
        followed=np.array(followed),
        interactions=np.array([m.interaction for m in motions]),
    )


def courses(led: LedArm, spans: Sequence[slice]) -> list[Array]:
    """Simulated position and velocity (2, k, rows) of one arm over several spans of rows.

    Each begins on the measured motion, with hidden states at zero. All are simulated side by side.
    returns: NaN after a course exceeds `BEYOND` or reaches a pose where the inertia matrix is not
        positive
    """
    begins, stops = np.array([(span.start, span.stop) for span in spans]).T
    lengths = stops - 1 - begins
    k, m, rows = len(led.motions), len(begins), int(lengths.max())
    state = np.zeros((m, len(led.made.layout.states)))
    for j, motion in enumerate(led.motions):
        for at in (led.joints, led.ends):
            state[:, at[0, j]] = motion.position[begins]
            state[:, at[1, j]] = motion.velocity[begins]
    x, v = both = np.full((2, k, m, rows + 1), np.nan)
    here, last = np.arange(m), np.zeros((k, m))
    before = state[:, led.ends[1]].T.copy()
    row = led.motions[0].sample_time
    most = BEYOND * np.array([np.abs(m.velocity).max() for m in led.motions])
    for r in range(rows + 1):
        here = here[(np.abs(state[here][:, led.ends[1]]) <= most).all(axis=1)]
        x[:, here, r], v[:, here, r] = (state[here][:, at].T for at in led.joints)
        here = here[r < lengths[here]]
        if len(here) == 0:
            break
        place, speed = (state[here][:, at].T for at in led.ends)
        if r > 0:
            last[:, here] = (speed - before[:, here]) / row
        before[:, here] = speed
        middle = place + 0.5 * row * speed, speed + 0.5 * row * last[:, here]
        inertia, force = led.links.needed(*middle)
        is_whole = _are_positive(inertia + np.diag(led.wholes))
        here, inertia, force = here[is_whole], inertia[is_whole], force[:, is_whole]
        for i, lane in enumerate(here.tolist()):
            _advance(led, state[lane], int(begins[lane]) + r, inertia[i], force[:, i])
    return [both[:, :, i, : n + 1] for i, n in enumerate(lengths.tolist())]


def _are_positive(matrices: Array) -> NDArray[np.bool_]:
    """Whether each of the matrices (n, k, k) is finite and positive definite."""
    is_number = np.all(np.isfinite(matrices), axis=(1, 2), keepdims=True)
    size = np.where(is_number, matrices, 0.0)
    return np.asarray(np.linalg.eigvalsh(0.5 * (size + np.swapaxes(size, 1, 2)))[:, 0] > 0.0)


def _advance(led: LedArm, state: Array, row: int, inertia: Array, force: Array) -> None:
    """Advance a state (states,) by one row, in place.

    inertia: (k, k) of the links beyond the bodies';  force: (k,) of the links; both constant over
        the row
    """
    made, timing = led.made, led.timing
    parameters = led.parameters.copy()
    parameters[led.entries] = inertia
    part = np.linspace(0.0, 1.0, 2 * timing.inner + 1)
    interaction, followed = (
        x[:, row, None] + part * (x[:, row + 1, None] - x[:, row, None])
        for x in (led.interactions, led.followed)
    )
    signals = {"F": interaction - force[:, None], "F_led": led.commands[:, row, None] + followed}
    memory = first_memory(made, 1, parameters, {})
    memory[: len(state)] = state
    nowhere, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
    with np.errstate(all="ignore"):  # a course that grows without bound ends in inf or NaN
        made.loop.run(
            *grid(made, timing, 1),
            False,
            _arrange_signals(made.layout.inputs, signals),
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
