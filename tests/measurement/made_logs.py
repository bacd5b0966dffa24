"""One joint in text logs as programs write them: its signals, rows of them, and what is read."""

import numpy as np

from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log

ROWS = 1600
T = 0.002 * np.arange(ROWS)
Q = np.round(5000 * np.sin(2 * np.pi * 0.9 * T) + 1500 * np.sin(2 * np.pi * 2.3 * T)) / 100
V = np.gradient(Q, T)
U = np.round(2e-4 * np.gradient(np.convolve(V, np.ones(9) / 9, "same"), T) + 0.5 * np.sign(V), 3)


def rows(form, *columns):
    return [form % row for row in zip(*(np.asarray(c).tolist() for c in columns), strict=True)]


def survey(tmp_path, lines, name="log.csv", **choices):
    path = tmp_path / name
    path.write_text("\n".join(lines) + "\n")
    log = open_log(path, name)
    return log, survey_log(log, name, Choices(**choices))


def columns_of(channels):
    return {quantity: entry.get("column") for quantity, entry in channels.items()}
