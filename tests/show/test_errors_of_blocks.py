"""Where blocks of the fit were held out, no error is called that of check records."""

import pytest

import teleopdesign as td
from teleopdesign.diagnose import Diagnosis, LadderRow
from teleopdesign.diagnose.noise_floor import NoiseFloor
from teleopdesign.diagnose.recording import DiagnosedRecording


@pytest.mark.parametrize(
    "check, name", [("records", "check error"), ("blocks of fit", "held-out error")]
)
def test_the_error_has_the_name_of_the_rows_that_it_is_of(check, name):
    experiment = td.load_experiment(td.example("rod"))
    row = LadderRow(
        None, 0.2, 0.2, td.Model.from_experiment(experiment), check_error_at_command=0.2
    )
    recording = DiagnosedRecording(stated=experiment)
    floor = NoiseFloor(0.01, "stated", drawn=0.01)
    diagnosis = Diagnosis("undecided", (row,), floor, (), (), recording=recording, check=check)
    others = {"check error", "held-out error"} - {name}
    for shown in (str(diagnosis), diagnosis._repr_html_()):
        assert name in shown and not any(other in shown for other in others)
