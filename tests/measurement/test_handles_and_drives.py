"""Logs of handles, of drives on a field bus and of analog inputs: levers, objects, offsets."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.commands.new import survey_text
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.value_text import lever_arm

T = np.arange(6000) / 500.0
Q = 0.5 * np.sin(2 * np.pi * 0.7 * T) + 0.1 * np.sin(2 * np.pi * 2.3 * T)
NEEDED = 0.02 * np.gradient(np.gradient(Q, T), T) + 0.1 * np.sign(np.gradient(Q, T))
ARM = 0.07  # m
HANDLE = 2.0 * np.sin(2 * np.pi * 0.9 * T)  # N
U = NEEDED - ARM * HANDLE
PADDLE = {"t [s]": T, "theta_rad": Q, "motor_torque_Nm": U, "handle_force_N": HANDLE}
WORDS = {"axis": "revolute", "position": "theta_rad", "actuator_force": "motor_torque_Nm"}


def look(columns, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices(**choices))


def test_the_lever_of_a_handle_follows_from_the_balance_with_the_motor():
    """1 N beside an angle was read as 1 N m, and the name was said to state no unit."""
    survey = look(PADDLE)
    hand = survey.channels["interaction_force"]
    assert hand["unit"] == "N"
    assert hand["lever_arm"]["value"] == pytest.approx(ARM, rel=0.02)
    assert "at this distance from the axis, 'handle_force_N' balances 'motor_torque_Nm'" in (
        survey_text(survey, "log")
    )


def test_the_lever_of_a_motor_in_newtons_follows_from_the_balance_with_a_torque():
    columns = {"t [s]": T, "q [rad]": Q, "F_motor [N]": U / 0.03, "hand [Nm]": ARM * HANDLE}
    motor = look(columns).channels["actuator_force"]
    assert motor["unit"] == "N"
    assert motor["lever_arm"]["value"] == pytest.approx(0.03, rel=0.02)


def test_a_stated_lever_stands():
    survey = look(PADDLE, lever_arm=(80.0, "mm"))
    assert survey.channels["interaction_force"]["lever_arm"] == {"value": 80.0, "unit": "mm"}
    assert "channels.interaction_force.lever_arm" not in survey.guesses


def test_a_lever_that_nothing_states_is_a_placeholder():
    survey = look({"t [s]": T, "theta_rad": Q, "F_motor_N": NEEDED})
    assert survey.channels["actuator_force"]["lever_arm"] == {"value": 1.0, "unit": "m"}
    assert (
        "its distance from the axis is not known"
        in (survey.guesses["channels.actuator_force.lever_arm"])
    )
    assert '--lever-arm "VALUE m"' in survey_text(survey, "log")


def test_a_torque_in_newtons_is_taken_for_one_whose_unit_was_shortened():
    columns = {"t [s]": T, "theta_rad": Q, "motor_torque_N": NEEDED}
    assert look(columns).channels["actuator_force"]["unit"] == "N*m"


def test_a_force_at_a_lever_is_its_torque():
    lever = {"column": "handle_force_N", "lever_arm": {"value": 70, "unit": "mm"}}
    made = td.experiment(PADDLE, interaction_force=lever, inertia=0.02, **WORDS)
    assert made.records[0].signals["device.interaction_force"] == pytest.approx(ARM * HANDLE)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"unit": "N"}, r"expected a torque, or beside a force lever_arm = \{"),
        (
            {"unit": "N*m", "lever_arm": {"value": 1, "unit": "m"}},
            r"found \"N\*m\" times \"\(m\)\"",
        ),
        ({"unit": "N", "lever_arm": 0.07}, "no unit, expected"),
        ({"unit": "N", "lever_arm": {"value": -1, "unit": "m"}}, "expected above 0"),
        ({"unit": "N", "lever_arm": {"value": 1, "unit": "rad"}}, "lever_arm"),
    ],
)
def test_a_lever_that_does_not_suit_is_refused(entry, message):
    with pytest.raises(ExperimentError, match=message):
        td.experiment(
            PADDLE, interaction_force={"column": "handle_force_N", **entry}, inertia=0.02, **WORDS
        )


def test_only_a_force_beside_an_angle_has_a_lever():
    lever = {"column": "theta_rad", "unit": "m", "lever_arm": {"value": 1, "unit": "m"}}
    words = {**WORDS, "axis": "prismatic", "position": lever}
    with pytest.raises(ExperimentError, match="expected on a force of a revolute axis"):
        td.experiment(PADDLE, inertia=0.02, **words)


@pytest.mark.parametrize("text", ["", "long", "0 mm", "-70 mm", "70", "70 mA", "nan mm"])
def test_what_is_no_length_is_no_lever(text):
    with pytest.raises(ExperimentError, match="--lever-arm: found"):
        lever_arm(text, where="--lever-arm")
    assert lever_arm("70 mm", where="--lever-arm") == (70.0, "mm")


COUNTED = np.round(Q / (2 * np.pi) * 65536)


@pytest.mark.parametrize("names", [("0x6064", "0x6071:00"), ("Position actual value", "Torque")])
def test_a_drive_on_a_field_bus_counts_its_encoder(names):
    """Counts were taken for degrees or millimetres, and addresses named nothing."""
    survey = look({"t [s]": T, names[0]: COUNTED, names[1]: np.round(NEEDED * 1000)})
    position, force = (survey.channels[k] for k in ("position", "actuator_force"))
    assert (position["column"], force["column"]) == names
    assert position["unit"] == "counts"


def test_the_torque_object_of_a_drive_is_reported_to_be_in_parts_of_a_rated_torque():
    survey = look({"t [s]": T, "0x6064": COUNTED, "0x6077": np.round(NEEDED * 1000)})
    assert "parts of a rated force" in survey.guesses["channels.actuator_force.unit"]


def test_degrees_in_whole_numbers_stay_degrees():
    survey = look({"t [s]": T, "angle": np.round(np.rad2deg(4 * Q)), "torque": NEEDED})
    assert survey.channels["position"]["unit"] == "deg"


@pytest.mark.parametrize(("middle", "size"), [(512, 400), (2048, 900), (128, 100)])
def test_an_analog_input_has_no_force_at_its_middle(middle, size):
    """A current that an input of 10 bits read as 512 at rest was a mean current of 512 A."""
    read = np.round(middle + size * NEEDED / np.max(np.abs(NEEDED)))
    force = look({"t [s]": T, "theta_rad": Q, "adc_current": read}).channels["actuator_force"]
    assert force["offset"] == -middle


@pytest.mark.parametrize("read", [600 * NEEDED, 512 + 99.5 * NEEDED, np.abs(600 * NEEDED)])
def test_what_changes_its_sign_or_is_no_whole_number_has_no_offset(read):
    columns = {"t [s]": T, "theta_rad": Q, "current": read}
    assert "offset" not in look(columns).channels["actuator_force"]
