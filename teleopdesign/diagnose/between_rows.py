"""A controller faster than its log: the error that unlogged commands between rows leave.

A controller that is faster than the log changes its command within a row. The log holds only one of
several commands; the others act without being logged, such as the steps of an encoder that the
controller differentiates. In the log this is a scatter from row to row, as from a sensor. Corners
at reversals are lost too, but they are rare, and the scatter does not show them.

Where the log is as fast as the controller, the same scatter is held for the whole row, acts and
moves the body: there it is no noise. So it counts only at the end of a search, and only if

- the command is late by about half a row: the logged value lies in the middle of those that act;
- a black box learns hardly anything of the residual from the motion, as no effect did;
- the residual is no larger than the scatter explains.

The scatter makes no effect more probable, because an added effect may imitate it. Probabilities
use the noise floor of the sensors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..measurement.encoder import reading_noise
from ..measurement.experiment import Experiment
from ..measurement.logger_clock import CLOCK, LoggerClock
from ..measurement.prepare import Prepared
from .adequacy import is_adequate
from .criteria import CRITERIA, Criteria
from .fit import Fit
from .learnable import Learnable
from .noise_floor import NoiseFloor, noise_floor
from .record_shift import RecordShift, shifts_of


def floor_between_rows(
    fit: Fit,
    floor: NoiseFloor,
    learned: Learnable | None,
    prepared: Prepared,
    generator: np.random.Generator,
    *,
    criteria: Criteria = CRITERIA,
) -> NoiseFloor:
    """The noise floor, with the scatter of sampled commands where all conditions above hold.

    fit: the last of a ladder
    learned: the part of this fit's residual that a black box learns; None: not computed
    """
    if is_adequate(fit, floor, criteria=criteria) or learned is None:
        return floor
    if learned.part > criteria.repeats * learned.left:
        return floor
    shifts = shifts_of(fit.model, prepared.stretches)
    scatter = command_scatter(prepared.experiment, {s.at for s in shifts if is_amid_a_row(s)})
    if not scatter:
        return floor
    experiment = with_noise(prepared.experiment, scatter)
    drawn = noise_floor(fit.model, replace(prepared, experiment=experiment), generator)
    # a noise floor is at most the error that a right model leaves
    limited = replace(drawn, value=min(drawn.value, fit.check_error))
    source = f"{floor.source}, and a command that changes within a row"
    explains = is_adequate(fit, limited, criteria=criteria)
    return replace(limited, source=source) if explains else floor


def is_amid_a_row(shift: RecordShift, *, clock: LoggerClock = CLOCK) -> bool:
    """Whether a command, whose force was not measured, is surely late by about half a row."""
    rows, error = shift.late / shift.row, shift.stderr / shift.row
    return not shift.measured and abs(rows - 0.5) + error <= clock.amid


def command_scatter(experiment: Experiment, bodies: set[str]) -> Mapping[str, float]:
    """Channel ("device.actuator_force") -> rms scatter between rows, where no noise is stated."""
    scatter = {}
    for body in bodies:
        name = f"{body}.actuator_force"
        if name in experiment.channels and experiment.channels[name].noise is None:
            sizes = [reading_noise(r.signals[name]) for r in experiment.records]
            scatter[name] = float(np.median(sizes))
    return {name: size for name, size in scatter.items() if size > 0.0}


def with_noise(experiment: Experiment, noise: Mapping[str, float]) -> Experiment:
    """The experiment with the noise of these channels (rms, SI) stated."""
    channels = {
        name: replace(channel, noise=noise[name]) if name in noise else channel
        for name, channel in experiment.channels.items()
    }
    return replace(experiment, channels=channels)
