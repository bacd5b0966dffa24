"""The current that a drive draws from its supply, beside the command of a torque."""

import numpy as np
import pytest

from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log

ROWS = 1500
T = 0.01 * np.arange(ROWS)
Q = 40.0 + 30.0 * np.sin(2 * np.pi * 0.3 * T) * np.cos(0.2 * T)
RATE = np.gradient(Q, T)
U = 0.05 * np.gradient(RATE, T) + 2.0 * np.sign(RATE) + 0.1 * RATE


def look(columns):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices())


@pytest.mark.parametrize("offset", [0.0, 0.03])
def test_the_current_of_a_supply_is_not_that_of_the_motor(offset):
    """It has one sign; the torque command has both, and was set aside for it."""
    drawn = np.abs(U) / 3.0 - offset * np.abs(U).max() / 3.0
    columns = {"t": T, "position [deg]": Q, "ff torque cmd [Nm]": U, "ina1 current [A]": drawn}
    survey = look(columns)
    assert survey.channels["actuator_force"]["column"] == "ff torque cmd [Nm]"
    motor = look({**columns, "ina1 current [A]": U / 3.0 + 0.5 * np.sin(5.0 * T)})
    assert motor.channels["actuator_force"]["column"] == "ina1 current [A]"
