"""A bag as a da Vinci Research Kit records it: joint states, and messages of crtk and cisst."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.measurement.tables import open_log

rosbag1 = pytest.importorskip("rosbags.rosbag1", reason="needs the extra ros")

#: the messages that ROS does not ship, as their packages define them
DEFINITIONS = {
    "crtk_msgs/msg/OperatingState": (
        "std_msgs/Header header\nstring state\nbool is_homed\nbool is_busy\n"
    ),
    "cisst_msgs/msg/vctDoubleVec": "float64[] data\n",
}
JOINTS = ["outer_yaw", "outer_pitch", "outer_insertion"]
MOVING = 2
ROWS = 2500


def motion(log_rate=500.0):
    t = np.arange(ROWS) / log_rate
    speed = 2 * np.pi * 0.6
    q = 0.12 + 0.03 * np.sin(speed * t) + 0.01 * np.sin(2.3 * speed * t)
    v, a = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
    return t, q, v, 0.4 * a + 1.5 * v + 0.8 * np.tanh(v / 1e-3)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A bag of ROS 1 with a slider that moves and two joints at rest."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    for name, text in DEFINITIONS.items():
        store.register(get_types_from_msg(text, name))
    types = store.types
    file = tmp_path_factory.mktemp("dvrk") / "psm1.bag"
    topics = {
        "/PSM1/measured_js": "sensor_msgs/msg/JointState",
        "/PSM1/setpoint_js": "sensor_msgs/msg/JointState",
        "/PSM1/operating_state": "crtk_msgs/msg/OperatingState",
        "/PSM1/io/actuator_current": "cisst_msgs/msg/vctDoubleVec",
    }
    t, q, v, u = motion()
    with rosbag1.Writer(file) as bag:
        connections = {
            n: bag.add_connection(n, kind, typestore=store) for n, kind in topics.items()
        }
        for k in range(ROWS):
            ns = 1_700_000_000_000_000_000 + round(1e9 * t[k])
            stamp = types["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)
            header = types["std_msgs/msg/Header"](seq=k, stamp=stamp, frame_id="")

            def joints(position, velocity, effort, header=header):
                rows = [np.array([0.1, -0.2, x]) for x in (position, velocity, effort)]
                rows[1][:MOVING] = rows[2][:MOVING] = 0.0
                kind = types["sensor_msgs/msg/JointState"]
                return kind(header, JOINTS, *rows)

            messages = {
                "/PSM1/measured_js": joints(q[k], v[k], u[k]),
                "/PSM1/setpoint_js": joints(q[k] + 2e-4, v[k], 0.0),
                "/PSM1/operating_state": types["crtk_msgs/msg/OperatingState"](
                    header, "ENABLED", True, False
                ),
                "/PSM1/io/actuator_current": types["cisst_msgs/msg/vctDoubleVec"](
                    np.array([0.0, 0.0, u[k] / 40.0])
                ),
            }
            for topic, message in messages.items():
                raw = store.serialize_ros1(message, topics[topic])
                bag.write(connections[topic], ns, raw)
    return file


def test_every_message_has_columns_by_its_names(path):
    names = open_log(path, path.name).names
    for quantity in ("position", "velocity", "effort"):
        assert f"/PSM1/measured_js.outer_insertion.{quantity}" in names
    assert "/PSM1/operating_state.is_homed" in names
    assert "/PSM1/io/actuator_current.data[2]" in names


def test_the_joint_that_moves_is_recognised_with_its_measured_position_and_effort(path):
    from teleopdesign.measurement.survey import Choices, survey_log

    survey = survey_log(open_log(path, path.name), path.name, Choices(axis="prismatic"))
    entry = survey.channels
    assert entry["position"]["column"] == "/PSM1/measured_js.outer_insertion.position"
    assert entry["position"]["unit"] == "m"
    assert entry["actuator_force"]["column"] == "/PSM1/measured_js.outer_insertion.effort"
    assert entry["actuator_force"]["unit"] == "N"


@pytest.mark.slow
def test_the_bag_becomes_an_experiment(path, tmp_path, monkeypatch):
    from teleopdesign.cli import main

    monkeypatch.chdir(tmp_path)
    assert main(["new", str(path), "--axis", "prismatic", "--yes"]) == 0
    experiment = td.load_experiment(tmp_path / "psm1_experiment")
    position = experiment.fit_records[0].signals["device.position"]
    assert 0.15 < position.max() < 0.165
