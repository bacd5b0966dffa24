# ruff: noqa: F821
# mypy: disable-error-code="name-defined"
"""The simulation loop: exponential Runge-Kutta of order four around the laws of one structure.

Cox, Matthews, J. Comput. Phys. 176 (2002) 430, eqs (26) to (29), with the rate of a bristle split
as A z + B, A frozen at the start of the step; for all other states the classical Runge-Kutta
method. At every sample the computer reads its sensors and steps its states as its laws say.

Several simulations of one grid run side by side in lanes; one lane is a simulation by itself. The
state of the loop is `memory`: a row for each quantity, with an entry for each lane. A constant such
as STATES is the place where its group begins, MANY_STATES the size of the group: state i of a lane
is `memory[STATES + i * LANES + lane]`. With constant addresses the compiler keeps a step in
registers, and computes several lanes by one instruction, as long as a step reads from `memory` only
(parameters are in it) or from no array (inputs are passed as numbers). It computes one lane after
the other where it would have to check too often that two arrays do not overlap.

Everything below the line of "#" is the second half of every generated module. The first half has
the laws, such as `rates` and `slopes`, constants such as STATES (`_codegen.py`), `weights`
(`compiled.py`), and `jitted` and `entry`, which compile a function (`program.py`).
"""

from __future__ import annotations

import numpy as np


def leave_plain(function):
    """Stands for what compiles a function, so that this file can be read by itself."""
    return function


jitted = entry = leave_plain

##################################################################################################


@jitted
def largest_change(worst, slope, last, h):
    """The largest change of abs(A h) from step to step so far, where a bristle is reloaded."""
    z = abs(slope) * h
    y = abs(last) * h
    change = abs(z - y)
    if min(z, y) < 0.5 and change > worst:
        return change
    return worst


@jitted
def find_slopes(first, time, h, inputs, memory, lane):
    """Slopes A of the bristles, and the measure of how well the step resolves them."""
    slopes(time, STATES, BRISTLES, inputs, LATE, memory, SLOPES, lane)
    for i in range(MANY_BRISTLES):
        at = i * LANES + lane
        slope = memory[SLOPES + at]
        if not first:
            last = memory[LAST_SLOPES + at]
            memory[WORST + at] = largest_change(memory[WORST + at], slope, last, h)
        memory[LAST_SLOPES + at] = slope


@jitted
def are_near(h, memory):
    """Whether abs(A h) < 2 for all bristles of all lanes, where series give the factors."""
    far = 0
    for at in range(MANY_BRISTLES * LANES):
        far += 0 if abs(h * memory[SLOPES + at]) < 2.0 else 1
    return far == 0


@jitted
def find_factors(is_near, h, memory, lane):
    """Factors of the exact step of the bristles;  is_near: from `are_near`."""
    for i in range(MANY_BRISTLES):
        at = i * LANES + lane
        e_half, g_half, e, w0, w1, w3 = weights(h * memory[SLOPES + at], is_near)
        memory[E_HALF + at] = e_half
        memory[G_HALF + at] = 0.5 * h * g_half
        memory[E_STEP + at] = e
        memory[WEIGHT_0 + at] = w0
        memory[WEIGHT_1 + at] = w1
        memory[WEIGHT_3 + at] = w3


@jitted
def take_rests(bristles, rests, memory, lane):
    """Reduce the rate A z + B of each bristle to its rest B."""
    for i in range(MANY_BRISTLES):
        at = i * LANES + lane
        memory[rests + at] -= memory[SLOPES + at] * memory[bristles + at]


@jitted
def move_straight(rates, length, memory, lane):
    """States for the next stage, from the start of the step with constant rates."""
    for i in range(MANY_STATES):
        at = i * LANES + lane
        memory[STAGE_STATES + at] = memory[STATES + at] + length * memory[rates + at]


@jitted
def move_half(rests, bristles, memory, lane):
    """Bristles after half a step from the start of the step."""
    for i in range(MANY_BRISTLES):
        at = i * LANES + lane
        decayed = memory[E_HALF + at] * memory[BRISTLES + at]
        memory[bristles + at] = decayed + memory[G_HALF + at] * memory[rests + at]


@jitted
def move_second_half(memory, lane):
    """Bristles after the second half of a step, from the result of the first stage."""
    for i in range(MANY_BRISTLES):
        at = i * LANES + lane
        rest = 2 * memory[RESTS_2 + at] - memory[RESTS_0 + at]
        decayed = memory[E_HALF + at] * memory[FIRST_BRISTLES + at]
        memory[STAGE_BRISTLES + at] = decayed + memory[G_HALF + at] * rest


@jitted
def end_step(h, memory, lane):
    """The states at the end of the step, from the rates of all four stages."""
    for i in range(MANY_STATES):
        at = i * LANES + lane
        inner = 2 * (memory[RATES_1 + at] + memory[RATES_2 + at])
        memory[STATES + at] += h / 6.0 * (memory[RATES_0 + at] + inner + memory[RATES_3 + at])
    for i in range(MANY_BRISTLES):
        at = i * LANES + lane
        outer = memory[WEIGHT_0 + at] * memory[RESTS_0 + at]
        inner = memory[WEIGHT_1 + at] * (memory[RESTS_1 + at] + memory[RESTS_2 + at])
        rest = outer + inner + memory[WEIGHT_3 + at] * memory[RESTS_3 + at]
        memory[BRISTLES + at] = memory[E_STEP + at] * memory[BRISTLES + at] + h * rest
    for i in range(MANY_LATE):
        memory[LATE + i * LANES + lane] = memory[LATE_END + i * LANES + lane]


@jitted
def step(time, h, inputs_0, inputs_1, inputs_2, memory, lane):
    """One step of the scheme;  inputs_0, _1, _2: inputs at its start, middle and end."""
    x, z, z1, m = STAGE_STATES, STAGE_BRISTLES, FIRST_BRISTLES, memory
    middle = time + 0.5 * h
    rates(time, STATES, BRISTLES, inputs_0, LATE, m, RATES_0, RESTS_0, lane)
    take_rests(BRISTLES, RESTS_0, m, lane)
    move_straight(RATES_0, 0.5 * h, m, lane)
    move_half(RESTS_0, z1, m, lane)
    rates(middle, x, z1, inputs_1, LATE_MIDDLE, m, RATES_1, RESTS_1, lane)
    take_rests(z1, RESTS_1, m, lane)
    move_straight(RATES_1, 0.5 * h, m, lane)
    move_half(RESTS_1, z, m, lane)
    rates(middle, x, z, inputs_1, LATE_MIDDLE, m, RATES_2, RESTS_2, lane)
    take_rests(z, RESTS_2, m, lane)
    move_straight(RATES_2, h, m, lane)
    move_second_half(m, lane)
    rates(time + h, x, z, inputs_2, LATE_END, m, RATES_3, RESTS_3, lane)
    take_rests(z, RESTS_3, m, lane)
    end_step(h, m, lane)


@jitted
def advance(first, time, h, inputs_0, inputs_1, inputs_2, memory):
    """One step of all lanes;  first: whether it is the first one;  inputs: as in `step`."""
    # the compiler must not know this number: else it would unroll the loop into single lanes
    lanes = LANES if LANES == 1 else memory.size // ROWS
    for lane in range(LANES):
        find_slopes(first, time, h, inputs_0, memory, lane)
    if LANES > 1 and are_near(h, memory):  # one lane asks for each bristle, in `phi`
        for lane in range(lanes):
            find_factors(True, h, memory, lane)
    else:
        for lane in range(lanes):
            find_factors(False, h, memory, lane)
    for lane in range(LANES):
        step(time, h, inputs_0, inputs_1, inputs_2, memory, lane)


@jitted
def know_velocity(at, reading, period, smoothing, memory, lane):
    """Travel rate of a motion over the last sample, and velocity as the computer estimates it.

    The observer is Luenberger's for a motion of constant velocity (order 2) or acceleration
    (order 3), in its predictor-corrector form (alpha-beta and alpha-beta-gamma filters), all its
    poles at one place p = `smoothing`. It estimates the derivative of the position through
        order 2: w^2/(s + w)^2, late by 2/w      order 3: (3 w^2 s + w^3)/(s + w)^3, late by nothing
    for slow motion. OBSERVER 0 is the filtered difference, w/(s + w), late by 1/w.
    """
    travel = (reading - memory[LAST_READING + at]) / period
    known = memory[KNOWN + at]
    left = 1.0 - smoothing
    memory[TRAVEL + at] = travel
    if OBSERVER == 0:
        memory[KNOWN + at] = smoothing * known + left * travel
        return
    bend = memory[BEND + at]
    observed = memory[OBSERVED + at] + period * (known + 0.5 * period * bend)
    known += period * bend
    missing = reading - observed
    if OBSERVER == 2:
        position_gain, velocity_gain, bend_gain = 1.0 - smoothing**2, left**2 / period, 0.0
    else:
        position_gain = 1.0 - smoothing**3
        velocity_gain = 1.5 * left**2 * (1.0 + smoothing) / period
        bend_gain = (left / period) ** 2 * left
    memory[KNOWN + at] = known + velocity_gain * missing
    memory[OBSERVED + at] = observed + position_gain * missing
    memory[BEND + at] = bend + bend_gain * missing


@jitted
def read_sensors(first, encoder_step, period, smoothing, inputs, memory, lane):
    """Positions in encoder steps, and the computer's estimates of travel rate and velocity."""
    motions(STATES, inputs, memory, POSITIONS, VELOCITIES, lane)
    for i in range(MANY_MOTIONS):
        at = i * LANES + lane
        reading = memory[POSITIONS + at]
        if encoder_step > 0.0:
            reading = round_down(reading / encoder_step + 0.5) * encoder_step
        if first:
            velocity = memory[VELOCITIES + at]
            memory[TRAVEL + at] = velocity
            memory[KNOWN + at] = velocity
            memory[OBSERVED + at] = reading
        else:
            know_velocity(at, reading, period, smoothing, memory, lane)
        memory[LAST_READING + at] = reading


@jitted
def recall(n, samples, past, slots, memory, lane):
    """Late signals of the computer, interpolated between two samples.

    samples: delay of each signal in samples;  past: ring of its values, `slots` samples long
    """
    width = MANY_SAMPLED_LATE * LANES
    for i in range(MANY_SAMPLED_LATE):
        at = i * LANES + lane
        whole = int(samples[i])
        part = samples[i] - whole
        then = n - whole
        value = 0.0
        if then >= 0:
            value = (1.0 - part) * past[(then % slots) * width + at]
        if then >= 1:
            value += part * past[((then - 1) % slots) * width + at]
        memory[SAMPLED_LATE + at] = value


@jitted
def retain(n, place, period, sampled, past, slots, memory, lane):
    """Keep the present values of the computer's late signals for later samples."""
    computer_late(n, period, sampled, memory, SAMPLED_LATE_VALUES, lane)
    for i in range(MANY_SAMPLED_LATE):
        at = i * LANES + lane
        entry = (place % slots) * MANY_SAMPLED_LATE * LANES + at
        past[entry] = memory[SAMPLED_LATE_VALUES + at]


@jitted
def compute(first, n, place, period, sampled, late_samples, past, slots, memory, lane):
    """Signals and steps of the computer after its sensors were read;  arguments: as in `sample`."""
    recall(place, late_samples, past, slots, memory, lane)
    if not first:
        computer_before(n, period, sampled, memory, lane)
    computer_signals(n, period, sampled, memory, MADE, lane)
    held_commands(n, sampled, memory, NEW_COMMANDS, lane)
    retain(n, place, period, sampled, past, slots, memory, lane)
    computer_after(n, period, sampled, memory, lane)


@jitted
def sample(
    first, n, place, time, period, encoder_step, smoothing, inputs, sampled, late_samples,
    past, slots, memory, lane,
):  # fmt: skip
    """The computer reads its sensors, computes its signals and steps its states.

    first: whether it is the first sample;  n: its number;  place: its number for the ring `past`
    """
    # sensors read just before the new command
    signals(time, STATES, BRISTLES, inputs, LATE, memory, NOW, lane)
    read_sensors(first, encoder_step, period, smoothing, inputs, memory, lane)
    compute(first, n, place, period, sampled, late_samples, past, slots, memory, lane)


@jitted
def hold(slot, memory, held, lane):
    """Keep the new commands in a ring until they act;  slot: their place;  held: the ring."""
    for i in range(MANY_COMMANDS):
        at = i * LANES + lane
        held[slot * MANY_COMMANDS * LANES + at] = memory[NEW_COMMANDS + at]


@jitted
def release(slot, held, memory, lane):
    """The commands in this slot of the ring start to act."""
    for i in range(MANY_COMMANDS):
        at = i * LANES + lane
        memory[COMMANDS + at] = held[slot * MANY_COMMANDS * LANES + at]


@jitted
def earlier(at, node, part, before, after, slots):
    """A signal at `part` of a step after a node, 0 to 1, from up to four nodes without a jump.

    before, after: rings of the signal at the nodes, before and after a jump; `slots` nodes long
    """
    if node < 0:
        return 0.0
    width = MANY_LATE * LANES
    now = after[(node % slots) * width + at]
    if part == 0.0:
        return now
    end = before[((node + 1) % slots) * width + at]
    if node < 1 or before[(node % slots) * width + at] != now:
        return now + part * (end - now)
    last = after[((node - 1) % slots) * width + at]
    if node < 2 or before[((node - 1) % slots) * width + at] != last:
        outer = 0.5 * part * ((part - 1.0) * last + (part + 1.0) * end)
        return outer + (1.0 - part * part) * now
    first = after[((node - 2) % slots) * width + at]
    outer = (part + 1.0) * part * ((part + 2.0) * end - (part - 1.0) * first) / 6.0
    inner = 0.5 * (part + 2.0) * (part - 1.0)
    return outer + inner * (part * last - (part + 1.0) * now)


@jitted
def keep_late(j, time, inputs, ring, slots, memory, lane):
    """Keep the values of late signals at this node in a ring."""
    late_values(time, STATES, BRISTLES, inputs, LATE, memory, LATE_VALUES, lane)
    for i in range(MANY_LATE):
        at = i * LANES + lane
        ring[(j % slots) * MANY_LATE * LANES + at] = memory[LATE_VALUES + at]


@jitted
def delay(j, time, inputs, late_steps, before, after, slots, memory, lane):
    """Late signals at the start, middle and end of the step that begins.

    late_steps: delay of each signal in steps;  before, after: rings, as in `earlier`
    """
    if j > 0:  # before the start all signals are zero: another value at the start is a jump
        keep_late(j, time, inputs, before, slots, memory, lane)
    for i in range(MANY_LATE):
        at = i * LANES + lane
        whole = int(ceil(late_steps[i]))
        memory[LATE + at] = earlier(at, j - whole, whole - late_steps[i], before, after, slots)
    keep_late(j, time, inputs, after, slots, memory, lane)
    for i in range(MANY_LATE):
        at = i * LANES + lane
        whole = int(ceil(late_steps[i]))
        node, part = j - whole, whole - late_steps[i]
        now = memory[LATE + at]
        middle, end = now, now  # a held signal does not change within a step
        if SMOOTH[i]:
            if part < 0.5:
                middle = earlier(at, node, part + 0.5, before, after, slots)
            else:
                middle = earlier(at, node + 1, part - 0.5, before, after, slots)
            if part > 0.0:
                end = earlier(at, node + 1, part, before, after, slots)
            elif node >= -1:
                end = before[((node + 1) % slots) * MANY_LATE * LANES + at]
        memory[LATE_MIDDLE + at] = middle
        memory[LATE_END + at] = end


@jitted
def notice_spoiled(memory, lane):
    """Make the mark of a lane NaN where a signal of the row is not finite."""
    for i in range(MANY_COLUMNS):
        memory[SPOILED + lane] += 0.0 * memory[COLUMNS + i * LANES + lane]


@jitted
def is_unresolved(limit, memory):
    """Whether in every lane a bristle is resolved so badly that no allowed step is short enough."""
    for lane in range(LANES):
        worst = 0.0
        for i in range(MANY_BRISTLES):
            worst = max(worst, memory[WORST + i * LANES + lane])
        if not worst > limit:
            return False
    return True


@jitted
def keep(row, width, kept, out, kinds, columns, others, results, memory):
    """Write the rows of `kept` into the result, and update the reductions with this row.

    kinds: 0 last value, 1 largest, 2 least, 3 largest size, 4 sum, 5 sum of a product with
    `others`, 6 its integral by trapezia, in rows
    width: of the row in this integral; < 0: the row is not reduced
    """
    for k in range(len(kept)):
        for lane in range(LANES):
            out[(row * len(kept) + k) * LANES + lane] = column_at(kept[k] + lane, memory)
    if width < 0.0:
        return
    for i in range(len(kinds)):
        for lane in range(LANES):
            at = i * LANES + lane
            value = column_at(columns[i] + lane, memory)
            before = results[at]
            if kinds[i] == 1:
                value = max(value, before)
            elif kinds[i] == 2:
                value = min(value, before)
            elif kinds[i] == 3:
                value = max(abs(value), before)
            elif kinds[i] == 4:
                value = before + value
            elif kinds[i] == 5:
                value = before + value * column_at(others[i] + lane, memory)
            elif kinds[i] == 6:
                value = before + width * value * column_at(others[i] + lane, memory)
            results[at] = value


@entry
def differentiate_at_rest(inputs, memory, small, slopes_of):
    """Derivatives of the rates by the states at rest, by central differences over 2 small.

    memory: zeros, and the parameters
    slopes_of: entries d(rate i)/d(state k) of all lanes, states before bristles
    """
    for lane in range(LANES):
        find_inverses(memory, lane)
    at_rest = inputs_at(inputs, np.int64(0))  # no literal, see `module_source`
    many = MANY_STATES + MANY_BRISTLES  # in rows side by side, and so are their rates
    for k in range(many):
        state = STATES + k * LANES
        for lane in range(LANES):
            memory[state + lane] = small
            rates(0.0, STATES, BRISTLES, at_rest, LATE, memory, RATES_0, RESTS_0, lane)
            memory[state + lane] = -small
            rates(0.0, STATES, BRISTLES, at_rest, LATE, memory, RATES_1, RESTS_1, lane)
            memory[state + lane] = 0.0
            for i in range(many):
                change = memory[RATES_0 + i * LANES + lane] - memory[RATES_1 + i * LANES + lane]
                slopes_of[(i * many + k) * LANES + lane] = change / (2.0 * small)


@entry
def follow(period, sampled, late_samples, past, slots, memory, out):
    """The computer alone, without sensors, along all samples;  out: its first command, (samples,).

    sampled: (sampled inputs, samples)
    """
    find_inverses(memory, 0)
    for n in range(len(out)):
        now = sampled_inputs_at(sampled, n)
        compute(False, n, n, period, now, late_samples, past, slots, memory, 0)
        out[n] = memory[NEW_COMMANDS]


@entry
def run(
    samples, inner, h, period, lag, late_steps, encoder_step, smoothing,
    held, held_slots, before, after, late_slots, late_samples, past, past_slots,
    every_step, inputs, sampled,
    memory, kept, out, limit, begin, kinds, columns, others, results,
):  # fmt: skip
    """Advance all lanes over samples of `inner` steps of h; see `kernel.execute` for the arrays.

    limit: the run ends where the measure of the reload exceeds it in every lane
    """
    nodes, row = samples * inner, np.int64(0)  # no literal, see `module_source`
    for lane in range(LANES):
        find_inverses(memory, lane)
    for j in range(nodes + 1):
        time, now, inputs_0 = j * h, j % inner == 0, inputs_at(inputs, 2 * j)
        if COMPUTER and now:
            sampled_0 = sampled_inputs_at(sampled, j // inner)
            for lane in range(LANES):
                sample(
                    j == 0, j // inner, j // inner, time, period, encoder_step, smoothing,
                    inputs_0, sampled_0, late_samples, past, past_slots, memory, lane,
                )  # fmt: skip
            for lane in range(LANES):
                hold(j // inner % held_slots, memory, held, lane)
        if COMPUTER and j >= lag and (j - lag) % inner == 0:
            for lane in range(LANES):
                release((j - lag) // inner % held_slots, held, memory, lane)
        if MANY_LATE > 0:
            for lane in range(LANES):
                delay(j, time, inputs_0, late_steps, before, after, late_slots, memory, lane)
        if every_step or now:
            width = -1.0
            if row >= begin:
                width = 0.5 if row == begin or j == nodes else 1.0
            for lane in range(LANES):
                if not (COMPUTER and now):
                    signals(time, STATES, BRISTLES, inputs_0, LATE, memory, NOW, lane)
                record(inputs_0, memory, COLUMNS, lane)
                notice_spoiled(memory, lane)
            keep(row, width, kept, out, kinds, columns, others, results, memory)
            row += 1
            if is_unresolved(limit, memory):
                return
        if j < nodes:
            inputs_1, inputs_2 = inputs_at(inputs, 2 * j + 1), inputs_at(inputs, 2 * j + 2)
            advance(j == 0, time, h, inputs_0, inputs_1, inputs_2, memory)
