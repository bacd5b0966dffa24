"""A recorded command as a smooth signal at its rows, for one delay of its log after another.

A search evaluates the same record hundreds of times. The transform of its command is computed once,
and the smooth signal once for each delay in a row.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .filtering import Array, Spectrum


@dataclass
class HeldCommand:
    """The transform of a held command on one grid, and the last smooth signal made of it.

    last: delay (s) of the log, gain of the smoothing, and the signal with these
    """

    spectrum: Spectrum
    transformed: NDArray[np.complex128]
    last: tuple[float, Array, Array] | None = field(default=None)

    def smooth(self, late: float, smoothing: Array) -> Array:
        """The command at the rows (n,), advanced by the delay `late` (s) of its log."""
        last = self.last
        if last is None or last[0] != late or last[1] is not smoothing:
            gain = smoothing * self.spectrum.ahead(late)
            last = self.last = (late, smoothing, self.spectrum.back(self.transformed * gain))
        return last[2]


#: identity of a recorded command -> the command while it lives, and what was computed of it
_known: dict[int, tuple[weakref.ref[Array], HeldCommand]] = {}


def held_command(command: Array, spectrum: Spectrum) -> HeldCommand:
    """The held command of a record (n,) on its grid; nothing writes into a record's array."""
    place = id(command)
    known = _known.get(place)
    if known is not None and known[0]() is command and known[1].spectrum is spectrum:
        return known[1]
    held = HeldCommand(spectrum, spectrum.transform(command) * spectrum.hold())
    _known[place] = (weakref.ref(command, lambda _: _known.pop(place, None)), held)
    return held
