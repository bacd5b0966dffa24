"""How a survey reads forces that balance and columns of time: factors and stamps written here."""

import numpy as np
import pytest
from measurement.columns_by_hand import column, log_of

from teleopdesign.measurement.first_guess import FirstGuess
from teleopdesign.measurement.survey import (
    Choices,
    Survey,
    balance,
    candidate_clocks,
    clock,
)

# the balance of two forces


def two_forces(**more):
    """A survey of a torque command `u` and a hand `f`, as far as the balance looks at it."""
    channels = {
        "position": {"column": "q", "unit": "rad"},
        "actuator_force": {"column": "u", "unit": "N*m"},
        "interaction_force": {"column": "f", "unit": "N*m"},
    }
    for key, entry in more.items():
        channels[key].update(entry)
    return Survey("revolute", channels, 6.0)


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [("actuator_force", 4.0, "m: at this distance from the axis, 'u' balances 'f'"),
     ("interaction_force", 0.25, "m: at this distance from the axis, 'f' balances 'u'")],
)  # fmt: skip
def test_a_lever_arm_follows_from_the_factor_of_a_force_or_its_inverse(key, value, text):
    survey = two_forces(**{key: {"lever_arm": {"value": 1.0, "unit": "m"}}})
    balance._guess_lever_arm(survey, key, 4.0, 0.2)
    assert survey.channels[key]["lever_arm"]["value"] == value
    words = survey.guesses[f"channels.{key}.lever_arm"]
    assert words.endswith(text)
    numbers = [float(n) for n in words.partition(" m: ")[0].split(" +- ")]
    assert numbers == pytest.approx([value, 0.2 if value == 4.0 else 0.0125], rel=0.05)


@pytest.mark.parametrize(("unit", "factor"), [("N*m/A", 1.0), ("mN*m/A", 1e3)])
@pytest.mark.parametrize(
    ("guessed", "doubt"),
    [((), "'u' balances 'f'"),
     (("unit",), "'u' balances 'f', if the latter is in N*m"),
     (("lever_arm",), "'u' balances 'f', if the latter acts at 1 m from the axis")],
)  # fmt: skip
def test_a_motor_constant_follows_from_the_factor_of_its_current(unit, factor, guessed, doubt):
    constant = {"value": 1.0, "unit": unit}
    survey = two_forces(actuator_force={"unit": "A", "torque_constant": constant})
    survey.guesses.update({f"channels.interaction_force.{k}": "" for k in guessed})
    survey.guesses["channels.actuator_force.torque_constant"] = "a placeholder"
    assert balance._has_placeholder(survey)
    balance._guess_constant(survey, 0.05, 0.001)
    assert constant["value"] == pytest.approx(0.05 * factor)
    text = survey.guesses["channels.actuator_force.torque_constant"]
    assert text.endswith(doubt) and f"{unit}: with it, " in text
    assert f"+- {0.001 * factor:.3g}"[:4] in text and not balance._has_placeholder(survey)
    constant["value"] = 1.0
    survey.guesses.clear()
    assert not balance._has_placeholder(survey), "stated by the user"


@pytest.mark.parametrize(
    ("scale", "error", "names", "ratio", "noted"),
    [(1.24, 0.01, "qu", None, False), (1.26, 0.01, "qu", None, True),
     (0.81, 0.01, "qu", None, False), (0.79, 0.01, "qu", None, True),
     (30.3, 0.2, "motor", 30.0, False), (30.5, 0.2, "motor", 30.5, False),
     (0.5, 0.01, "motor", None, True), (30.0, 1.6, "motor", None, False)],
)  # fmt: skip
def test_a_factor_far_from_one_is_a_gear_of_a_motor_and_else_a_note(
    monkeypatch, scale, error, names, ratio, noted
):
    """From a quarter on; a standard error of a twentieth is too large; a whole number near."""
    survey = two_forces()
    if names == "motor":
        survey.channels["position"]["column"] = "motor_q"
        survey.channels["actuator_force"]["column"] = "motor_u"
    monkeypatch.setattr(balance, "_command_scale", lambda *_: (scale, error))
    balance.scale_by_balance(survey, None, Choices())
    for key in ("position", "actuator_force"):
        assert survey.channels[key].get("gear_ratio") == ratio
    assert "gear_ratio" not in survey.channels["interaction_force"]
    assert len(survey.notes) == noted and ("channels.position.gear_ratio" in survey.guesses) == (
        ratio is not None
    )
    if noted:
        assert "'f' only with a factor of" in survey.notes[0]


def test_a_gear_that_a_line_states_is_used_only_where_both_names_are_of_a_motor(monkeypatch):
    monkeypatch.setattr(balance, "_command_scale", lambda *_: (1.0, 0.01))
    for position, force, used in (("motor_q", "motor_u", True), ("q", "motor_u", False)):
        survey = two_forces(position={"column": position}, actuator_force={"column": force})
        survey.remarks = ("gear ratio: 30",)
        balance.scale_by_balance(survey, None, Choices())
        assert survey.channels["position"].get("gear_ratio") == (30.0 if used else None)
        assert len(survey.notes) == (not used)
        stated = two_forces(position={"column": position}, actuator_force={"column": force})
        stated.remarks = survey.remarks
        balance.scale_by_balance(stated, None, Choices(gear_ratio=30.0))
        assert not stated.notes and not stated.guesses


@pytest.mark.parametrize(
    ("name", "unit", "named", "may"),
    [("foo", "N*m", True, True), ("foo", "mm", False, False), ("foo", None, True, False),
     ("foo", None, False, True), ("cmd", None, False, False), ("cmd", "N*m", False, False),
     ("position", "N*m", False, False), ("motor_foo", None, False, True),
     ("motor_foo", None, True, False), ("motor_torque", None, True, False),
     ("motor_torque", "N*m", True, True), ("load_torque", None, True, True),
     ("load_tau", None, True, True), ("load_stau", None, True, False),
     ("gesamtdrehmoment", None, True, True), ("外部力矩", None, True, True)],
)  # fmt: skip
def test_what_may_balance_a_command_by_name_and_unit(name, unit, named, may):
    assert balance._may_balance(column(name, unit=unit), "revolute", named=named) == may


@pytest.mark.parametrize(
    ("factor", "left", "explained", "accepted"),
    [(1.0, 0.81, 0.7, True), (1.0, 0.82, 0.7, False), (1.0, 0.5, 0.66, False),
     (-1.0, 0.5, 0.7, True), (1.24, 0.5, 0.7, True), (1.26, 0.5, 0.7, False),
     (0.81, 0.5, 0.7, True), (0.79, 0.5, 0.7, False), (-0.79, 0.5, 0.7, False)],
)  # fmt: skip
def test_a_hand_without_a_name_leaves_two_thirds_of_the_squares_with_a_factor_near_one(
    monkeypatch, factor, left, explained, accepted
):
    """Alone, the motion explains half of the command and leaves 1."""

    def explain(force, *_):
        alone = np.array_equal(force, survey.columns["u"].values)
        best = FirstGuess(1, 1, 1, explained, (0, 0, 0), left)
        signs.append(np.sign((force - survey.columns["u"].values) @ survey.columns["f"].values))
        return FirstGuess(1, 1, 1, 0.5, (0, 0, 0), 1.0) if alone else best

    signs = []
    survey = two_forces()
    survey.columns = {"u": column("u", [1.0, 2, 3]), "f": column("foo", [3.0, 1, 2])}
    monkeypatch.setattr(balance, "explain_force", explain)
    monkeypatch.setattr(balance, "balance_factor", lambda *_: (factor, 0.0))
    free = {"u": survey.columns["u"], "foo": survey.columns["f"]}
    hand = balance.hand_by_balance(survey, free, "u", (np.zeros(3), 0.1))
    assert hand == ("foo" if accepted else None)
    if accepted:
        assert signs[-1] == np.sign(factor)
        why = survey.guesses["channels.interaction_force.column"]
        assert f"the motion leaves {1 - left**2:.0%} less of the command 'u'" in why


# the time


@pytest.mark.parametrize(
    ("name", "values", "unit", "coarse"),
    [("time", [0, 0, 1, 1, 2, 3.0], None, True), ("time", [0, 0, 1, 1, 2, 2.0], None, False),
     ("time", [0, 1, 2, 3, 2, 4.0], None, False), ("foo", [0, 0, 1, 1, 2, 3.0], None, False),
     ("foo", [0, 0, 1, 1, 2, 3.0], "s", True), ("foo", [0, 0, 1, 1, 2, 3.0], "mm", False),
     ("foo", [0, 0, 1, 1, 2, 3.0], "counts", False), ("ms", [0, 0, 1, 1, 2, 3.0], None, True),
     ("time", [0, np.nan, 1, 1, 2, 3.0], None, True)],
)  # fmt: skip
def test_a_time_that_many_rows_share_never_falls_and_changes_three_times(
    name, values, unit, coarse
):
    log = log_of({}, units={} if unit is None else {name: unit})
    assert clock._is_coarse_time(name, np.array(values), log) == coarse


RISING = np.arange(9.0)


@pytest.mark.parametrize(
    ("raw", "choices", "expected", "guessed"),
    [({"t": RISING, "q": -RISING}, {"sample_rate": 50.0}, (None, "s"), None),
     ({"foo": RISING, "time": RISING}, {}, ("time", "s"), "channels.time.unit"),
     ({"foo": 0.1 * RISING, "bar": RISING}, {}, ("foo", "s"), "channels.time.column"),
     ({"q": -RISING}, {}, (None, "s"), "sample_rate"),
     ({"foo": RISING, "q": -RISING}, {"time": "q", "units": {"q": "ms"}}, ("q", "ms"), None),
     ({"ms": RISING, "foo": RISING}, {}, ("ms", "ms"), None),
     ({"t [us]": RISING, "foo": RISING}, {}, ("t [us]", "us"), None)],
)  # fmt: skip
def test_which_column_is_the_time_and_in_which_unit(raw, choices, expected, guessed):
    guesses = {}
    result = clock.time_column(raw, log_of(raw), Choices(**choices), guesses, "log")
    assert result[0] == expected[0]
    assert guesses.keys() - {"channels.time.unit"} == ({guessed} - {None, "channels.time.unit"})
    if guessed != "channels.time.unit" and guessed != "channels.time.column":
        assert result[1] == expected[1]


def test_among_several_clocks_that_of_the_position_is_the_time():
    raw = {"a.stamp": RISING, "b.stamp": RISING, "a.force": RISING, "b.position": RISING}
    clocks = {"a.force": "a.stamp", "b.position": "b.stamp", "a.stamp": "a.stamp"}
    log = log_of(raw, {**clocks, "b.stamp": "b.stamp"})
    assert candidate_clocks.busiest_clock(log, raw, Choices()) == "b.stamp"
    assert candidate_clocks.busiest_clock(log, raw, Choices(position="a.force")) == "a.stamp"
    wanted = {"a.stamp": RISING, "b.stamp": RISING, "a.cmd_pos": RISING, "b.pos": RISING}
    log = log_of(wanted, {"a.cmd_pos": "a.stamp", "b.pos": "b.stamp", "a.stamp": "a.stamp",
                          "b.stamp": "b.stamp"})  # fmt: skip
    assert candidate_clocks.busiest_clock(log, wanted, Choices()) == "b.stamp"


def test_columns_lie_on_the_grid_of_the_time_each_by_its_clock():
    n = 1001
    t = 1000.0 * np.arange(n) + 5000.0
    slow = 5000.0 + 4000.0 * np.arange(251)
    raw = {"t": t, "x": 3.0 * t, "f": 2.0 * slow, "f.t": slow, "other": np.arange(7.0),
           "empty": np.full(n, np.nan)}  # fmt: skip
    raw["empty"][3] = 1.0
    two = np.full(n, np.nan)
    two[[0, -1]] = 0.0, 1000.0
    raw["two"] = two
    log = log_of(raw, {"f": "f.t", "f.t": "f.t"}, units={"f": "N"})
    time, columns = clock.interpolate_columns(raw, log, "t", "ms", Choices(units={"x": "mm"}), "l")
    assert time == pytest.approx(np.arange(n)) and set(columns) == {"x", "f", "two"}
    assert columns["x"].values == pytest.approx(3.0 * t) and columns["x"].unit == "mm"
    assert columns["two"].values == pytest.approx(np.arange(n))
    assert columns["two"].readings.tolist() == [0.0, 1000.0] and columns["f"].unit == "N"
    assert clock.duration_of(raw, "t", "ms", Choices()) == pytest.approx(1000.0)
    assert clock.duration_of(raw, None, "s", Choices(sample_rate=50.0)) == 20.0
    assert clock.duration_of(raw, None, "s", Choices()) == 1.0
    plain = {"x": np.arange(101.0), "few": np.arange(7.0)}
    time, columns = clock.interpolate_columns(
        plain, log_of(plain), None, "s", Choices(sample_rate=50.0), "l"
    )
    assert time == pytest.approx(0.02 * np.arange(101)) and set(columns) == {"x"}
