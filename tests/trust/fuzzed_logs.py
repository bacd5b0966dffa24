"""Good files of loggers, of arms and of what the package keeps, as bytes, and their readers."""

import gzip
import json
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import sympy as sp
from arms.arm_simulator import random_arm, urdf
from measurement.rod_example import rows

import teleopdesign as td
from teleopdesign.arms import read_urdf
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log
from teleopdesign.passivity import positive_real, read_record
from teleopdesign.studies import read_study
from teleopdesign.studies.journal import Journal

#: 1.2 s at 100 Hz, a little more than the least that is accepted: a bag's messages are slow
COUNT = 120


def columns():
    """A rod of 0.15 kg with friction, moved at 1.3 Hz; names as loggers write them."""
    t = np.arange(COUNT) / 100
    x, v = 0.01 * np.cos(8 * t), -0.08 * np.sin(8 * t)
    hand = 0.3 * np.sin(3 * t)
    motor = -0.15 * 64 * x + 0.5 * np.tanh(v / 1e-3) + 2 * v - hand
    return {"time_s": t, "motor_force": motor, "position_mm": 1e3 * x, "hand_force": hand}


def _german():
    lines = rows(columns()).replace(",", ";").replace(".", ",").splitlines()
    return "\n".join(["Prüfstand 3;;;", lines[0], "s;Nm;mm;N", *lines[1:], ""]).encode("cp1252")


def _trace():
    """A signal after the other, each with its times, as controllers write traces."""
    table = columns()
    lines = ["[key]; [value]"]
    for k, name in enumerate(n for n in table if n != "time_s"):
        lines += [f"{k}.Variable; {name}", f"{k}.Data; "]
        lines += [
            f"; {1e3 * t:g}; {x:g}" for t, x in zip(table["time_s"], table[name], strict=True)
        ]
    return "\n".join([*lines, ""]).encode()


def _pairs():
    """A time before each signal, the force at half the rate of the position."""
    table = columns()
    t, x, u = (table[n] for n in ("time_s", "position_mm", "motor_force"))
    lines = ["position_mm,,motor_force,", "X,Y,X,Y"]
    for k in range(COUNT):
        half = f"{t[2 * k]:g},{u[2 * k]:g}" if 2 * k < COUNT else ","
        lines.append(f"{t[k]:g},{x[k]:g},{half}")
    return "\n".join([*lines, ""]).encode()


def _arrays(path):
    np.savez(path, **columns())


def _matlab(path):
    from scipy.io import savemat

    savemat(path, {"log": {n: v[:, None] for n, v in columns().items()}, "gain": 2.0})


def _workbook(path):
    from openpyxl import Workbook

    book = Workbook()
    table = columns()
    for row in [list(table), *zip(*(v for v in table.values()), strict=True)]:
        book.active.append([v if isinstance(v, str) else float(v) for v in row])
    book.save(path)


def _bag_of_ros_1(path):
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores

    _write_bag(Writer(path), Stores.ROS1_NOETIC, {"seq": 0}, "serialize_ros1")


def _bag_of_ros_2(path):
    """One file of the folder that ROS 2 writes."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores

    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "run"
        writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
        _write_bag(writer, Stores.ROS2_HUMBLE, {}, "serialize_cdr")
        path.write_bytes(next(folder.glob("*.mcap")).read_bytes())


def _write_bag(writer, store, more, serialize):
    from rosbags.typesys import get_typestore

    known = get_typestore(store)
    state, types = "sensor_msgs/msg/JointState", known.types
    table = columns()
    with writer as bag:
        connection = bag.add_connection("/joint", state, typestore=known)
        for k in range(COUNT):
            ns = 1_700_000_000_000_000_000 + 10_000_000 * k
            stamp = types["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)
            header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="", **more)
            x, u = (table[n][k : k + 1].astype(float) for n in ("position_mm", "motor_force"))
            message = types[state](header, ["axis"], x, np.zeros(0), u)
            bag.write(connection, ns, getattr(known, serialize)(message, state))


def _study(path):
    def measured(a, b):
        return a + b

    axes = {"a": np.arange(3.0), "b": np.arange(2.0)}
    td.study(measured, axes, measures={"c": float}, workers=1).to_netcdf(path)


#: ending -> what writes such a file
_WRITERS = {
    "npz": _arrays,
    "mat": _matlab,
    "xlsx": _workbook,
    "bag": _bag_of_ros_1,
    "mcap": _bag_of_ros_2,
    "nc": _study,
}


@cache
def log_bytes(ending):
    """Bytes of a good file of that kind."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"log.{ending}"
        _WRITERS[ending](path)
        return path.read_bytes()


def _motion():
    s = sp.Symbol("s")
    claim = positive_real((s**2 - s / 10 + 1) / (s + 1) ** 2)
    return json.dumps(claim.record.as_dict()).encode()


def _journal():
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.nc.part"
        read_journal_at(path)
        return path.read_bytes()


def read_journal_at(path):
    """Go on with a study of three points; the second that stands there fails."""
    from teleopdesign.studies.outcomes import PointOutcome

    journal = Journal(path, "one study", 3)
    try:
        for point in range(3):
            reason = "does not stand" if point == 1 else ""
            journal.add(PointOutcome(point, (("c", ""),), (float(point),), reason))
    finally:
        journal.close()


def read_log(content, folder, *, ending):
    """Open a log and look at what it holds, as `teleopdesign new` does."""
    path = folder / f"log.{ending}"
    path.write_bytes(content)
    survey_log(open_log(path, path.name), path.name, Choices())


def read_kept(content, folder, *, name, read):
    path = folder / name
    path.write_bytes(content)
    read(path)


def _log_reader(ending):
    return lambda content, folder: read_log(content, folder, ending=ending)


def _kept_reader(name, read):
    return lambda content, folder: read_kept(content, folder, name=name, read=read)


def made_readers():
    """Reader -> (a good file, what reads its bytes in a folder)."""
    plain = rows(columns()).encode()
    arm = urdf(random_arm(np.random.default_rng(0), 3), inertial=True).encode()
    joints = ["axis1", "axis2", "axis3"]
    return {
        "log": (plain, _log_reader("csv")),
        "log.gz": (gzip.compress(plain, mtime=0), _log_reader("csv.gz")),
        "german": (_german(), _log_reader("txt")),
        "trace": (_trace(), _log_reader("csv")),
        "pairs": (_pairs(), _log_reader("csv")),
        **{e: (log_bytes(e), _log_reader(e)) for e in _WRITERS if e != "nc"},
        "nc": (log_bytes("nc"), _kept_reader("s.nc", lambda p: repr(read_study(p)))),
        "journal": (_journal(), _kept_reader("a.nc.part", read_journal_at)),
        "motion": (_motion(), _kept_reader("m.json", read_record)),
        "urdf": (arm, _kept_reader("arm.urdf", lambda p: read_urdf(p, p.name, joints))),
    }
