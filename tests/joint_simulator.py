"""A motor joint with friction that falls with speed, in code that shares none of the package.

    J dv/dt = u + hand - b v - (c + s exp(-(v/v_s)^2)) sgn v,    stuck while |u + hand| <= c + s

A computer at 1 kHz lets the joint follow a slow and a fast motion, by an encoder; a hand pushes.
"""

from math import copysign, exp

import numpy as np

INERTIA, DAMPING, LEVEL = 0.012, 0.05, 0.2  # kg*m^2, N*m*s/rad, N*m
EXTRA, SPEED = 0.15, 0.25  # N*m, rad/s
ENCODER = 2 * np.pi / 20000  # rad
_STEPS = 20  # of 50 us in a row


def simulate_joint(seconds, seed=3):
    """t (s), q (rad, as the encoder reads it), u and hand (N*m), each (n,), at 1 kHz."""
    n = 1000 * seconds
    t = np.arange(n) / 1000
    wanted = 0.9 * np.sin(1.45 * t) + 0.25 * np.sin(4.5 * t + 1) + 0.08 * np.sin(14.5 * t + 2)
    speed = np.gradient(wanted, t)
    hand = 0.25 * np.sin(2.3 * t + 0.4) + 0.15 * np.sin(8.2 * t) * np.sin(0.7 * t)
    q, v, slow, before = wanted[0], 0.0, 0.0, wanted[0]
    read, command = np.empty(n), np.empty(n)
    step = 1e-3 / _STEPS
    for k in range(n):
        read[k] = ENCODER * round(q / ENCODER)
        slow += 0.2 * (1000 * (read[k] - before) - slow)
        before = read[k]
        command[k] = np.clip(14 * (wanted[k] - read[k]) + 0.35 * (speed[k] - slow), -4, 4)
        push = float(command[k] + hand[k])
        for _ in range(_STEPS):
            if v == 0.0 and abs(push) <= LEVEL + EXTRA:
                break
            sign = copysign(1.0, v or push)
            level = LEVEL + EXTRA * exp(-((v / SPEED) ** 2))
            after = v + step * (push - DAMPING * v - level * sign) / INERTIA
            after = 0.0 if v * after < 0 else after
            q, v = q + 0.5 * step * (v + after), after
    noise = 0.004 * np.random.default_rng(seed).standard_normal(n)
    return {"t": t, "q": read, "u": command, "hand": hand + noise}
