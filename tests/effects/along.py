"""Bodies and motions that the tests of effects share."""

from dataclasses import replace

import numpy as np

from teleopdesign.base.units import AXES
from teleopdesign.blocks import CONTACT, Body, Value
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.motion import motion_of

#: a value of the right order for each quantity, on the device and motions of this folder
TYPICAL = {
    "force": 0.3,
    "inertia": 0.1,
    "damping": 2.0,
    "stiffness": 2e3,
    "velocity": 0.05,
    "time": 2.3e-3,  # s; no whole number of samples: a delay is smooth between them
    "dimensionless": 0.2,
    "position": 0.01,
    "drag": 1.0,
    "cubic_stiffness": 1e5,
    "per_square_of_position": 500.0,
    "angle": 0.3,
    "frequency": 10.0,
    "temperature": 300.0,
    "temperature_coefficient": 0.02,
}
LEVEL = 0.5  # N; above every effect that lowers it
#: where another size shows the effect
OTHER = {
    "coulomb.level": LEVEL,
    "actuator_saturation.limit": 1.5,  # N; the commands reach twice that
    "friction_drift.time_constant": 0.4,  # s; part of a record
    "backlash.gap": 1e-3,  # m; part of the travel
    "contact_hardening.power": 1.5,
    "shear_thinning.exponent": 0.5,
    "actuator_dead_zone.half_width": 0.3,  # N; a part of the commands
    "stops.lower": -2e-3,  # m; part of the travel
    "stops.upper": 2e-3,
    "free_force.lower": -3e-3,  # m; a value that the motion passes, and no place of another one
    "free_force.upper": 4e-3,
    **{f"free_force.value_{i}": 0.1 * (-1) ** i + 0.05 * i for i in range(1, 9)},  # N
    **{f"free_friction.value_{i}": 0.3 - 0.02 * i for i in range(1, 9)},
    # N, N/m: of elements that slip in turn, together less than `LEVEL`
    "maxwell_slip.level_2": 0.1,
    "maxwell_slip.level_3": 0.06,
    "maxwell_slip.level_4": 0.04,
    "maxwell_slip.stiffness_2": 500.0,
    "maxwell_slip.stiffness_3": 100.0,
    "maxwell_slip.stiffness_4": 40.0,
    "environment.damping": 0.0,
    "environment.contact_position": 2e-3,  # m; part of the travel
}
INERTIA = 0.15
NAMES = sorted(EFFECTS)
#: the catalogue, and the environment that effects of a contact need
KNOWN = {**EFFECTS, CONTACT.name: CONTACT}


def declaring(claim):
    """Names of the effects that make this claim in `always`."""
    return [name for name in NAMES if claim in EFFECTS[name].always]


def with_needs(name):
    """The effect's name after the names of those that it needs."""
    needed = [n for need in sorted(KNOWN[name].needs) for n in with_needs(need)]
    return list(dict.fromkeys([*needed, name]))


def typical(name, parameter):
    """Value of an effect's parameter in these tests."""
    quantity = KNOWN[name].parameters[parameter].quantity
    return OTHER.get(f"{name}.{parameter}", TYPICAL[quantity])


def axis_of(*names):
    """An axis that all of these effects hold on: prismatic where they do."""
    return next(a for a in AXES if not any(a in KNOWN[n].counterparts for n in names))


def body_of(*names, absent=(), values=(), axis=None):
    """A body with these effects at typical values, on an axis that they hold on.

    absent: names of effects at the values at which they are not there
    values: {"effect.parameter": value} that replace the typical ones
    """
    numbers = {"inertia": INERTIA}
    for name in names:
        for parameter in KNOWN[name].parameters:
            number = typical(name, parameter)
            if name in absent:
                number = KNOWN[name].absent.get(parameter, number)
            numbers[f"{name}.{parameter}"] = number
    parameters = {n: Value(v) for n, v in (numbers | dict(values)).items()}
    return Body(axis or axis_of(*names), parameters, tuple(KNOWN[n] for n in names))


def unled(body):
    """The body with hidden tips that nothing leads back to their course."""

    def free(effect):
        states = {n: replace(s, correction=None) for n, s in effect.states.items()}
        return replace(effect, states=states, led=None)

    return replace(body, effects=tuple(free(e) if e.states else e for e in body.effects))


def motion_along(
    position, command, interaction=None, *, sample_time=1e-3, bandwidth=60.0, resolution=None
):
    """The Motion of these readings, with channels besides that follow one another."""
    time = np.arange(len(position)) * sample_time
    other = 0.02 * np.ptp(position) * np.sin(40.0 * bandwidth / 60.0 * time)
    return motion_of(
        body="device",
        file="made",
        time=np.arange(len(position)) * sample_time,
        position=position,
        command=command,
        interaction=interaction,
        sample_time=sample_time,
        rows=slice(0, len(position)),
        bandwidth=bandwidth,
        resolution=resolution,
        further={"temperature": 300.0 + 0 * time, "other_position": other},
    )


def signals(seed=1, samples=1000, sample_time=1e-3):
    """Position, command and interaction force: sums of sines below 18 Hz, sizes of a device."""
    rng = np.random.default_rng(seed)
    t = np.arange(samples) * sample_time

    def sines(size):
        f = rng.uniform(1.5, 18.0, 5)[:, None]
        phase = rng.uniform(0, 2 * np.pi, 5)[:, None]
        return size * np.sum(np.sin(2 * np.pi * f * t + phase) / (1 + (f / 6) ** 2), axis=0)

    return sines(0.01), sines(2.0), sines(0.5)


def encoded(position, step=1e-6):
    """What an encoder of that step reads."""
    return step * np.round(position / step)
