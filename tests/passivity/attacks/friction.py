"""Friction and what cancels it along legs of one speed, for many motions at once.

A motion is an array (n, legs, 3): travel of each leg (m, with sign), speed (> 0), and the share of
the range between lowest and highest level at which friction stands in that leg. Forces of bristles
start at 0; what is returned is the largest energy given out at the end of any leg, J.
"""

import numpy as np


def bristle(force, travel, level, stiffness):
    """(force after, work taken) of Dahl friction over travels of one sign, by its exponential."""
    s = np.sign(travel)
    y = np.abs(travel) * stiffness / level
    gone = -np.expm1(-y)
    linear = np.where(y < 1e-3, y * y / 2 - y**3 / 6 + y**4 / 24, y - gone)
    work = level * level / stiffness * linear + s * force * level / stiffness * gone
    return force + gone * (s * level - force), work


def largest(motions, helped, resisted):
    """helped, resisted: state, travel, speed, share -> (state after, work); states start at 0."""
    n = len(motions)
    helping, resisting, out = np.zeros(n), np.zeros(n), np.zeros(n)
    most = np.full(n, -np.inf)
    for k in range(motions.shape[1]):
        travel, speed, share = motions[:, k].T
        speed, share = np.abs(speed), np.abs(share) % 1.0
        helping, gave = helped(helping, travel, speed, share)
        resisting, took = resisted(resisting, travel, speed, share)
        out = out + gave - took
        most = np.maximum(most, out)
    return most


def drawn(rng, number, legs, lengths, speeds=(1.0,)):
    """Motions over the lengths and speeds of the parts; many that come back, and that tremble."""
    size = rng.choice(lengths, (number, 1)) * 10 ** rng.uniform(-2, 2, (number, 1))
    travel = size * 10 ** rng.uniform(-1, 1, (number, legs)) * rng.choice([-1, 1], (number, legs))
    turns = rng.random((number, 1)) < 0.5
    travel = np.where(turns, np.abs(travel) * (-1.0) ** np.arange(legs), travel)
    even = rng.random((number, 1)) < 0.3
    travel = np.where(even, size * (-1.0) ** np.arange(legs) * (1 + (np.arange(legs) > 0)), travel)
    speed = rng.choice(speeds, (number, legs)) * 10 ** rng.uniform(-2, 2, (number, legs))
    return np.stack([travel, speed, rng.random((number, legs))], axis=2)
