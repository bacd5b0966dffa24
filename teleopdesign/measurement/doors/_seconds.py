"""The time stamps of a table in seconds, whatever their unit: those of several tables compare."""

from __future__ import annotations

import numpy as np

from ...base.units import measures, si_factor
from ._log import Array, Log


def seconds_of(log: Log, column: str, file: str) -> Array:
    """The time stamps of a table in s, from the same instant for all tables of one logger."""
    from ..column_names import unit_in_name
    from ..numbers_in_cells import numbers_of
    from ..stamp_unit import unit_of_steps
    from ..wrapped_stamps import unwrap_stamps

    values = np.asarray(log.read({column: "channels.time"})[column])
    if values.dtype.kind == "M":
        return np.asarray((values - np.datetime64(0, "s")) / np.timedelta64(1, "ns") * 1e-9)
    stamps = (
        values.reshape(-1).astype(np.float64)
        if values.dtype.kind in "iu"  # as floats, nanoseconds since 1970 are exact to 256 ns
        else numbers_of(values, column, file)
    )
    unit = log.units.get(column) or unit_in_name(column, "time")
    if unit is None or not measures(unit, "time"):
        unit = unit_of_steps(stamps)[0]
    return np.asarray(unwrap_stamps(stamps)[0] * si_factor(unit, quantity="time"))
