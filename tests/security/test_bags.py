"""What a bag says of its messages becomes source inside its reader: plain words alone get there."""

import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors.topics import open_bag

rosbag2 = pytest.importorskip("rosbags.rosbag2", reason="needs the extra ros")


def bag(folder, msgtype, definition):
    with rosbag2.Writer(folder, version=8) as writer:
        connection = writer.add_connection("/t", msgtype, msgdef=definition, rihs01="RIHS01_00")
        for k in range(3):
            writer.write(connection, k + 1, bytes([0, 1, 0, 0]) + bytes(8))
    return folder


RUN = "__import__('pathlib').Path({mark!r}).write_text('')"


@pytest.mark.parametrize(
    ("msgtype", "definition"),
    [
        ('x/msg/A"""\n    {run}\n    """', "float64 a\n"),
        ("x/msg/A:\n    a = {run}\nclass B", "float64 a\n"),
        ("x/msg/A", "float64 a = {run}\n"),
        ("x/msg/A", "float64[{run}] a\n"),
        ("x/msg/A", "float64 a: {run}\n"),
        ("x/msg/A", "{run} a\n"),
        ("x/msg/A", 'string A="""{run}"""\nfloat64 a\n'),
        ("x/msg/A", "int32 A={run}\nfloat64 a\n"),
        ("x/msg/A'+{run}+'", "float64 a\n"),
        ("x/msg/A b", "float64 a\n"),
    ],
)
def test_no_definition_in_a_bag_runs(tmp_path, msgtype, definition):
    mark = tmp_path / "ran"
    run = RUN.format(mark=str(mark))
    folder = bag(tmp_path / "bag", msgtype.replace("{run}", run), definition.replace("{run}", run))
    try:
        open_bag(folder, "bag")
    except ExperimentError as error:
        assert len(str(error).splitlines()) == 1
    assert not mark.exists()
