"""Signed numbers that a logger wrote as counts: 65315 for -221, or 1245 where bit 10 is the sign.

Drives report a two's complement of some bits, servos on a bus a size beside a bit for the sign. A
logger that reads either as a count writes no number below 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.errors import ExperimentError
from ..base.toml import Table
from .encoder import Array
from .limits import HALF, SEVERAL, SMALL

#: keys of a channel, one for each code
TWOS_COMPLEMENT, SIGN_BIT = "twos_complement", "sign_bit"
#: most bits of a whole number that float64 holds exactly
MOST_BITS = 53
#: least range of readings that are looked at
LEAST_RANGE = 2**7


@dataclass(frozen=True)
class SignCode:
    """How a column holds signed numbers.

    key: "twos_complement" or "sign_bit"
    bits: number of bits of the two's complement, or number of the bit that is the sign
    """

    key: str
    bits: int

    @property
    def end(self) -> float:
        """The first count that is no number in this code."""
        return 2.0 ** (self.bits + (self.key == SIGN_BIT))

    def decode(self, counts: Array) -> Array:
        """The numbers (n,) of counts (n,); a count below half of `end` is itself."""
        negative = 0.5 * self.end - counts if self.key == SIGN_BIT else counts - self.end
        return np.where(counts >= HALF * self.end, negative, counts)

    def refuse_other_counts(self, counts: Array, where: str) -> None:
        """Raise an ExperimentError for a reading that is no count of this code."""
        largest = float(np.max(counts, initial=-np.inf, where=np.isfinite(counts)))
        if largest >= self.end:
            raise ExperimentError(
                f"{where}: found a reading of {largest:g}, expected less than {self.end:g} with "
                f"{self.key} = {self.bits}"
            )


def sign_code_from(table: Table) -> SignCode | None:
    """The code that a channel's table states; raises ExperimentError: both codes, or no bit."""
    stated = [key for key in (TWOS_COMPLEMENT, SIGN_BIT) if key in table.content]
    if not stated:
        return None
    if len(stated) == 2:
        raise ExperimentError(f"{table.where(stated[0])}: found beside {stated[1]}, expected one")
    bits = table.number(stated[0])
    least = 2 if stated[0] == TWOS_COMPLEMENT else 1
    if bits != int(bits) or not least <= bits <= MOST_BITS - 1:
        raise ExperimentError(
            f"{table.where(stated[0])}: found {bits:g}, expected a whole number from {least} to "
            f"{MOST_BITS - 1}"
        )
    return SignCode(stated[0], int(bits))


def sign_code_of(readings: Array) -> SignCode | None:
    """The code of a column of counts that change far less if read with a sign; None: there is none.

    The highest bit is then the sign, both signs occur with several values, and their sizes compare.
    """
    counts = readings[np.isfinite(readings)]
    if not len(counts) or counts.min() < 0 or not LEAST_RANGE <= counts.max() < 2.0**MOST_BITS / 2:
        return None
    if not np.array_equal(counts, np.round(counts)):
        return None
    bit = int(np.floor(np.log2(counts.max())))
    codes = (SignCode(SIGN_BIT, bit), SignCode(TWOS_COMPLEMENT, bit + 1))
    changes = {code: _changes(code.decode(counts)) for code in codes}
    best = min(codes, key=lambda code: changes[code])
    if changes[best] >= HALF * _changes(counts):
        return None
    numbers = best.decode(counts)
    of_sign = [np.unique(numbers[sign * numbers > 0]) for sign in (1, -1)]
    # a command that is on or off has two values, and may be 0 and 200 by choice
    if min(map(len, of_sign)) < SEVERAL:
        return None
    sizes = sorted(float(np.max(np.abs(values))) for values in of_sign)
    return best if sizes[0] >= SMALL * sizes[1] else None


def _changes(numbers: Array) -> float:
    return float(np.sum(np.abs(np.diff(numbers))))
