"""Several trials in one log, numbered by a column: a leap between two of them is no motion."""

import numpy as np
import pytest
from check.made_channels import interruptions

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, longest_trial, survey_log

H, ROWS = 2e-3, 1500
ONE = np.arange(ROWS)
T = H * np.arange(4 * ROWS)
TRIAL = np.repeat([1.0, 2.0, 3.0, 4.0], ROWS)


def swing(k):
    """Angle (rad) and torque (N*m) of one trial, which begins anywhere."""
    q = 0.4 * np.sin(5.0 * H * ONE + k) + 0.1 * np.sin(16.0 * H * ONE + 2 * k)
    v = np.gradient(q, H)
    return q + 1.7 * k, 0.02 * np.gradient(v, H) + 0.1 * np.tanh(v / 1e-3)


Q, U = (np.concatenate(parts) for parts in zip(*map(swing, range(4)), strict=True))


def look(columns):
    log = Log(tuple(columns), lambda names: {n: columns[n] for n in names})
    return survey_log(log, "log", Choices())


@pytest.mark.parametrize("name", ["trial", "Trial_No", "run", "Versuch"])
def test_a_column_that_numbers_trials_is_that_of_segments(name):
    survey = look({"t_s": T, name: TRIAL, "angle_rad": Q, "tau_Nm": U})
    assert survey.channels["segment"] == {"column": name}
    assert name not in survey.unused
    assert survey.trials == pytest.approx([H * ROWS * k for k in (1, 2, 3)], abs=H)
    assert "channels.position.sign" not in survey.guesses


def test_pauses_between_trials_are_no_trials():
    stamps = T + 50.0 * (TRIAL - 1)
    survey = look({"t_s": stamps, "trial": TRIAL, "angle_rad": Q, "tau_Nm": U})
    assert survey.trials == pytest.approx([53.0, 106.0, 159.0], abs=0.1)


def test_arrays_of_several_trials_start_anew_at_each():
    """The inertia of this motion came out as zero: a leap of 1.7 rad in a row outweighed it."""
    data = {"t": T, "trial": TRIAL, "q": Q, "u": U}
    words = {"axis": "revolute", "position": "q", "actuator_force": "u"}
    made = td.experiment(data, segment="trial", **words)
    assert len(made.records[0].segments) == 4
    assert made.bodies["device"].inertia.value == pytest.approx(0.02, rel=0.05)
    with pytest.raises(ExperimentError, match='"trail".*did you mean "trial"'):
        td.experiment(data, segment="trail", **words)


def test_no_gap_is_reported_where_trials_follow_at_once():
    """It was the rest of a difference: "the longest gap 3.34e-16 s"."""
    data = {"t": T, "trial": TRIAL, "q": Q, "u": U}
    made = td.experiment(
        data, axis="revolute", position="q", actuator_force="u", segment="trial", inertia=0.02
    )
    (finding,) = interruptions(made.records[0])
    assert "with no gap between them" in finding.sentence
    assert finding.numbers["longest_gap"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("leap", "rows"), [(150.0, 300), (0.0, 300)])
def test_short_trials_count_alone_for_a_position_may_leap_between_them(leap, rows):
    """The velocity was "not that of" its position, whose derivative held the leap."""
    t = H * np.arange(600)
    second = np.arange(600) >= 300
    q, v = Q[:600] + leap * second, np.gradient(Q[:600], H) + 0.5 * leap * second * (leap > 0)
    columns = {"t_s": t, "trial": 1.0 + second, "angle_rad": q, "tau_Nm": U[:600], "w": v}
    result = look(columns)
    assert len(longest_trial(result)["angle_rad"].values) == rows
    assert result.channels["position"]["column"] == "angle_rad"
