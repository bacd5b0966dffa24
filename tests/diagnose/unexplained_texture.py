"""Records of a slide whose force holds a texture that no effect knows, and laws that throw it away.

Constant speeds there and back, the command near the sliding level: inverse dynamics of a mass with
Coulomb and viscous friction, and on top a force that depends on nothing but chance.
"""

import numpy as np
import sympy as sp

from teleopdesign import load_experiment
from teleopdesign.effects import Effect, FitSearch, Parameter
from teleopdesign.effects._effect import State

RATE, SECONDS, BANDWIDTH = 100.0, 12.0, 4.0
INERTIA, LEVEL, DAMPING = 0.2, 1.0, 0.4
STEP = 1e-5


def smooth_noise(rng, n, cutoff):
    """Noise of unit rms with content below `cutoff` (Hz)."""
    frequency = np.fft.rfftfreq(n, 1 / RATE)
    spectrum = np.fft.rfft(rng.standard_normal(n)) * np.exp(-((frequency / cutoff) ** 4))
    y = np.fft.irfft(spectrum, n)
    return y / np.std(y)


def slide(rng, *, by_hand=False, pauses=False, texture=0.25):
    """(t, command, position, hand force) of one record.

    by_hand: a hand moves the device, and the command next to nothing
    pauses: the device rests after each slide, held by friction
    texture: rms of the unexplained force (N)
    """
    t = np.arange(0.0, SECONDS, 1 / RATE)
    speeds = rng.permutation([0.2, -0.2, 0.4, -0.4, 0.8, -0.8])
    speeds = np.stack([speeds, 0.0 * speeds], axis=1).ravel() if pauses else speeds
    speeds = np.repeat(speeds, len(t) // len(speeds))
    kernel = np.hanning(41)
    velocity = np.convolve(np.pad(speeds, 20, mode="edge"), kernel / kernel.sum(), mode="valid")
    velocity = velocity * (1 + 0.03 * smooth_noise(rng, len(t), 2.0))
    position = np.cumsum(velocity) / RATE
    force = INERTIA * np.gradient(velocity, 1 / RATE) + DAMPING * velocity
    force = force + LEVEL * np.tanh(velocity / 1e-3) + texture * smooth_noise(rng, len(t), 2.5)
    command = 0.02 * smooth_noise(rng, len(t), 2.0) if by_hand else force
    return t, command, STEP * np.round(position / STEP), force - command


def write_slide(folder, *, seed=1, by_hand=False, pauses=False):
    """An experiment of two fit records and a check record."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(seed)
    columns = 4 if by_hand else 3
    for name in ("one", "two", "check"):
        table = np.column_stack(slide(rng, by_hand=by_hand, pauses=pauses)[:columns])
        head = ",".join(["t", "u", "x", "f_h"][:columns])
        np.savetxt(folder / f"{name}.csv", table, "%.9g", ",", header=head, comments="")
    hand = 'interaction_force = { column = "f_h", unit = "N", noise = 0.001 }\n' if by_hand else ""
    (folder / "experiment.toml").write_text(
        f"""title = "A slide with a texture"
[model.device]
axis = "prismatic"
inertia = {{ value = {INERTIA}, unit = "kg" }}
[model.device.effects]
coulomb = {{ level = {{ value = {LEVEL}, unit = "N" }} }}
viscous = {{ damping = {{ value = {DAMPING}, unit = "N*s/m" }} }}
[channels]
time = {{ column = "t", unit = "s" }}
position = {{ column = "x", unit = "m", resolution = {STEP} }}
actuator_force = {{ column = "u", unit = "N" }}
{hand}[comparison]
bandwidth = {{ value = {BANDWIDTH}, unit = "Hz" }}
"""
        + "".join(
            f'[[records]]\nfile = "{name}.csv"\nuse = "{"check" if name == "check" else "fit"}"\n'
            for name in ("one", "two", "check")
        )
    )
    return load_experiment(folder)


def _named_effect(name, role, law, parameters, absent, **more):
    return Effect(role=role, law=law, parameters=parameters, absent=absent, **more).named(name, "")


def _lagging(now, p):
    return (now.command - now.slow) / p.time_constant


def _follows(now, p):
    return (now.acting_force - now.slow) / p.time_constant


PART = {"part": Parameter("dimensionless", "part", upper=1.0, search=FitSearch(starts=(0.3, 0.9)))}
SLOW = {"time_constant": Parameter("time", "tau", upper=1e3, search=FitSearch(starts=(1.0, 30.0)))}

#: what users could write to be rid of the recorded force
CHEATS = {
    effect.name: effect
    for effect in (
        _named_effect(
            "soft_limit", "actuation", lambda now, p: p.limit * sp.tanh(now.command / p.limit),
            {"limit": Parameter("force", "l", search=FitSearch(starts=(0.3, 1.0)))},
            {"limit": float("inf")},
        ),
        _named_effect(
            "forgets_what_lasts", "actuation", lambda now, p: now.command - p.part * now.slow,
            {**PART, **SLOW}, {"part": 0.0}, states={"slow": State("force", _lagging)},
        ),
        _named_effect(
            "takes_up_what_acts", "friction_level", lambda now, p: p.part * abs(now.acting_force),
            PART, {"part": 0.0},
        ),
        _named_effect(
            "feeds_back_late", "force", lambda now, p: p.part * now.slow, {**PART, **SLOW},
            {"part": 0.0}, states={"slow": State("force", _follows)},
        ),
    )
}  # fmt: skip

#: what users could write to be rid of a hand's force
HIDES_THE_HAND = {
    effect.name: effect
    for effect in (
        _named_effect(
            "takes_the_hand", "force", lambda now, p: p.part * now.interaction_force,
            PART, {"part": 0.0},
        ),
        _named_effect(
            "stands_before_the_hand", "structure", lambda now, p: p.part * now.interaction_force,
            PART, {"part": 0.0},
        ),
    )
}  # fmt: skip
