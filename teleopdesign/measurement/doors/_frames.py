"""Text with the frames of a CAN bus, as candump and bus analysers write it: refused.

    (1736150000.123656) can0 181#3712A0FEFFFF2C00
    can0  181   [8]  37 12 A0 FE FF FF 2C 00
    0.001000 1  181  Rx   d 8 37 12 A0 FE FF FF 2C 00

Which bytes of a frame are a position is not in the file. Read as a table, they would be numbers.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from ...base.errors import ExperimentError

_BYTES = r"(?:[ \t]++[0-9A-Fa-f]{2}\b)"
_FRAME = re.compile(
    r"\b[0-9A-Fa-f]{3,8}##?[0-9A-Fa-f]*+\b"  # candump -L
    rf"|\b[0-9A-Fa-f]{{3,8}}[ \t]++\[\d\d?\]{_BYTES}*"  # candump
    rf"|\b[RT]x[ \t].*[ \t]\d\d?{_BYTES}{{2}}"  # analysers: direction, length, bytes
)
#: part of the lines that are frames; others are comments and events of the bus
MOST_OF_THEM = 0.5


def refuse_frames(lines: Sequence[str], file: str) -> None:
    """Raise an ExperimentError for a file of frames."""
    filled = [line[:200] for line in lines if line.strip()]
    count = sum(_FRAME.search(line) is not None for line in filled)
    if count >= 3 and count >= MOST_OF_THEM * len(filled):
        raise ExperimentError(
            f"{file}: found frames of a CAN bus, expected signals: decode them into a table with "
            "the time of each frame (cantools does it with the description of the bus), in columns "
            "such as time, position and torque"
        )
