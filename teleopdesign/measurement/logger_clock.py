"""Clock of a logger: by how much the log of a force may be early or late against the position."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LoggerClock:
    """Prior knowledge of the clock of a logger; `CLOCK` is in use."""

    #: samples, standard deviation of a shift: twice this is one row. Lower: a delay of less than a
    #: row is called physics; higher: what a shift imitates is left open
    spread: float = 0.5
    #: samples by which a command may be logged early: one row, and a tenth for errors of an
    #: estimate. More is a delay
    early: float = 1.1
    #: s by which the log of a force may be late where that is more: what a low-pass of 15 Hz passes
    #: is 11 ms late, buffers of a logger are a few rows. Lower: they are called a compliance;
    #: higher: a compliance with large damping is called a late log
    latest: float = 0.05
    #: s, standard deviation of the shift of a measured force where it is more: sensors filter
    sensor_spread: float = 0.005
    #: part of its bound from which a shift counts as at the bound: far nearer than a standard error
    near: float = 0.999
    #: rows and standard errors from which a command that acts late is said to be like a delay
    reported_rows: float = 0.1
    reported_errors: float = 2.0


#: prior knowledge of the clock of a log
CLOCK = LoggerClock()
