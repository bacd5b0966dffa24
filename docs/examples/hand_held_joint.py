"""A joint that a hand moves, by formulas of its own: no line of the package."""

import numpy as np

PERIOD, INNER, STEP = 1e-3, 10, 3e-4  # s, -, rad of the encoder
INERTIA, DAMPING, LEVEL = 0.01, 0.03, 0.25
COGGING, PITCH, PHASE = 0.12, 0.57, 0.3


def record(seconds, computer, wide, level=LEVEL):
    """t, q, u, hand of a motion about `wide` rad; computer: reads q, filtered speed -> u."""
    t = np.arange(0, seconds, PERIOD / INNER)
    w = 2 * np.pi * np.array([0.35, 0.83, 1.9])
    a, p = wide * np.array([1.0, 0.35, 0.06]), np.array([0.0, 0.4, 1.1])
    angle = np.outer(t, w) + p
    x, v = np.sin(angle) @ a, np.cos(angle) @ (a * w)
    need = INERTIA * (-np.sin(angle) @ (a * w**2)) + DAMPING * v + level * np.sign(v)
    need += COGGING * np.sin(2 * np.pi * x / PITCH + PHASE)
    q = np.round(x[::INNER] / STEP) * STEP
    speed, part = np.zeros(len(q)), 1 - np.exp(-2 * np.pi * 50 * PERIOD)
    for k in range(1, len(q)):
        speed[k] = speed[k - 1] + part * ((q[k] - q[k - 1]) / PERIOD - speed[k - 1])
    u = computer(t[::INNER], q, speed)
    acting = np.repeat(np.concatenate([[0.0], u[:-1]]), INNER)  # a period later
    noise = 0.003 * np.random.default_rng(1).standard_normal(len(q))
    return {"t": t[::INNER], "q": q, "u": u, "hand": (need - acting)[::INNER] + noise}


def bristle(q, level, stiffness):
    """Friction that follows a reading: a spring that gives way at its level."""
    z = np.zeros(len(q))
    for k in range(1, len(q)):
        travel = q[k] - q[k - 1]
        end = np.sign(travel) * level / stiffness
        left = np.exp(-stiffness * abs(travel) / level)  # 1 at rest
        z[k] = end * (1 - left) + z[k - 1] * left
    return stiffness * z
