"""Records made from a motion and the force that it takes: no controller, no package code.

The force is m a + friction + others along a motion that is given as a function of time; positions
are rounded to an encoder's step, forces get noise. Slow motions need nothing more.
"""

from dataclasses import replace

import numpy as np

EXPERIMENT = """title = "Made"
[model.device]
axis = "revolute"
inertia = {{ value = {inertia}, unit = "kg*m^2", fixed = {fixed} }}
[model.device.effects]
{effects}
[channels]
time = {{ column = "t", unit = "s" }}
position = {{ column = "q", unit = "rad", resolution = {step} }}
actuator_force = {{ column = "tau", unit = "N*m", noise = {noise} }}
segment = {{ column = "part" }}
[comparison]
bandwidth = {{ value = {bandwidth}, unit = "Hz" }}
"""


def dahl(position, stiffness, level):
    """Force of Dahl's bristle along a position (n,), at rest at first; exact between turns."""
    force = np.zeros(len(position))
    for k in range(1, len(position)):
        dx = position[k] - position[k - 1]
        s = np.sign(dx)
        force[k] = level * s + (force[k - 1] - level * s) * np.exp(-abs(dx) * stiffness / level)
    return force


def write_made(
    folder, records, force, *, effects, step, noise, bandwidth=5, inertia=0.05, rate=100, fixed=True
):
    """An experiment of such records.

    records: use -> list of segments, each (duration in s, position as a function of time in s)
    force: (time, position, velocity) -> what the motion takes beside the inertia, (n,)
    effects: lines of the user's model
    """
    rng = np.random.default_rng(5)
    folder.mkdir(parents=True, exist_ok=True)
    text = EXPERIMENT.format(
        inertia=inertia,
        fixed=str(fixed).lower(),
        effects=effects,
        step=step,
        noise=noise,
        bandwidth=bandwidth,
    )
    for use, segments in records.items():
        rows, begin, fine = [], 0.0, 20
        for part, (duration, motion) in enumerate(segments):
            # finer than the rows, for the derivatives and the history of hidden states
            t = np.arange(int(duration * rate) * fine) / (rate * fine)
            x = motion(t)
            v = np.gradient(x, t)
            needed = inertia * np.gradient(v, t) + force(t, x, v)
            samples = slice(None, None, fine)
            # a row's force holds until the next: its mean over the row
            held = needed.reshape(-1, fine).mean(axis=1)
            q = step * np.round(x[samples] / step)
            tau = held + noise * rng.standard_normal(len(held))
            rows += [
                f"{begin + s:.6f},{a:.9g},{b:.9g},{part}"
                for s, a, b in zip(t[samples], q, tau, strict=True)
            ]
            begin += duration
        (folder / f"{use}.csv").write_text("t,q,tau,part\n" + "\n".join(rows) + "\n")
        text += f'[[records]]\nfile = "{use}.csv"\nuse = "{use}"\n'
    (folder / "experiment.toml").write_text(text)
    return folder


def jittered(experiment, rows, seed=0):
    """Each row read at a moment of its own, that many rows (rms) off its place."""
    rng = np.random.default_rng(seed)

    def one(record):
        t = record.time
        at = t + rows * record.sample_time * rng.standard_normal(len(t))
        signals = {
            name: y if name.endswith("actuator_force") else np.interp(at, t, y)
            for name, y in record.signals.items()
        }
        return replace(record, signals=signals)

    return replace(experiment, records=tuple(map(one, experiment.records)))
