"""What `estimate_error` says of a simulation, against the true error of drawn machines."""

import os

import numpy as np
import pytest
from exact.machines import Belt, Bristle, Gap, LateSpring, Relay, Stroke
from exact.simulated import draw, pair

from teleopdesign.simulate import simulate

CASES = int(os.environ.get("TELEOPDESIGN_MACHINES", "48"))
TIMES = 1e-3 * np.arange(201)
#: of the largest size: below it stands the rounding of the exact motions themselves
ROUNDING = 1e-9
#: s: of the step that is simulated, the shortest that the estimate has
QUARTER = 0.25e-4
MACHINES = (
    Belt(),
    Bristle(),
    Bristle(extra=0.3, bristle_damping=20.0),
    Stroke(),
    Gap(),
    Gap(stiffness=2e4, damping=5.0),
    Relay(),
    LateSpring(),
)


def at_a_jump(both, name):
    """Samples within a quarter of a step of the instant at which a force begins or ends.

    A contact that is damped begins and ends with a jump: that near to it both values are right.
    """
    beside = np.stack([TIMES - QUARTER, TIMES + QUARTER], axis=1).ravel()[1:]
    force = np.r_[0.0, both.exact(np.r_[0.0, beside])[name][1:]].reshape(-1, 2)
    return (force[:, 0] == 0.0) != (force[:, 1] == 0.0)


def estimated_and_true(machine):
    """Of each column, the estimate and the true error, both over the largest size."""
    both = pair(machine)
    exact = both.exact(TIMES)
    jumps = isinstance(machine, Gap) and machine.damping > 0.0
    result = simulate(
        both.diagram, duration=float(TIMES[-1]), **both.arguments, estimate_error=True
    )
    for name, (signal, more) in both.columns.items():
        error = np.abs(result[signal].values + more(TIMES) - exact[name])
        if jumps and name == "force":
            error[at_a_jump(both, name)] = 0.0
        yield result[signal].attrs["step_error"], error.max() / np.abs(result[signal].values).max()


@pytest.mark.slow
def test_the_estimate_is_never_below_half_of_the_true_error():
    """Bristles, belts, gaps soft and hard, relays and delays, each value within a factor of 4."""
    rng = np.random.default_rng(int(os.environ.get("TELEOPDESIGN_SEED", "2")))
    wrong, held = [], 0
    for case in range(CASES):
        machine = draw(rng, MACHINES[case % len(MACHINES)])
        for estimate, error in estimated_and_true(machine):
            held += error > ROUNDING
            if error > ROUNDING and estimate < 0.5 * error:
                wrong.append((estimate, error, machine))
    assert not wrong, wrong[:3]
    assert held > CASES  # columns whose error is no rounding
