"""The controller of a public positioning system (EMPS), against its published law.

Janot, Gautier, Brunot, Data Set and Reference Models of EMPS (2019): a voltage 243.45 s V/m times
(160.18/s (reference - position) - velocity), 35.1507 N/V.
"""

import pandas as pd
import pytest
from shared_data import shared_folder

import teleopdesign as td

STIFFNESS, DAMPING = 35.1507 * 243.45 * 160.18, 35.1507 * 243.45
DIAGRAM = f"""
[diagram]
name = "positioning system"
measured = ["L"]
[outside]
L_D = "position"
F = "force"
[blocks.Z_M]
kind = "moving"
motion = "L"
command = "R_A"
loads = {{ F = 1 }}
driver = "F"
axis = "prismatic"
inertia = 95.0
[blocks.K]
kind = "control"
input = "L_E"
output = "R_K"
law = "gain"
parameters = {{ gain = {STIFFNESS} }}
[blocks.D]
kind = "control"
input = "L"
output = "R_B"
motion = "L"
law = "spring_damper"
parameters = {{ stiffness = 0.0, damping = {DAMPING} }}
[junctions]
L_E = {{ L_D = 1, L = -1 }}
R_A = {{ R_K = 1, R_B = -1 }}
"""


@pytest.mark.slow
def test_published_gains_stand_and_the_velocity_is_a_difference_over_two_periods(tmp_path):
    file = shared_folder("data") / "emps" / "emps_estimation.csv.gz"
    (tmp_path / "emps.toml").write_text(DIAGRAM)
    channels = {
        "time": {"column": "time_s", "unit": "s"},
        "L_D": {"column": "reference_m", "unit": "m"},
        "L": {"column": "position_m", "unit": "m", "resolution": 5e-8},
        "R_A": {"column": "force_N", "unit": "N"},
    }
    experiment = td.diagram_experiment(
        td.read_diagram(tmp_path / "emps.toml"), pd.read_csv(file)[:6500], channels=channels,
        outside=["F"], sample_period=1e-3, bandwidth=60,
    )  # fmt: skip
    diagnosis = td.find_missing(experiment, at=["R_A"])
    (delay,) = diagnosis.named_in_computer
    # the mean of two differences over a period is half a period late
    assert delay.added.key == ("delay", "D") and delay.added.value == pytest.approx(5e-4, rel=0.02)
    first, last = (row.check_error for row in (diagnosis.rows[0], diagnosis.rows[-1]))
    assert first > 0.02 and last < 0.001
    gains = [a for a in diagnosis.computer.steps[1].attempts if a.added.effect.name == "gain"]
    assert len(gains) == 3 and all(abs(a.added.value - 1.0) < 1e-3 for a in gains)
