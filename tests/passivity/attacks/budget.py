"""How many random systems each attack takes, and a climb that several attackers share.

`TELEOPDESIGN_ATTACKS=2000 pytest tests/passivity/attacks -m slow`: 2000 systems of each kind;
`TELEOPDESIGN_ATTACK_SEED=7` draws others. Attackers import nothing of the package but the function
that makes the claim: their equations, integration and optimisation are their own.
"""

import os

import numpy as np
import pytest

#: of the random systems; another one draws others
SEED = int(os.environ.get("TELEOPDESIGN_ATTACK_SEED", "1"))


def attacked(plain, slow):
    """Parameters (seed, number): few systems in the plain run, in `slow` as many as are asked.

    plain: 0 where even a few take seconds
    """
    count = int(os.environ.get("TELEOPDESIGN_ATTACKS", slow))
    drawn = [pytest.param(SEED + 1000, count, marks=pytest.mark.slow, id="many")]
    if plain:
        drawn.insert(0, pytest.param(SEED, plain, id="sample"))
    return pytest.mark.parametrize(("seed", "number"), drawn)


def climbed(rng, energy, start, rounds=40, spread=0.3):
    """The most that `energy` gives, over motions (n, ...) and steps from the best tenth of them.

    energy: motions (n, ...) -> (n,), larger is worse for the claim
    """
    motions = start
    out = energy(motions)
    keep = max(len(motions) // 10, 1)
    for k in range(rounds):
        best = np.argsort(-out)[:keep]
        parents = motions[best[rng.integers(0, keep, len(motions) - keep)]]
        step = spread * 0.5 ** (6 * k / rounds)
        change = np.exp(step * rng.standard_normal(parents.shape))
        turned = np.where(rng.random(parents.shape) < 0.02, -1.0, 1.0)
        motions = np.concatenate([motions[best], parents * change * turned])
        out = np.concatenate([out[best], energy(motions[keep:])])
    k = int(np.argmax(out))
    return float(out[k]), motions[k]


def near(rng, limit):
    """A value about a limit, as often a hair as a decade beside it, or on it."""
    beside = 10 ** rng.uniform(-6, 0)
    return limit * float(rng.choice([1, 1 - min(beside, 0.9), 1 + beside, 1 - min(beside, 0.9)]))
