"""Bags made message by message: times, numbers and columns, as they are known."""

import numpy as np
import pytest

from teleopdesign.measurement.tables import open_log

rosbag1 = pytest.importorskip("rosbags.rosbag1", reason="needs the extra ros")

BEGIN = 1_700_000_000_000_000_000  # ns
ROWS = 80


@pytest.fixture
def bag(tmp_path):
    """Write messages (topic, type, fields by row) into a bag; ns(k): when row k is recorded."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    types = store.types

    def header(ns, name=""):
        stamp = types["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)
        return types["std_msgs/msg/Header"](seq=0, stamp=stamp, frame_id=name)

    def write(topics, ns):
        path = tmp_path / "run.bag"
        with rosbag1.Writer(path) as out:
            for topic, (kind, fields) in topics.items():
                connection = out.add_connection(topic, kind, typestore=store)
                for k in range(ROWS):
                    message = types[kind](*fields(k))
                    out.write(connection, ns(k), store.serialize_ros1(message, kind))
        return path

    write.header = header
    write.types = types
    return write


def recorded(k):
    return BEGIN + 12_500_000 * k


def columns_of(path):
    log = open_log(path, path.name)
    return log, log.read({n: n for n in log.names})


def test_a_message_without_a_header_has_the_time_of_its_recording(bag):
    path = bag({"/force": ("std_msgs/msg/Float64", lambda k: (0.5 * k,))}, recorded)
    log, columns = columns_of(path)
    assert list(log.names) == ["/force.stamp", "/force.data"]
    assert columns["/force.stamp"] == pytest.approx(0.0125 * np.arange(ROWS))
    assert columns["/force.data"].tolist() == (0.5 * np.arange(ROWS)).tolist()
    assert log.units["/force.stamp"] == "s" and "/force.data" not in log.units
    assert set(log.clocks.values()) == {"/force.stamp"}


@pytest.mark.parametrize("late", [0.003, 9.0, -9.0, 11.0, -11.0])
def test_the_stamp_in_a_header_counts_unless_it_is_of_another_clock(bag, late):
    """Of a clock more than ten seconds off, the times of recording are taken, for all topics."""

    def stamped(k):
        return bag.header(recorded(k) - round(1e9 * late)), bag.types["geometry_msgs/msg/Vector3"](
            1.0 * k, 2.0 * k, -1.0
        )

    topics = {
        "/hand": ("geometry_msgs/msg/Vector3Stamped", stamped),
        "/hand/grip": ("std_msgs/msg/Int16", lambda k: (k % 7,)),
    }
    log, columns = columns_of(bag(topics, recorded))
    written = 0.0125 * np.arange(ROWS)
    expected = written if abs(late) > 10 else written - late
    assert columns["/hand.stamp"] == pytest.approx(expected, abs=1e-9)
    assert columns["/hand/grip.stamp"] == pytest.approx(written)
    assert columns["/hand.vector.y"].tolist() == (2.0 * np.arange(ROWS)).tolist()
    assert columns["/hand/grip.data"].tolist() == [k % 7 for k in range(ROWS)]
    # each column goes with the stamps of its topic, though one topic's name begins the other's
    assert log.clocks["/hand/grip.data"] == "/hand/grip.stamp"
    assert log.clocks["/hand.vector.x"] == "/hand.stamp"


def test_a_header_of_zero_says_no_time(bag):
    def stamped(k):
        return bag.header(0), bag.types["geometry_msgs/msg/Vector3"](1.0 * k, 0.0, 0.0)

    path = bag({"/a": ("geometry_msgs/msg/Vector3Stamped", stamped)}, recorded)
    assert columns_of(path)[1]["/a.stamp"] == pytest.approx(0.0125 * np.arange(ROWS))


def test_joints_have_their_names_and_a_joint_that_comes_and_goes_is_empty_between(bag):
    def joints(k):
        names = ["base", "tip"] if k < 5 or k >= 70 else ["base"]
        n = len(names)
        position = np.array([1.0 * k, 100.0 + k])[:n]
        return bag.header(recorded(k)), names, position, np.zeros(0), np.full(n, 7.0)

    _, columns = columns_of(bag({"/js": ("sensor_msgs/msg/JointState", joints)}, recorded))
    assert columns["/js.base.position"].tolist() == list(range(ROWS))
    assert columns["/js.base.effort"].tolist() == [7.0] * ROWS
    tip = columns["/js.tip.position"]
    rows = np.r_[0:5, 70:ROWS]
    assert tip[rows].tolist() == (100.0 + rows).tolist()
    assert np.isnan(np.delete(tip, rows)).all()
    assert not any("velocity" in n for n in columns)  # none was sent


def test_a_message_of_more_numbers_than_become_columns_keeps_its_time(bag):
    """Seventy joints with position, velocity and effort are 210 numbers."""
    names = [f"j{n}" for n in range(70)]

    def joints(k):
        return bag.header(recorded(k)), names, *(np.arange(70) + 1000.0 * k + i for i in range(3))

    _, columns = columns_of(bag({"/js": ("sensor_msgs/msg/JointState", joints)}, recorded))
    assert columns["/js.stamp"] == pytest.approx(0.0125 * np.arange(ROWS))
    assert columns["/js.j69.position"][3] == 3069.0
    assert 200 <= len(columns) <= 205
