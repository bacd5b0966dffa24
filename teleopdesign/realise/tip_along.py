"""Force of a tip body along a measured motion, per unit of its inertia.

A tip behind a transmission with a gap, which dry friction slows:

    dw/dt = f - d sgn w,   f = q^2 (s -+ g/2) + 2 z q (v - w) outside the gap, abs(s) > g/2, else 0

s is the position of the actuator's side minus that of the tip, v and w are their velocities. The
inertia m_t of the tip is not in this equation: the force on the tip is m_t f. So one motion of the
tip serves every m_t, with the stiffness m_t q^2, the damping 2 m_t z q and the level m_t d.

Thousands of motions are cheap: no tangents, no correction by the residual. They give the start of
a search; the laws of `effects` give its end (tests compare the two).
"""

from __future__ import annotations

import math

import numpy as np

from ..base.machine import compile_and_keep
from ..measurement.filtering import Array

#: rad: angle of the swinging tip in one step, some 38 steps in a period. The force agrees with an
#: integration within 10 %. A smaller angle is slower; with a larger one the solution drifts from
#: that of the laws
SWING = 1.0 / 6.0


def tip_along(
    position: Array,
    velocity: Array,
    sample_time: float,
    *,
    gap: float,
    swing: float,
    damping_ratio: float,
    slowing: float,
) -> Array:
    """Acceleration (n,) that the transmission gives the tip: f of this file, mean of each row.

    position, velocity: (n,) of the actuator's side, m or rad;  gap: g, its width
    swing: q, rad/s, natural frequency of the tip in contact;  damping_ratio: z
    slowing: d, deceleration of a sliding tip by dry friction (m/s^2, rad/s^2)
    """
    steps = max(1, math.ceil(swing * sample_time / SWING))
    return _follow_tip(
        np.ascontiguousarray(position),
        np.ascontiguousarray(velocity),
        sample_time / steps,
        (0.5 * gap, swing**2, 2.0 * damping_ratio * swing, slowing),
        steps,
    )


@compile_and_keep
def _follow_tip(
    position: Array,
    velocity: Array,
    step: float,
    law: tuple[float, float, float, float],
    steps: int,
) -> Array:
    """Semi-implicit steps of one tip that starts in the middle of its gap, at the same speed.

    step: s, of one of `steps` steps per row;  law: half of the gap, stiffness, damping and slowing
    """
    half, stiffness, damping, slowing = law
    out = np.zeros(len(position))
    here, speed = position[0], velocity[0]
    for k in range(len(position) - 1):
        whole = 0.0
        for i in range(steps):
            part = i / steps
            ahead = position[k] + (position[k + 1] - position[k]) * part - here
            faster = velocity[k] + (velocity[k + 1] - velocity[k]) * part - speed
            if ahead > half:
                pull = stiffness * (ahead - half) + damping * faster
            elif ahead < -half:
                pull = stiffness * (ahead + half) + damping * faster
            else:
                pull = 0.0
            whole += pull
            speed += step * pull
            if speed > 0.0:
                speed = max(speed - step * slowing, 0.0)
            elif speed < 0.0:
                speed = min(speed + step * slowing, 0.0)
            here += step * speed
        out[k] = whole / steps
    out[-1] = out[-2]
    return out
