"""A motor whose motion `Q` (rad) needs the torque `U`, and logs of columns that a test writes."""

import numpy as np

from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, SurveyedColumn, survey_log

T = 0.005 * np.arange(1200)
Q = np.sin(2 * np.pi * 0.7 * T) + 0.2 * np.sin(2 * np.pi * 2.1 * T)
V = np.gradient(Q, T)
U = 0.02 * np.gradient(V, T) + 0.3 * np.sign(V)


def column(name, values=(0.0, 1.0), unit=None):
    values = np.asarray(values, dtype=float)
    return SurveyedColumn(name, values, values, unit)


def log_of(columns, clocks=(), **more):
    return Log(tuple(columns), lambda w: {n: columns[n] for n in w}, clocks=dict(clocks), **more)


def look(columns, **choices):
    return survey_log(log_of(columns), "log", Choices(**choices))
