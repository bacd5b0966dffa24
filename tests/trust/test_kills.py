"""A command that is killed at any moment leaves every file whole: the old one or the new one."""

import json
import random
import signal
import subprocess
import sys
import time

import pytest
from security.diagram_file import diagram_file
from trust.fuzzing import ROOT, STUDY
from trust.test_environments import environment
from trust.test_invariance import as_recorded, written

#: the command with few effects, so that a diagnosis takes a second
FEW = """
import sys
from teleopdesign import effects
from teleopdesign.cli import main
few = ("coulomb", "viscous", "stribeck", "bias")
known = effects.catalogue
effects.catalogue = lambda extra=(): {n: e for n, e in known(extra).items() if n in few}
sys.exit(main(sys.argv[1:]))
"""
OLD = b"the one before"
#: of a whole file: how it ends
ENDINGS = {".png": b"IEND\xaeB`\x82", ".html": b"</html>", ".svg": b"</svg>", ".pdf": b"%%EOF"}


def is_whole(path):
    content = path.read_bytes()
    if content == OLD:
        return True
    if path.suffix == ".json":
        return isinstance(json.loads(content), dict)
    if path.suffix == ".nc":
        return content.startswith(b"\x89HDF") and _opens(path)
    if path.suffix == ".toml":
        return content.endswith(b"\n")
    return content.rstrip().endswith(ENDINGS[path.suffix])


def _opens(path):
    import xarray

    with xarray.open_dataset(path, engine="h5netcdf") as data:
        return data.sizes["C.stiffness"] == 3


def start(arguments):
    return subprocess.Popen(
        [sys.executable, "-c", FEW, *map(str, arguments)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=environment(),
        start_new_session=True,
    )


def kill_at(process, moment, folder):
    """Kill it at that moment, s after it began to write, or after its start if that is negative."""
    until = time.monotonic() + 60
    if moment < 0:
        until = time.monotonic() - moment
    while time.monotonic() < until and process.poll() is None:
        if moment >= 0 and any(p.name.startswith(".") for p in folder.iterdir()):
            time.sleep(moment)
            break
        time.sleep(0.001)
    process.send_signal(signal.SIGKILL)
    process.wait(10)


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sources")
    (folder / "d.toml").write_text(diagram_file())
    (folder / "s.toml").write_text(STUDY)
    written(as_recorded(), folder / "rod")
    return folder


def arguments_of(command, sources, out):
    if command == "diagnose":
        files = {"json": "a.json", "figure": "a.png", "report": "a.html"}
        return ["diagnose", sources / "rod", *(f"--{k}={out / v}" for k, v in files.items())]
    if command == "passivity":
        answer = ROOT / "docs" / "examples" / "diagnosed_joint.json"
        return ["passivity", answer, "--json", out / "a.json"]
    return ["study", sources / "s.toml", "--workers", "1", "--out", out / "a.nc"]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("command", ["diagnose", "passivity", "study"])
def test_a_killed_command_leaves_whole_files(command, sources, tmp_path):
    chance = random.Random(command)
    moments = [chance.uniform(0, 0.01) for _ in range(4)]  # while it writes
    moments += [-chance.uniform(1, 4) for _ in range(3)]  # any time
    for number, moment in enumerate(moments):
        out = tmp_path / str(number)
        out.mkdir()
        names = {"diagnose": ("a.json", "a.png", "a.html"), "study": ("a.nc",)}
        for name in names.get(command, ("a.json",)):
            (out / name).write_bytes(OLD)
        process = start(arguments_of(command, sources, out))
        kill_at(process, moment, out)
        visible = [p for p in out.iterdir() if not p.name.startswith(".") and p.suffix != ".part"]
        assert len(visible) >= 1
        assert all(is_whole(p) for p in visible), (moment, [p.name for p in visible])
