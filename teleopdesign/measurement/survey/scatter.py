"""Noise of a force in a log: the scatter of its readings, where the force was read by a sensor.

With a stated step of the position and no stated noise, a diagnosis takes the steps of the encoder
for the only error of the readings. A motor current scatters as well, and this scatter is no missing
effect. A command scatters, too, but its scatter acts on the body.
"""

from __future__ import annotations

import numpy as np

from ..column_names import is_wanted
from ..encoder import CHANGES_OF_FORCE, reading_noise, update_period
from ..filtering import Array
from .content import Survey
from .words import says

#: scatter over the standard deviation of the force below which none is stated: a noise floor of
#: less than a thousandth of the force decides nothing
LEAST = 1e-3
#: the same ratio above which none is stated: a force that is tossed from row to row, such as noise
#: as an excitation or a relay, and not a reading. Any model would be adequate within such a noise
MOST = 0.3


def state_scatter(survey: Survey, name: str) -> None:
    """State the scatter of the actuator force as its noise, in the unit of its column, with a note.

    Nothing is stated where the name is that of a command, where the channel is marked as measured
    (a diagnosis then estimates the noise), where no step of the position is known, or where the
    force scatters nearly as much as it varies.
    """
    entry, position = survey.channels["actuator_force"], survey.channels["position"]
    is_command = is_wanted(name) or entry["unit"] in ("V", "mV") or says(name, "voltage", "output")
    is_estimated = entry.get("measured") or not position.keys() & {"resolution", "counts_per_turn"}
    if is_command or is_estimated:
        return
    values = _read_anew(survey.columns[name].values, survey.columns[position["column"]].values)
    scatter = reading_noise(values)
    if not LEAST < scatter / max(float(np.std(values)), 1e-300) < MOST:
        return
    entry["noise"] = float(f"{scatter:.3g}")
    survey.notes.append(
        f"{name!r} scatters by {entry['noise']:g} {entry['unit']} from row to row, stated as "
        "noise: delete it if the column holds the exact command"
    )


def _read_anew(force: Array, position: Array) -> Array:
    """The readings of a force (n,), without the rows that repeat it together with the position."""
    columns = (force, position)
    if min(update_period(x, fewest=CHANGES_OF_FORCE) for x in columns) < 2:
        return force
    changed = (np.diff(force) != 0) | (np.diff(position) != 0)
    read: Array = force[np.concatenate([[True], changed])]
    return read
