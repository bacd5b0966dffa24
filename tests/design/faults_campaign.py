"""Names of faults that are planted in a compensation or in its device, on a simulator.

The design knows the device; one number of the compensator or of the device then differs. Three
ways of recording: with the command, without it, and without it beside a recording with the
compensation off.
"""

import numpy as np
from design.compensated_joint import PERIOD, STEP, Compensation, record, record_without

import teleopdesign as td
from teleopdesign.blocks import Value
from teleopdesign.design.verify import Plan, verify

SMOOTH, BANDWIDTH, SECONDS = 0.2, 50.0, 8
#: fault -> names, one of which a group must hold
FAULTS = {
    "none": (),
    "level": ("C: cancel.coulomb.level",),
    "delay": ("Z_M: delay", "computer: delay"),
    "filter": ("computer: velocity_bandwidth",),
    "zero": ("C: cancel.zero",),
    "friction": ("Z_M: coulomb.level",),
    "sign": ("C: gain",),
    "sensor": ("force sensor: scale",),
}
WAYS = ("command", "no command", "no command, off too")


def draw(number):
    """A device with cogging or gravity: its inertia and effects, and a generator."""
    random = np.random.default_rng([57, number])
    wave = {"amplitude": random.uniform(0.08, 0.15), "period": random.uniform(0.4, 0.8)}
    place = {"cogging": wave} if number % 2 == 0 else {"gravity": {"amplitude": 0.3}}
    next(iter(place.values()))["phase"] = random.uniform(0, 6.28)
    effects = {
        "coulomb": {"level": random.uniform(0.15, 0.3)},
        "viscous": {"damping": random.uniform(0.02, 0.05)},
        **place,
    }
    return random.uniform(0.008, 0.016), effects, random


def plan_for(inertia, effects):
    """What a design of this device predicts from, identified within a percent."""
    body = td.Body("revolute", {"inertia": inertia})
    for name, values in effects.items():
        body = body.with_effect(td.EFFECTS[name], values)
    errors = {n: Value(v.value, stderr=0.01 * abs(v.value)) for n, v in body.parameters.items()}
    body = body.with_values(errors)
    cancelled = {n: dict(v) for n, v in effects.items() if n != "viscous"}
    cancelled["coulomb"]["level"] *= 0.9
    law = td.cancel(cancelled, smoothing_velocity=SMOOTH)
    diagram = td.haptic_interface(body, cancellation=law)
    sampling = td.Sampling(
        period=PERIOD, delay=PERIOD, encoder_step=STEP, velocity_bandwidth=BANDWIDTH
    )
    return Plan(diagram, sampling, "device", "MBC", 0.0), dict(law.names())


def planted(fault, numbers, effects, random):
    """The compensation and the device's effects with a fault."""
    laws = {n.removeprefix("cancel."): v for n, v in numbers.items()}
    bandwidth, late = BANDWIDTH, 1
    effects = {n: dict(v) for n, v in effects.items()}
    if fault == "level":
        laws["coulomb.level"] *= random.choice([0.5, 2.0])
    elif fault == "delay":
        late += 3
    elif fault == "filter":
        bandwidth *= random.choice([0.2, 0.4])
    elif fault == "zero":
        laws["zero"] = random.uniform(0.1, 0.25) * random.choice([-1, 1])
    elif fault == "friction":
        effects["coulomb"]["level"] *= random.choice([0.6, 1.4])
    elif fault == "sign":
        forces = ("level", "amplitude")
        laws |= {n: -v for n, v in laws.items() if n.rpartition(".")[2] in forces}
    return Compensation({"cancel": laws}, {}, bandwidth, late), effects


def experiment(columns, *, command=True):
    """The recording; command: whether the command was logged."""
    columns = dict(columns, u=columns["u"] * command)
    return td.experiment(
        columns,
        axis="revolute",
        position={"column": "q", "unit": "rad", "resolution": STEP},
        actuator_force={"column": "u", "unit": "N*m"},
        interaction_force={"column": "hand", "unit": "N*m"},
        time={"column": "t", "unit": "s"},
        inertia=0.01,
    )


def named(fault, number, way):
    """The verification of one device with a fault, recorded in one way."""
    inertia, effects, random = draw(number)
    plan, numbers = plan_for(inertia, effects)
    computer, changed = planted(fault, numbers, effects, random)
    columns = record(inertia, changed, computer, SECONDS, random)
    if fault == "sensor":
        columns["hand"] = 0.85 * columns["hand"]
    on = experiment(columns, command=way == "command")
    off = None
    if way == WAYS[2]:
        columns = record_without(inertia, changed, SECONDS, random)
        columns["hand"] = columns["hand"] * (0.85 if fault == "sensor" else 1.0)
        off = experiment(columns)
    return verify(plan, on, without=off)


def is_right(fault, verified):
    """Whether the first group holds the fault, and nothing else is named; of a healthy device,
    whether nothing is."""
    groups = [[f"{d.at}: {d.parameter}" for d in group] for group in verified.deviations]
    if not FAULTS[fault]:
        return not groups
    return len(groups) == 1 and bool(set(FAULTS[fault]) & set(groups[0]))
