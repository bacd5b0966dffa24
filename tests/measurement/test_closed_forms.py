"""Numbers of the readers and their tools against closed formulas, and limits from both sides."""

import datetime
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.conversion import Conversion
from teleopdesign.measurement.files import content_digest, experiment_files
from teleopdesign.measurement.filtering import spectrum
from teleopdesign.measurement.first_guess import explain_force, explain_forces
from teleopdesign.measurement.numbers_in_cells import numbers_of
from teleopdesign.measurement.reversals import look_back_to_reversal, mark_reversals

# reversals


@given(
    signs=st.lists(st.sampled_from([-1, 0, 0, 1]), min_size=1, max_size=40), rest=st.integers(0, 4)
)
def test_what_is_behind_each_sample_is_counted_from_where_its_motion_began(signs, rest):
    direction, h = np.array(signs, dtype=np.int8), 0.5
    position = np.cumsum(direction * 1.5)
    back = look_back_to_reversal(direction, position, sample_time=h, rest=(rest + 0.5) * h)
    began, before, last = None, 0.0, None
    for k, way in enumerate(signs):
        if way:
            gap = 0 if last is None else k - last
            if began is None or way != signs[last] or gap > rest + 0.5:
                began, before = k, gap * h
            last = k
        assert back.known[k] == (began is not None)
        assert back.time[k] == (0.0 if began is None else (k - began) * h)
        assert back.travel[k] == (0.0 if began is None else abs(position[k] - position[began]))
        assert back.rested[k] == (0.0 if began is None else before)


@given(signs=st.lists(st.sampled_from([-1, 0, 1]), min_size=1, max_size=40), n=st.integers(0, 5))
def test_samples_near_a_reversal_are_those_within_so_many_of_it(signs, n):
    moving = [k for k, way in enumerate(signs) if way]
    turned = [b for a, b in zip(moving, moving[1:], strict=False) if signs[a] != signs[b]]
    near = mark_reversals(np.array(signs, dtype=np.int8), within=n)
    assert near.tolist() == [any(abs(k - t) <= n for t in turned) for k in range(len(signs))]


# columns


def test_a_signal_is_the_sum_of_columns_times_scales_plus_offset_times_the_factor():
    columns = {"a": np.array([1.0, 2.0]), "b": np.array([10.0, 30.0])}
    both = Conversion(("a", "b"), (2.0, -0.5), offset=3.0, factor=4.0)
    assert both.signal(columns).tolist() == [0.0, -32.0]
    assert not both.is_plain and both.wraps(columns) == 0
    plain = Conversion(("b",), (1.0,), factor=0.1)
    assert plain.is_plain and plain.signal(columns).tolist() == [1.0, 3.0]
    for other in ({"offset": 1.0}, {"period": 9.0}):
        assert not Conversion(("b",), (1.0,), **other).is_plain
    assert not Conversion(("b",), (2.0,)).is_plain


def test_a_column_wraps_where_it_jumps_by_more_than_half_the_period():
    x = np.array([0.0, 170.0, 350.0, 171.0, 350.0, 10.0, 200.0])
    turned = Conversion(("x",), (1.0,), period=360.0)
    # 180 is half a turn and no wrap; 340 and 190 are
    assert turned.wraps({"x": x}) == 2
    assert turned.signal({"x": x}).tolist() == [0.0, 170.0, 350.0, 171.0, 350.0, 370.0, 200.0]


AXES = {"revolute": "N*m", "prismatic": "N"}
CHANNELS = [
    # axis, quantity, channel, what one unit of the column is in SI
    ("revolute", "position", {"unit": "deg"}, pi / 180),
    ("revolute", "position", {"unit": "deg", "gear_ratio": 50, "sign": -1}, -pi / 180 / 50),
    ("revolute", "position", {"unit": "counts", "counts_per_turn": 4096}, 2 * pi / 4096),
    ("prismatic", "position", {"unit": "counts", "count": {"value": 0.5, "unit": "um"}}, 5e-7),
    ("prismatic", "position", {"unit": "mm", "scale": -3.0}, -3e-3),
    (
        "prismatic",
        "position",
        {"unit": "rad", "gear_ratio": {"value": 4.0, "unit": "rad/mm"}},
        1e-3 / 4.0,
    ),
    (
        "revolute",
        "actuator_force",
        {"unit": "A", "torque_constant": {"value": 37.0, "unit": "mN*m/A"}, "gear_ratio": 50},
        0.037 * 50,
    ),
    (
        "revolute",
        "actuator_force",
        {"unit": "mA", "torque_constant": {"value": -0.2, "unit": "N*m/A"}},
        -2e-4,
    ),
]


@pytest.mark.parametrize(("axis", "quantity", "channel", "unit"), CHANNELS)
def test_one_unit_of_a_column_is_so_much_of_the_signal(axis, quantity, channel, unit):
    t = np.arange(400) / 200.0
    table = {"t": t, "x": np.sin(t), "y": np.cos(t)}
    force = AXES[axis]
    channels = {"position": {"column": "x", "unit": "m" if axis == "prismatic" else "rad"}}
    channels["actuator_force"] = {"column": "y", "unit": force}
    channels[quantity] = {"column": channels[quantity]["column"], **channel}
    made = td.experiment(table, axis=axis, inertia=1.0, **channels)
    signal = made.records[0].signals[f"device.{quantity}"]
    assert signal == pytest.approx(unit * table[channels[quantity]["column"]], rel=1e-12)
    if channel["unit"] == "counts":
        assert made.channels[f"device.{quantity}"].resolution == pytest.approx(abs(unit))


REFUSED = [
    ({"unit": "counts"}, "what one count is"),
    ({"unit": "counts", "counts_per_turn": 0}, "counts_per_turn"),
    ({"unit": "rad", "counts_per_turn": 4096}, 'expected unit "counts"'),
    ({"unit": "rad", "gear_ratio": 0}, "gear_ratio: found 0"),
    ({"unit": "rad", "gear_ratio": -3}, "sign = -1"),
    ({"unit": "rad", "sign": 2}, "expected 1 or -1"),
    ({"unit": "rad", "scale": 0}, "other than 0"),
    ({"unit": "rad", "scale": True}, "other than 0"),
    ({"unit": "rad", "scale": [1.0, 2.0]}, "found 2 numbers, expected 1"),
    ({"unit": "rad", "torque_constant": 0.1}, "expected on a force"),
    ({"unit": "rad", "delay": {"value": 0.201, "unit": "s"}}, "at most 0.2 s"),
    ({"unit": "rad", "delay": {"value": -201, "unit": "ms"}}, "at most 0.2 s"),
    ({"unit": "counts", "counts_per_turn": 9, "unwrap": -1}, "unwrap"),
    ({"unit": "counts", "count": {"value": 1, "unit": "rad"}, "unwrap": True}, "counter wraps"),
    ({"column": ["x", "x"], "unit": "rad"}, "a column twice"),
    ({"column": [], "unit": "rad"}, "names of columns"),
    ({"column": ["x", " "], "unit": "rad"}, "names of columns"),
]


@pytest.mark.parametrize(("channel", "words"), REFUSED)
def test_keys_that_do_not_suit_each_other_are_refused_in_words(channel, words):
    t = np.arange(400) / 200.0
    table = {"t": t, "x": np.sin(t), "y": np.cos(t)}
    with pytest.raises(ExperimentError, match=words):
        td.experiment(
            table,
            axis="revolute",
            inertia=1.0,
            position={"column": "x", **channel},
            actuator_force={"column": "y", "unit": "N*m"},
        )


@pytest.mark.parametrize("delay", [0.2, -0.2])
def test_a_delay_of_a_fifth_of_a_second_is_taken_off(delay):
    t = np.arange(4000) / 200.0
    late = np.sin(t - delay)
    position = {"column": "x", "unit": "rad", "delay": {"value": 1e3 * delay, "unit": "ms"}}
    force = {"column": "y", "unit": "N*m"}
    made = td.experiment(
        {"t": t, "x": late, "y": late},
        axis="revolute",
        inertia=1.0,
        position=position,
        actuator_force=force,
    )
    inner = slice(60, -60)
    signal = made.records[0].signals["device.position"]
    assert signal[inner] == pytest.approx(np.sin(t)[inner], abs=1e-6)


MINUTE = datetime.datetime(2026, 1, 1, 12, 0)
CELLS = [
    (np.array([[1.0], [2.0]]), [1.0, 2.0]),
    (np.array([[1, 2, 3]]), [1.0, 2.0, 3.0]),
    (np.array([True, False]), [1.0, 0.0]),
    (np.array([None, 2], dtype=object), [np.nan, 2.0]),
    (np.array(["1.5", 2], dtype=object), [1.5, 2.0]),
    (np.array([2**53, 2**53 + 2]), [float(2**53), float(2**53 + 2)]),
    # above, numbers count from the first
    (np.array([2**53 + 1, 2**53 + 3]), [0.0, 2.0]),
    (np.array([-(2**60), 5 - 2**60]), [0.0, 5.0]),
    (np.array(["2026-01-01T12", "NaT", "2026-01-01T13"], "datetime64[m]"), [0.0, np.nan, 3600.0]),
    (np.array([500, 1500], "timedelta64[ms]"), [0.0, 1.0]),
    (np.array([MINUTE, MINUTE + datetime.timedelta(seconds=2)], dtype=object), [0.0, 2.0]),
]


@pytest.mark.parametrize(("cells", "numbers"), CELLS, ids=lambda v: str(v)[:30])
def test_cells_are_numbers_or_seconds(cells, numbers):
    out = numbers_of(cells, "x", "log.csv")
    assert out.dtype == np.float64
    np.testing.assert_array_equal(out, numbers)


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        (np.zeros((2, 2)), r"log.csv: channels.position: column \"x\": found an array of shape"),
        (np.array([1, "a"], dtype=object), r"column \"x\", row 2: found \"a\", expected a number"),
        (np.array([1j, 2j]), "row 1: found"),
    ],
)
def test_cells_that_are_no_numbers_are_named_with_their_row(cells, words):
    with pytest.raises(ExperimentError, match=words):
        numbers_of(cells, "x", "log.csv", "channels.position")


# files


def test_the_digest_of_an_experiment_is_that_of_the_files_that_it_names(tmp_path):
    (tmp_path / "experiment.toml").write_text('[[records]]\nfile = "a.csv"\n')
    (tmp_path / "a.csv").write_text("1")
    (tmp_path / "b.csv").write_text("1")
    assert list(experiment_files(tmp_path)) == ["experiment.toml", "a.csv"]
    first = content_digest(tmp_path)
    (tmp_path / "b.csv").write_text("2")
    assert content_digest(tmp_path) == first
    (tmp_path / "a.csv").write_text("2")
    second = content_digest(tmp_path)
    (tmp_path / "a.csv").unlink()
    (outside := tmp_path.parent / "outside.csv").write_text("2")
    third = content_digest(tmp_path)
    (tmp_path / "a.csv").symlink_to(outside)
    assert experiment_files(tmp_path)["a.csv"] is None, "a link that leads out of the folder"
    assert len({first, second, third}) == 3 and content_digest(tmp_path) == third


def test_the_files_of_a_bag_count_one_by_one(tmp_path):
    (tmp_path / "experiment.toml").write_text('[[records]]\nfile = "bag"\n')
    (tmp_path / "bag" / "deep").mkdir(parents=True)
    (tmp_path / "bag" / "deep" / "x.db3").write_text("1")
    (tmp_path / "bag" / "metadata.yaml").write_text("1")
    names = ["experiment.toml", "bag/deep", "bag/deep/x.db3", "bag/metadata.yaml"]
    assert list(experiment_files(tmp_path)) == names
    (tmp_path / "experiment.toml").write_text("[[records]\n")
    assert list(experiment_files(tmp_path)) == ["experiment.toml"]


# filters of a spectrum, at a sine that they know


H = 0.002
TIME = H * np.arange(4000)
INNER = slice(1000, -1000)


@pytest.mark.parametrize("f", [3.0, 20.0])
def test_filters_do_to_a_sine_what_their_formulas_say(f):
    s, w = spectrum(len(TIME), H), 2 * pi * f
    y = np.sin(w * TIME)
    assert s.multiply(y, s.derivative(1))[INNER] == pytest.approx(
        w * np.cos(w * TIME)[INNER], abs=1e-3 * w
    )
    assert s.multiply(y, s.derivative(2))[INNER] == pytest.approx(
        -(w**2) * y[INNER], abs=1e-3 * w**2
    )
    ahead = s.multiply(y, s.ahead(0.007))
    assert ahead[INNER] == pytest.approx(np.sin(w * (TIME + 0.007))[INNER], abs=1e-3)
    assert s.ahead(0.0) == 1.0
    # forward and backward, of order 4: the square of a Butterworth gain on warped frequencies
    ratio = np.tan(pi * f * H) / np.tan(pi * 20.0 * H)
    low = s.multiply(y, s.lowpass(20.0))
    assert low[INNER] == pytest.approx(y[INNER] / (1 + ratio**8), abs=1e-3)
    slow = s.multiply(y, s.lowpass(20.0, order=2))
    assert slow[INNER] == pytest.approx(y[INNER] / (1 + ratio**4), abs=1e-3)


@pytest.mark.parametrize(("parts", "which"), [(1, 0), (2, 0), (2, 1), (4, 3)])
def test_a_held_sine_is_late_and_weaker_by_the_part_of_the_row_in_which_it_is_held(parts, which):
    f = 20.0
    s, w = spectrum(len(TIME), H), 2 * pi * f
    held = s.multiply(np.sin(w * TIME), s.hold(parts, which))
    part = H / parts
    gain = np.sin(w * part / 2) / (w * part / 2) / parts
    late = part * (which + 0.5)
    assert held[INNER] == pytest.approx(gain * np.sin(w * (TIME - late))[INNER], abs=1e-3)


# first values


def swing():
    x = np.sin(2 * pi * 0.7 * TIME) + 0.3 * np.sin(2 * pi * 1.9 * TIME)
    s = spectrum(len(TIME), H)
    v, a = (s.multiply(x, s.derivative(n)) for n in (1, 2))
    return x, v, a


def test_inertia_level_and_damping_are_read_off_a_force_that_they_make():
    x, v, a = swing()
    force = 0.2 * a + 0.7 * np.sign(v) + 0.05 * v + 3.0
    guess = explain_force(force, x, H)
    assert (guess.inertia, guess.level) == (
        pytest.approx(0.2, rel=0.01),
        pytest.approx(0.7, rel=0.02),
    )
    assert guess.damping == pytest.approx(0.05, abs=0.01)
    assert guess.explained > 0.999 and guess.left < 0.02
    noise = 0.5 * np.random.default_rng(1).standard_normal(len(force))
    more = explain_force(force + noise, x, H)
    off = np.array([more.inertia - 0.2, more.level - 0.7, more.damping - 0.05])
    assert np.all(np.abs(off) < 4 * np.array(more.errors)) and more.left > 2 * guess.left
    twice = explain_forces([(force, x), (force, x)], H)
    assert twice.inertia == pytest.approx(guess.inertia) and twice.left == pytest.approx(guess.left)
    assert np.array(twice.errors) == pytest.approx(np.array(guess.errors) / 2**0.5)


def test_of_too_short_or_endless_readings_no_first_value_is_read():
    x, _, a = swing()
    trim = round(0.25 / H)
    for force, position in ((a[: 4 * trim - 1], x[: 4 * trim - 1]), (1e200 * a, x)):
        guess = explain_force(force, position, H)
        values = (guess.inertia, guess.level, guess.damping, guess.explained, guess.left)
        assert values == (0.0,) * 5 and np.isinf(guess.errors).all()
    assert explain_force(a[: 4 * trim], x[: 4 * trim], H).inertia == pytest.approx(1.0, rel=0.2)


# how short a record may be, and how uneven


def read(t, **more):
    table = {"t": t, "x": np.sin(t), "y": np.cos(t)}
    return td.experiment(
        table, axis="revolute", position="x", actuator_force="y", inertia=1.0, **more
    ).records[0]


def test_sixty_four_rows_of_a_second_are_a_record():
    assert len(read(np.arange(64) / 64.0).time) == 64
    with pytest.raises(ExperimentError, match="found 63 rows, expected at least 64"):
        read(np.arange(63) / 50.0)
    with pytest.raises(ExperimentError, match=r"found 0.985 s of samples, expected at least 1 s"):
        read(np.arange(64) / 65.0)


@pytest.mark.parametrize(("lost", "stretches"), [(5, 1), (6, 2)])
def test_five_lost_rows_are_filled_and_six_are_a_pause(lost, stretches):
    t = np.delete(np.arange(300) / 100.0, np.arange(100, 100 + lost))
    record = read(t)
    assert len(record.segments) == stretches
    assert len(record.time) == (300 if stretches == 1 else 300 - lost)


@pytest.mark.parametrize(("force", "position"), [("s", "rad"), ("N*m", "A"), ("A", "rad")])
def test_a_constant_of_a_motor_is_asked_for_beside_a_current_that_is_a_force(force, position):
    t = np.arange(400) / 200.0
    with pytest.raises(ExperimentError) as refused:
        td.experiment(
            {"t": t, "x": np.sin(t), "y": np.cos(t)},
            axis="revolute",
            inertia=1.0,
            position={"column": "x", "unit": position},
            actuator_force={"column": "y", "unit": force},
        )
    assert ("torque_constant" in str(refused.value)) == (force == "A")
