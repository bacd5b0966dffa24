"""What `new` takes of a log and what it leaves: every column is in a channel, or has a reason."""

import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.cli import main
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, spans_of, survey_log

ROWS = 3000  # 3 s at 1 kHz
T = np.arange(ROWS) / 1000.0
RNG = np.random.default_rng(5)


def swing():
    """A mass of 0.2 kg with friction, moved by a command and a hand that works against it."""
    q = 0.03 * np.sin(2 * np.pi * 1.3 * T) + 0.01 * np.sin(2 * np.pi * 3.1 * T)
    v, a = np.gradient(q, T), np.gradient(np.gradient(q, T), T)
    hand = 0.8 * np.sin(2 * np.pi * 0.9 * T + 1.0) + 0.3 * np.sin(2 * np.pi * 2.3 * T)
    return {"t": T, "x": q, "u": 0.2 * a + 0.6 * np.sign(v) + 1.5 * v - hand}, v, hand


COLUMNS, VELOCITY, HAND = swing()
#: name -> (values, a part of the reason why the column is in no channel)
OTHERS = {
    "speed": (VELOCITY, "--unit 'speed=UNIT'"),
    "x_desired": (COLUMNS["x"] + 1e-3, "a desired value"),
    "temp (K)": (300 + RNG.standard_normal(ROWS), "in K"),
    "state": (np.ones(ROWS), "does not change"),
    "counter": (np.arange(ROWS), "only rises"),
    "x_2": (RNG.standard_normal(ROWS).cumsum(), "a position beside 'x'"),
    "ch7": (RNG.standard_normal(ROWS), "the motion explains 0% of it"),
    "note": (np.array(["ok"] * ROWS), "holds no numbers"),
}


def look(columns, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices(**choices))


@pytest.mark.parametrize("name", OTHERS)
def test_a_column_that_is_left_out_has_its_reason(name):
    values, why = OTHERS[name]
    assert why in look({**COLUMNS, name: values}).unused[name]


def test_a_repeated_name_is_left_out_with_its_reason():
    log = Log((*COLUMNS, "x2", "x2"), lambda wanted: {n: COLUMNS[n] for n in wanted})
    assert survey_log(log, "log", Choices()).unused == {"x2": "2 columns have this name"}


@pytest.mark.slow
def test_the_table_the_file_and_the_picture_say_what_is_not_used(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    table = {**COLUMNS, **{n: v for n, (v, _) in OTHERS.items()}}
    rows = zip(*(v.tolist() for v in table.values()), strict=True)
    lines = [",".join(map(str, row)) for row in rows]
    (tmp_path / "log.csv").write_text("\n".join([",".join(table), *lines]) + "\n")
    assert main(["new", "log.csv", "--yes", "--output", "joint"]) == 0
    output, written = capsys.readouterr().out, (tmp_path / "joint" / "experiment.toml").read_text()
    comments = [line for line in written.splitlines() if line.startswith("#   ")]
    assert len(comments) == len(OTHERS)
    for name, (_, why) in OTHERS.items():
        assert any(line.strip().startswith(name) and why in line for line in output.splitlines())
        assert any(f'"{name}"' in line and why in line for line in comments)


def test_the_picture_names_some_and_counts_the_rest():
    from teleopdesign.show.figures.log import unused_lines

    assert unused_lines({}) == []
    assert unused_lines({"a": "b"}) == ['not used: "a": b']
    assert unused_lines({f"c{k}": "b" for k in range(20)})[-1].startswith("... and 8 more")


@pytest.mark.slow
@given(st.lists(st.text(min_size=1, max_size=8), min_size=1, max_size=6, unique=True))
def test_every_column_of_any_name_is_in_a_channel_or_has_a_reason(tmp_path_factory, names):
    from teleopdesign.measurement.new_folder import experiment_text

    more = {n: RNG.standard_normal(ROWS) for n in names if n not in COLUMNS}
    survey = look({**COLUMNS, **more}, time="t", position="x", actuator_force="u")
    used = {e["column"] for e in survey.channels.values()}
    assert used | set(survey.unused) == {*COLUMNS, *more}
    assert not used & set(survey.unused)
    text = experiment_text(survey, [], title="any", inertia=1.0, first=None, effects=())
    assert tomllib.loads(text)["channels"]["position"]["column"] == "x"


@pytest.mark.parametrize(("sign", "name"), [(1, "ch3"), (-1, "ch3"), (1, "G7 (N)")])
def test_a_force_that_balances_with_the_command_is_the_hands_whatever_its_name(sign, name):
    survey = look({**COLUMNS, name: sign * HAND, "other": RNG.standard_normal(ROWS)})
    entry = survey.channels["interaction_force"]
    assert entry["column"] == name
    assert entry.get("sign", 1) == sign
    assert "less of the command" in survey.guesses["channels.interaction_force.column"]
    assert "other" in survey.unused


def test_a_log_has_no_hand_force_where_the_user_states_that_there_is_none():
    survey = look({**COLUMNS, "ch3": HAND}, interaction_force="none")
    assert "interaction_force" not in survey.channels
    assert "ch3" in survey.unused


@pytest.mark.parametrize(
    "other",
    [
        COLUMNS["u"],  # the command once more
        0.9 * COLUMNS["u"] + 0.01 * RNG.standard_normal(ROWS),  # the force that a drive measured
        3.0 * HAND,  # balances, but with a factor of three
        RNG.standard_normal(ROWS),
        VELOCITY,
    ],
)
def test_no_other_column_is_taken_for_the_hands_force(other):
    assert "interaction_force" not in look({**COLUMNS, "ch3": other}).channels


def test_columns_that_may_be_the_position_as_well_make_it_a_guess():
    two = {"t": T, "q_0": COLUMNS["x"], "q_1": np.roll(COLUMNS["x"], 400), "u": COLUMNS["u"]}
    guess = look(two).guesses["channels.position.column"]
    assert "'q_0' is read as the position" in guess and "'q_1' may be the position as well" in guess


def test_a_log_is_used_whole_however_much_of_it_is_looked_at():
    """A survey looks at some 60 000 rows; spans of an experiment are those of the whole log."""
    repeats = 25
    whole = {name: np.tile(values, repeats) for name, values in COLUMNS.items()}
    whole["t"] = np.arange(repeats * ROWS) / 1000.0
    survey = look(whole)
    assert len(survey.time) < len(whole["t"])
    assert survey.duration == pytest.approx(repeats * ROWS / 1000.0 - 0.001)
    (begin, cut), (after, end) = spans_of(survey.duration)
    assert (begin, after) == (0.0, cut) and end >= survey.duration
    del whole["t"]
    assert look(whole, sample_rate=1000.0).duration == pytest.approx(survey.duration)


def currents(feedback, noise=0.02):
    """A log with the current that a model asks for, and the one that a drive measured.

    feedback: N, friction that the model lacks and that feedback adds
    """
    columns = COLUMNS["u"] + HAND
    lacking = feedback * np.sign(VELOCITY) * np.exp(-((VELOCITY / 0.1) ** 2))
    made = np.r_[np.zeros(2), (columns + lacking)[:-2]] + noise * RNG.standard_normal(ROWS)
    return {"t": T, "x": COLUMNS["x"], "target_current": columns / 5, "actual_current": made / 5}


def test_a_wanted_current_that_did_not_act_leaves_its_place_to_the_measured_one():
    survey = look(currents(feedback=1.0))
    assert survey.channels["actuator_force"]["column"] == "actual_current"
    assert survey.channels["actuator_force"]["measured"] is True  # no lag or limit is sought in it
    assert "the command 'target_current'" in survey.guesses["channels.actuator_force.column"]
    assert survey.unused["target_current"] == "a desired value, not a measured one"


@pytest.mark.parametrize("noise", [0.02, 0.3])
def test_a_wanted_current_that_the_drive_made_stays(noise):
    survey = look(currents(feedback=0.0, noise=noise))
    assert survey.channels["actuator_force"]["column"] == "target_current"


def test_a_torque_behind_the_gear_is_no_current_that_acted():
    table = currents(feedback=1.0)
    table["joint_torque"] = table.pop("actual_current")
    assert look(table).channels["actuator_force"]["column"] == "target_current"
