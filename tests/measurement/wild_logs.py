"""Raw logs of one motor joint as seven loggers write them, and the clean record behind them.

The joint is the shipped rod, its position times 20 rad/m and its forces times 0.05 m: a revolute
axis with Coulomb and viscous friction and a Stribeck effect that its model lacks.
"""

import json

import numpy as np

import teleopdesign as td

ROWS = 7000  # 7 s at 1 kHz
STEP = np.deg2rad(0.01)
CONSTANT = 0.037  # N*m/A
_TURN = 2 * np.pi


def clean():
    """t (s), q (rad, read by the encoder), u and hand (N*m): 7 s at 1 kHz."""
    record = td.load_experiment(td.example("rod")).fit_records[0]
    signals = {k: v[:ROWS] for k, v in record.signals.items()}
    q = read(20.0 * signals["device.position"])
    u, hand = (0.05 * signals[f"device.{n}_force"] for n in ("actuator", "interaction"))
    return {"t": np.arange(ROWS) / 1000.0, "q": q, "u": u, "hand": hand}


def read(angle):
    return STEP * np.round(angle / STEP)


def at(log, stamps):
    """The signals at other instants: the position is read there by the same encoder."""
    t = log["t"]
    return {
        "t": stamps,
        "q": read(np.interp(stamps, t, log["q"])),
        "hand": np.interp(stamps, t, log["hand"]),
    }


def text(columns, separator=",", form="%.10g", comma=False):
    rows = np.column_stack(list(columns.values())).tolist()
    lines = [separator.join(form % v for v in row) for row in rows]
    if comma:
        lines = [line.replace(".", ",") for line in lines]
    return "\n".join(lines) + "\n"


def jittered_csv(folder, log, rng):
    """Milliseconds, degrees and amperes; stamps 5 % of a row off, 14 rows lost."""
    stamps = log["t"] + 5e-5 * np.clip(rng.standard_normal(ROWS), -3, 3)
    columns = at(log, stamps)
    table = {
        "Time (ms)": 1e3 * stamps,
        "Pos (deg)": np.rad2deg(columns["q"]),
        "Current (A)": log["u"] / CONSTANT,
        "Hand torque (Nm)": columns["hand"],
    }
    kept = np.sort(rng.permutation(np.arange(1, ROWS - 1))[14:])
    table = {n: v[kept] for n, v in table.items()}
    path = folder / "joint.csv"
    path.write_text(",".join(table) + "\n" + text(table))
    return [path], ["--torque-constant", f"{CONSTANT} N*m/A"]


def german_csv(folder, log, rng):
    """Semicolons, decimal commas, a title, a row of units, text of Windows."""
    table = {"Zeit": log["t"], "Winkel": np.rad2deg(log["q"])}
    table |= {"Drehmoment": log["u"], "Handmoment": log["hand"]}
    head = "Prüfstand 3;;;\n" + ";".join(table) + "\ns;°;Nm;Nm\n"
    path = folder / "messung.csv"
    path.write_bytes((head + text(table, ";", comma=True)).encode("cp1252"))
    return [path], ["--hand", "Handmoment"]


def matlab_struct(folder, log, rng):
    from scipy.io import savemat

    path = folder / "run7.mat"
    names = {"t": "t", "q": "q", "u": "tau", "hand": "tau_hand"}
    savemat(path, {"log": {new: log[old][:, None] for old, new in names.items()}})
    return [path], ["--axis", "revolute"]


def ros_bag(folder, log, rng):
    """A bag of ROS 2: joint states, commands and a wrench, each topic with stamps of its own."""
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = {n: store.types[n] for n in store.types}
    Time, Header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
    State, Number = types["sensor_msgs/msg/JointState"], types["std_msgs/msg/Float64"]
    Wrench, Vector = types["geometry_msgs/msg/WrenchStamped"], types["geometry_msgs/msg/Vector3"]
    begin = 1_700_000_000_000_000_000
    path = folder / "arm_bag"
    with Writer(path, version=9) as bag:
        topics = {}
        for topic, kind in (
            ("/joint_states", "sensor_msgs/msg/JointState"),
            ("/elbow_effort_controller/command", "std_msgs/msg/Float64"),
            ("/hand_sensor", "geometry_msgs/msg/WrenchStamped"),
        ):
            topics[kind] = bag.add_connection(topic, kind, typestore=store)
        none = np.zeros(0)
        for k in range(ROWS):
            ns = begin + k * 1_000_000
            stamp = Time(sec=ns // 10**9, nanosec=ns % 10**9)
            header = Header(stamp=stamp, frame_id="")
            wrench = types["geometry_msgs/msg/Wrench"](
                force=Vector(x=0.0, y=0.0, z=0.0),
                torque=Vector(x=0.0, y=0.0, z=float(log["hand"][k])),
            )
            messages = [
                State(header=header, name=["elbow"], position=np.array([log["q"][k]]),
                      velocity=none, effort=none),
                Number(data=float(log["u"][k])),
                Wrench(header=header, wrench=wrench),
            ]  # fmt: skip
            for connection, message in zip(topics.values(), messages, strict=True):
                raw = store.serialize_cdr(message, message.__msgtype__)
                bag.write(connection, ns, raw)
    return [path], []


def robot_log(folder, log, rng):
    """Stamps of 2 ms, 30 % of a row off; a command holds from each row to the next."""
    stamps = np.arange(0.002, 6.99, 0.002)
    stamps = stamps + 0.002 * rng.uniform(-0.3, 0.3, len(stamps))
    columns = at(log, stamps)
    total = np.concatenate([[0.0], np.cumsum(log["u"]) / 1000.0])
    ends = np.append(stamps, stamps[-1] + 0.002)
    edges = np.append(log["t"], log["t"][-1] + 0.001)
    command = np.diff(np.interp(ends, edges, total)) / np.diff(ends)
    table = {"timestamp": 5000.0 + stamps, "actual_q_0": columns["q"], "target_moment_0": command}
    table["tcp_contact_0"] = columns["hand"]
    path = folder / "robot.txt"
    path.write_text(" ".join(table) + "\n" + text(table, " "))
    return [path], ["--hand", "tcp_contact_0"]


def wrapped_angle(folder, log, rng):
    """An angle of 0 to 360 degrees that wraps, 0.2 % of the rows lost."""
    kept = np.r_[True, rng.random(ROWS - 2) > 0.002, True]
    table = {"t_s": log["t"], "angle_deg": np.rad2deg(log["q"]) % 360.0}
    table |= {"torque_Nm": log["u"], "hand_Nm": log["hand"]}
    table = {n: v[kept] for n, v in table.items()}
    path = folder / "wrapped.csv"
    path.write_text(",".join(table) + "\n" + text(table))
    return [path], []


LOGS = (jittered_csv, german_csv, matlab_struct, ros_bag, robot_log, wrapped_angle)


def data_frame(log):
    import pandas as pd

    table = {"Time (ms)": 1e3 * log["t"], "Pos (deg)": np.rad2deg(log["q"])}
    return pd.DataFrame(table | {"Torque (Nm)": log["u"], "Hand (Nm)": log["hand"]})


def answer_of(path):
    return json.loads(path.read_text())
