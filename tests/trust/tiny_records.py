"""Experiments with one or two records of some hundred samples, whose columns may be anything.

`made(random, folder)` writes one. Half of the forces follow a body with friction; the others have
nothing to do with the motion. Columns are constant, noisy, rounded, scaled by powers of ten, or
have samples without a number.
"""

import numpy as np

ROWS = (64, 65, 101, 110, 120, 130, 150, 150, 200, 250, 300, 301)
TOO_FEW = (2, 5, 10, 30, 60)
EFFECTS = (
    "",
    "coulomb = {}",
    'coulomb = { level = { value = 0.5, unit = "FORCE" } }\nviscous = {}',
    "viscous = {}\nspring = {}",
    "coulomb = {}\nstribeck = {}",
)
INERTIA = ("", ", fixed = false", ", fixed = true")
CHANNEL = '{} = {{ column = "{}", unit = "{}"{} }}\n'


def draw_signal(random, time, scale):
    """A column (n,) of about that size."""
    w = random.choice((0.5, 2, 8, 30)) * random.uniform(0.5, 2)
    noise = np.random.default_rng(random.randrange(2**32)).standard_normal(len(time))
    shapes = (
        np.sin(w * time),
        np.cos(w * time),
        0.0 * time,
        0.0 * time + 1.0,
        1.0 * time,
        noise,
        np.sign(np.sin(w * time)),
        np.cumsum(noise) / 10,
        1.0 * (time > time.mean()),
        np.sin(w * time + 3 * time**2),
        np.exp(-3 * time) * np.cos(w * time),
        np.round(5 * np.sin(w * time)) / 5,
    )
    return scale * random.choice(shapes)


def spoil(random, values):
    """The column after one change, or none."""
    values, row = values.copy(), random.randrange(len(values))
    kind = random.randrange(14)
    if kind == 0:
        values[row] = np.nan
    elif kind == 1:
        values[row:] = np.nan
    elif kind == 2:
        values[row] *= 1e6
    elif kind == 3:
        noise = np.random.default_rng(random.randrange(2**32)).standard_normal(len(values))
        values += 0.01 * np.max(np.abs(values)) * noise
    elif kind == 4:
        values *= 10.0 ** random.choice((-150, -12, -6, 6, 12, 150))
    elif kind == 5:
        values[row : random.randrange(len(values)) + 1] = 0.0
    elif kind == 6:
        values = np.round(values, 1)
    elif kind == 7:
        values += 10.0 ** random.choice((3, 9, 15))
    return values


def record_text(random, names):
    """A table with these columns of t, u, x, f_h and v."""
    n = random.choice(TOO_FEW if random.random() < 0.06 else ROWS)
    time = np.arange(n) / random.choice((10, 20, 40, 50, 60, 100, n / 1.3, n / 1.1))
    x = draw_signal(random, time, random.choice((1e-3, 0.01, 10, 10, 10, 100)))
    v = np.gradient(x, time)
    columns = {"t": time, "x": x, "v": v}
    columns["u"] = draw_signal(random, time, random.choice((1e-3, 1, 1, 1, 100)))
    columns["f_h"] = draw_signal(random, time, random.choice((0, 0.01, 0.3)))
    if random.random() < 0.5:
        friction = random.choice((0, 0.5, 2)) * np.tanh(v) + random.choice((0, 2e-3)) * v
        spring = random.choice((0, 0, 0.05)) * x
        columns["u"] = 0.15e-3 * np.gradient(v, time) + friction + spring
    for name in names:
        if random.random() < (0.1 if name == "t" else 0.25):
            columns[name] = spoil(random, columns[name])
    if random.random() < 0.1:
        lost = random.randrange(n)
        columns = {c: np.delete(values, lost) for c, values in columns.items()}
    write = repr if random.random() < 0.3 else "{:.6g}".format
    rows = zip(*(columns[n].tolist() for n in names), strict=True)
    return "\n".join([",".join(names), *(",".join(map(write, row)) for row in rows), ""])


def experiment_text(random, names, files):
    """The experiment of records with these columns."""
    revolute = random.random() < 0.3
    axis, mass = ("revolute", "kg*m^2") if revolute else ("prismatic", "kg")
    force, length = ("N*m", "rad") if revolute else ("N", "mm")
    text = f'title = "Tiny"\n[model.device]\naxis = "{axis}"\n'
    text += f'inertia = {{ value = 0.15, unit = "{mass}"{random.choice(INERTIA)} }}\n'
    text += f"[model.device.effects]\n{random.choice(EFFECTS).replace('FORCE', force)}\n"
    text += "[channels]\n" + CHANNEL.format("time", "t", "s", "")
    text += CHANNEL.format("actuator_force", "u", force, "")
    of_readings = random.choice(("", ", resolution = 5e-3", ", noise = 0.01"))
    text += CHANNEL.format("position", "x", length, of_readings)
    if "f_h" in names:
        noise = random.choice(("", ", noise = 0.01"))
        text += CHANNEL.format("interaction_force", "f_h", force, noise)
    if "v" in names:
        text += CHANNEL.format("velocity", "v", f"{length}/s", "")
    if random.random() < 0.8:
        hertz = random.choice((1, 2, 3, 4, 5, 7, 10, 20))
        text += f'[comparison]\nbandwidth = {{ value = {hertz}, unit = "Hz" }}\n'
    for use in files:
        text += f'[[records]]\nfile = "{use}.csv"\nuse = "{use}"\n'
    return text


def made(random, folder):
    """Write an experiment."""
    folder.mkdir()
    names = ["t", "u", "x"]
    names += ["f_h"] if random.random() < 0.6 else []
    names += ["v"] if random.random() < 0.2 else []
    files = ("fit", "check") if random.random() < 0.4 else ("fit",)
    for use in files:
        (folder / f"{use}.csv").write_text(record_text(random, names))
    (folder / "experiment.toml").write_text(experiment_text(random, names, files))
