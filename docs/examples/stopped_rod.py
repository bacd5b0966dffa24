"""Six seconds of each record that ships with the package, with a soft end stop added."""

from pathlib import Path

import numpy as np

import teleopdesign as td

SHIPPED = Path(td.__file__).parent / "examples" / "rod"


def write(folder, *, stiffness, start):
    """Write the experiment: stiffness in N/m, start in m."""
    folder = Path(folder)
    folder.mkdir()
    for name in ("fit.csv.gz", "check.csv.gz"):
        table = np.genfromtxt(SHIPPED / name, delimiter=",", names=True, max_rows=6000)
        table["f_h"] += stiffness * np.maximum(0, table["x"] - start)
        columns = np.column_stack([table[c] for c in ("t", "u", "x", "f_h")])
        np.savetxt(folder / name, columns, "%.7g", delimiter=",", header="t,u,x,f_h", comments="")
    text = (SHIPPED / "experiment.toml").read_text()
    level = "extra_static_level = { value = 0.2, unit = 'N' }"
    speed = "stribeck_velocity = { value = 20, unit = 'mm/s' }"
    effects = "[model.device.effects]"
    text = text.replace(effects, f"{effects}\nstribeck = {{ {level}, {speed} }}")
    (folder / "experiment.toml").write_text(text)
