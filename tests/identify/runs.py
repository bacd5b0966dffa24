"""Records of runs at constant speed both ways, from a formula that shares nothing with the code."""

import numpy as np

LEVEL, DAMPING, BIAS, MASS = 0.8, 2.0, 0.3, 0.2


def path(speeds, *, travel=0.08, pause=0.2, ramp=0.08, rate=1000.0, back=1.0):
    """Time, position, velocity, acceleration: forward and backward at each speed, smooth ends.

    back: part of the way back at that speed; the rest is half as fast again
    """
    legs = []
    for speed in speeds:
        n = round(travel / speed * rate)
        legs += [np.full(n, speed), np.zeros(round(pause * rate))]
        legs += [np.full(round(back * n), -speed), np.zeros(round(pause * rate))]
        if back < 1.0:
            legs += [np.full(round((1.0 - back) * n / 1.5), -1.5 * speed), legs[-1]]
    wanted = np.concatenate([np.zeros(round(rate)), *legs, np.zeros(round(rate))])
    width = round(ramp * rate)
    velocity = wanted
    for _ in range(3):  # a smooth ramp: quadratic B-spline
        velocity = np.convolve(velocity, np.ones(width) / width, "same")
    time = np.arange(len(velocity)) / rate
    return time, np.cumsum(velocity) / rate, velocity, np.gradient(velocity) * rate


def noise(n, *, size, memory, generator):
    """Noise of that rms in which a sample remembers part of the one before."""
    white = generator.standard_normal(n) * size * np.sqrt(1 - memory**2)
    out = np.empty(n)
    here = 0.0
    for k in range(n):
        here = memory * here + white[k]
        out[k] = here
    return out


def write(folder, speeds, *, seed=0, size=0.02, memory=0.95, step=5e-6, spring=0.0, **more):
    """An experiment whose records have these runs; the force holds noise with a memory."""
    folder.mkdir(parents=True, exist_ok=True)
    generator = np.random.default_rng(seed)
    time, x, v, a = path(speeds, **more)
    force = MASS * a + DAMPING * v + LEVEL * np.sign(np.round(v, 6)) + BIAS + spring * x
    force = force + noise(len(time), size=size, memory=memory, generator=generator)
    x = np.round(x / step) * step
    table = np.column_stack([time, x, force])
    np.savetxt(folder / "fit.csv", table, delimiter=",", header="t,x,u", comments="", fmt="%.9g")
    (folder / "experiment.toml").write_text(
        f"""title = "runs"
[model.device]
axis = "prismatic"
inertia = {{ value = {MASS}, unit = "kg" }}
[model.device.effects]
coulomb = {{ level = {{ value = 0.5, unit = "N" }} }}
viscous = {{}}
bias = {{}}
[channels]
time = {{ column = "t", unit = "s" }}
position = {{ column = "x", unit = "m", resolution = {step} }}
actuator_force = {{ column = "u", unit = "N" }}
[comparison]
bandwidth = {{ value = 20, unit = "Hz" }}
[[records]]
file = "fit.csv"
use = "fit"
"""
    )
    return folder
