"""Noise of a force in a log: the scatter of its readings, where the force was read by a sensor.

With a stated step of the position and no stated noise, a diagnosis takes the steps of the encoder
for the only error of the readings. A motor current scatters as well, and this scatter is no missing
effect. A command scatters, too, but its scatter acts on the body.
"""

from __future__ import annotations

import numpy as np

from ..column_names import is_wanted, words_of
from ..encoder import reading_noise
from .acting import names_voltage
from .content import Survey

#: words in names of what a controller puts out, beside those of `is_wanted`
OUTPUTS = frozenset({"u", "control", "output", "out", "pwm", "duty"})
#: scatter over the standard deviation of the force below which none is stated: a noise floor of
#: less than a thousandth of the force decides nothing
LEAST = 1e-3


def state_scatter(survey: Survey, name: str) -> None:
    """State the scatter of the actuator force as its noise, in the unit of its column, with a note.

    Nothing is stated where the name is that of a command, where the channel is marked as measured
    (a diagnosis then estimates the noise), or where no step of the position is known.
    """
    entry, position = survey.channels["actuator_force"], survey.channels["position"]
    is_command = is_wanted(name) or names_voltage(name) or not OUTPUTS.isdisjoint(words_of(name))
    is_estimated = entry.get("measured") or not position.keys() & {"resolution", "counts_per_turn"}
    if is_command or is_estimated:
        return
    values = survey.columns[name].values
    scatter = reading_noise(values)
    if not scatter > LEAST * float(np.std(values)):
        return
    entry["noise"] = float(f"{scatter:.3g}")
    survey.notes.append(
        f"{name!r} scatters by {entry['noise']:g} {entry['unit']} from row to row, stated as "
        "noise: delete it if the column holds the exact command"
    )
