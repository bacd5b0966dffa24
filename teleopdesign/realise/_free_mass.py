# ruff: noqa: F401, F403, F405, F841
"""Laws of a free mass under a force and a command, as `_codegen.py` writes them.

Input 0 is the force, sampled input 0 the command, parameter 0 the mass. The loop of `integrator.py`
is read and tested with these laws; a test compares them with the generated source.
"""

from math import *

import numpy as np


def jitted(function):
    return function


entry = jitted
round_down = np.floor


@jitted
def column_at(place, memory):
    return memory[place]


LANES = 1


@jitted
def phi_near(z):
    """exp, phi_1, phi_2, phi_3 of z by their series, within abs(z) < 1."""
    p3 = 1 / 6.0 + z * (
        1 / 24.0
        + z
        * (
            1 / 120.0
            + z
            * (
                1 / 720.0
                + z
                * (
                    1 / 5040.0
                    + z
                    * (
                        1 / 40320.0
                        + z
                        * (
                            1 / 362880.0
                            + z
                            * (
                                1 / 3628800.0
                                + z
                                * (
                                    1 / 39916800.0
                                    + z
                                    * (
                                        1 / 479001600.0
                                        + z
                                        * (
                                            1 / 6227020800.0
                                            + z * (1 / 87178291200.0 + z * (1 / 1307674368000.0))
                                        )
                                    )
                                )
                            )
                        )
                    )
                )
            )
        )
    )
    p2 = z * p3 + 0.5
    p1 = z * p2 + 1.0
    return z * p1 + 1.0, p1, p2, p3


@jitted
def phi(z):
    """exp, phi_1, phi_2, phi_3 of z, accurate through zero."""
    if abs(z) < 1.0:
        return phi_near(z)
    e = exp(z)
    p1 = (e - 1.0) / z
    p2 = (p1 - 1.0) / z
    return e, p1, p2, (p2 - 0.5) / z


@jitted
def weights(z, is_near):
    """exp and phi_1 of z/2, exp of z, and the three weights of a step;  is_near: abs(z) < 2."""
    e, p1, p2, p3 = phi_near(z / 2) if is_near else phi(z / 2)
    q1 = 0.5 * (e + 1.0) * p1
    q2 = 0.25 * (p1 * p1 + 2 * p2)
    q3 = 0.125 * (p1 * p2 + p2 + 2 * p3)
    return e, p1, e * e, q1 - 3 * q2 + 4 * q3, 2 * q2 - 4 * q3, 4 * q3 - q2


STATES = 0
BRISTLES = 2
COMPUTER_STATES = 2
COMMANDS = 2
NEW_COMMANDS = 3
LATE = 4
LATE_MIDDLE = 4
LATE_END = 4
LATE_VALUES = 4
SAMPLED_LATE = 4
SAMPLED_LATE_VALUES = 4
STAGE_STATES = 4
STAGE_BRISTLES = 6
FIRST_BRISTLES = 6
RATES_0 = 6
RATES_1 = 8
RATES_2 = 10
RATES_3 = 12
RESTS_0 = 14
RESTS_1 = 14
RESTS_2 = 14
RESTS_3 = 14
SLOPES = 14
LAST_SLOPES = 14
WORST = 14
E_HALF = 14
G_HALF = 14
E_STEP = 14
WEIGHT_0 = 14
WEIGHT_1 = 14
WEIGHT_3 = 14
POSITIONS = 14
VELOCITIES = 15
LAST_READING = 16
TRAVEL = 17
KNOWN = 18
OBSERVED = 19
BEND = 20
NOW = 21
MADE = 24
COLUMNS = 25
SPOILED = 31
PARAMETERS = 32
INVERSES = 33
MANY_MOTIONS = 1
MANY_STATES = 2
MANY_BRISTLES = 0
MANY_COMMANDS = 1
MANY_LATE = 0
MANY_SAMPLED_LATE = 0
MANY_COLUMNS = 6
MANY_PARAMETERS = 1
ROWS = 34
SMOOTH = (True,)
COMPUTER = True
OBSERVER = 0


@jitted
def inputs_at(table, column):
    column = min(column, table.shape[1] - 1)
    return (
        table[0, column],
        table[1, column],
        0.0,
    )


@jitted
def sampled_inputs_at(table, column):
    column = min(column, table.shape[1] - 1)
    return (
        table[0, column],
        0.0,
    )


@jitted
def find_inverses(memory, lane):
    p0 = memory[PARAMETERS + lane]
    out0 = 1 / p0
    memory[INVERSES + lane] = out0


@jitted
def rates(time, states, bristles, inputs, late, memory, to_states, to_bristles, lane):
    v1_ = memory[states + 1 + lane]
    v7_ = memory[COMMANDS + lane]
    v2_ = inputs[0]
    i0_ = memory[INVERSES + lane]
    out0 = v1_
    out1 = i0_ * (v2_ + v7_)
    memory[to_states + lane] = out0
    memory[to_states + 1 + lane] = out1


@jitted
def slopes(time, states, bristles, inputs, late, memory, to, lane):
    pass


@jitted
def signals(time, states, bristles, inputs, late, memory, to, lane):
    v7_ = memory[COMMANDS + lane]
    v2_ = inputs[0]
    v3_ = inputs[1]
    i0_ = memory[INVERSES + lane]
    out0 = i0_ * (v2_ + v7_)
    out1 = -v2_
    out2 = v2_ + v3_
    memory[to + lane] = out0
    memory[to + 1 + lane] = out1
    memory[to + 2 + lane] = out2


@jitted
def late_values(time, states, bristles, inputs, late, memory, to, lane):
    pass


@jitted
def motions(states, inputs, memory, to_positions, to_velocities, lane):
    memory[to_positions + lane] = memory[states + lane]
    memory[to_velocities + lane] = memory[states + 1 + lane]


@jitted
def record(inputs, memory, to, lane):
    memory[to + lane] = memory[STATES + lane]
    memory[to + 1 + lane] = memory[STATES + 1 + lane]
    memory[to + 2 + lane] = memory[NOW + lane]
    memory[to + 3 + lane] = memory[NOW + 1 + lane]
    memory[to + 4 + lane] = memory[NOW + 2 + lane]
    memory[to + 5 + lane] = memory[MADE + lane]


@jitted
def computer_before(n, period, sampled, memory, lane):
    pass


@jitted
def computer_signals(n, period, sampled, memory, to, lane):
    v3_ = sampled[0]
    out0 = v3_
    memory[to + lane] = out0


@jitted
def computer_late(n, period, sampled, memory, to, lane):
    pass


@jitted
def computer_after(n, period, sampled, memory, lane):
    pass


@jitted
def held_commands(n, sampled, memory, to, lane):
    memory[to + lane] = memory[MADE + lane]
