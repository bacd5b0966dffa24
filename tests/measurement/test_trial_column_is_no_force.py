"""The column that numbers trials is neither position nor force, whatever the motion explains."""

import json

import numpy as np

from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log


def test_lists_of_rows_without_names(tmp_path):
    """Rows of time, command and position: the leaps between short tests look like a force."""
    t = 0.01 * np.arange(60)
    content = {}
    for k in range(5):
        x = 20.0 * k - 5.0 * t
        u = -0.7 - 0.002 * np.sin(9.0 * t)
        content[f"test {k}"] = np.round(np.column_stack([10.0 * k + t, u, x]), 6).tolist()
    (tmp_path / "log.json").write_text(json.dumps(content | {"units": "Radians"}))
    result = survey_log(open_log(tmp_path / "log.json", "log.json"), "log.json", Choices())
    assert result.channels["segment"]["column"] == "trial"
    used = {result.channels[key]["column"] for key in ("position", "actuator_force")}
    assert used == {"(2)", "(3)"}
