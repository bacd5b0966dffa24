"""The column that numbers trials is neither position nor force, whatever the motion explains."""

import json

import numpy as np

from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log


def test_two_lists_of_rows_without_names(tmp_path):
    """Rows of time, command and position: the leap between two tests looks like a force."""
    t = 0.01 * np.arange(300)
    content = {}
    for start, name in ((10.0, "slow"), (40.0, "fast")):
        x = -0.5 * start * t
        u = -0.7 - 0.01 * start - 0.002 * t
        content[name] = np.round(np.column_stack([start + t, u, x + 20.0 * start]), 6).tolist()
    (tmp_path / "log.json").write_text(json.dumps(content | {"units": "Radians"}))
    result = survey_log(open_log(tmp_path / "log.json", "log.json"), "log.json", Choices())
    assert result.channels["segment"]["column"] == "trial"
    used = {result.channels[key]["column"] for key in ("position", "actuator_force")}
    assert used == {"(2)", "(3)"}
