"""A single moment of the check records that holds all of the error above the noise.

A missing effect acts again and again, in each similar motion. If only one moment of the check
records holds more than noise, a single event occurred then, or readings were wrong. No law follows
from it, and the records do not show that the model lacks one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ..base.codec import At, InUnit, Size
from ..measurement.prepare import Prepared
from .fit import Fit, block_numbers
from .noise_floor import NoiseFloor

#: fewest moments of which one may be left out: with fewer, one moment is a large part of the
#: records
MOMENTS = 10


@dataclass(frozen=True)
class Moment:
    """Half a second of a check record, and the error without it in noise floors.

    file, body: record and body;  begin, end: s, first and last row
    without: check error at the command without this moment, over the noise floor
    """

    file: Annotated[str, At("record")]
    body: Annotated[str, At("at")]
    begin: Annotated[float, InUnit("s")]
    end: Annotated[float, InUnit("s")]
    without: Annotated[Size, At("left_over_noise_floors_without")]

    def __str__(self) -> str:
        return f"{self.body} in {self.file}, {self.begin:.2f} to {self.end:.2f} s"


def worst_moment(fit: Fit, prepared: Prepared, floor: NoiseFloor) -> Moment | None:
    """The two consecutive blocks with the largest residual at the command.

    returns: None without check records, floor or residual, or with fewer than 2 `MOMENTS` blocks
    """
    stretches = prepared.of("check")
    if not stretches or not floor.value:
        return None
    numbers = block_numbers(stretches)
    squares = np.bincount(numbers, fit.at_command.residual**2)
    rows = np.bincount(numbers)
    lengths = [len(s.keep) for s in stretches]
    whose = np.repeat(np.arange(len(stretches)), lengths)
    of_block = np.full(len(rows), -1)
    of_block[numbers] = whose
    together = of_block[1:] == of_block[:-1]
    pairs = np.where(together, squares[1:] + squares[:-1], 0.0)
    if np.count_nonzero(rows) < 2 * MOMENTS or not pairs.any():
        return None
    worst = int(np.argmax(pairs))
    rest = 1.0 - pairs[worst] / squares.sum()
    others = 1.0 - (rows[worst] + rows[worst + 1]) / rows.sum()
    without = fit.at_command.error / floor.value_at_command * float(np.sqrt(rest / others))
    stretch = stretches[of_block[worst]]
    inside = (numbers == worst) | (numbers == worst + 1)
    motion = stretch.motion
    time = motion.time[stretch.keep[inside[whose == of_block[worst]]]]
    return Moment(motion.file, motion.body, float(time[0]), float(time[-1]), without)
