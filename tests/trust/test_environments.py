"""Odd places to run in: nothing can be written, a terminal knows ASCII, a reader stops early."""

import json
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

import teleopdesign
from teleopdesign.cli import main

PACKAGE = Path(teleopdesign.__file__).parent
ROD = PACKAGE / "examples" / "rod"
NOWHERE = "/proc/nothing"  # not even root can make it
posix = pytest.mark.skipif(not Path("/proc").is_dir(), reason="modes and devices of Linux")

KERNEL = """
import numpy as np
from teleopdesign.measurement import zero_phase
from teleopdesign.realise.compiled import compile_source
source = "from numba import njit\\n@njit(cache=True)\\ndef f(x):\\n    return 2 * x\\n"
f = compile_source(source, "f")
y = zero_phase.zero_phase(np.ones(50), 20.0, 1e-3)
print(f(21), round(float(y[-1]), 6), sum(f.stats.cache_hits.values()))
"""


#: imports what KERNEL needs, once; for each line that it reads, a fork runs KERNEL in another
#: environment and writes what it prints into a folder
FORKED = f"""
import json, os, sys, traceback
import numba, numpy
from teleopdesign.measurement import zero_phase
from teleopdesign.realise import compiled
for line in sys.stdin:
    env, folder = json.loads(line)
    child = os.fork()
    if child == 0:
        for stream, name in ((1, "out"), (2, "err")):
            file = os.open(f"{{folder}}/{{name}}", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(file, stream)
        os.environ.clear()
        os.environ.update(env)
        try:
            exec({KERNEL!r}, {{"__name__": "__main__"}})
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0)
    os.waitpid(child, 0)
    print("done", flush=True)
"""


def environment(**changed):
    """This process's, with changes; None: left out."""
    left_out = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "TELEOPDESIGN_CACHE")
    kept = {k: v for k, v in os.environ.items() if k not in left_out}
    kept |= {"PYTHONPATH": str(PACKAGE.parent), "MPLCONFIGDIR": "/tmp"} | changed
    return {k: v for k, v in kept.items() if v is not None}


def python(code, **options):
    env = environment(**options.pop("env", {}))
    return subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=600,
        env=env,
        **options,
    )


def command(*arguments, **options):
    env = environment(**options.pop("env", {}))
    return subprocess.run(
        [sys.executable, "-m", "teleopdesign.cli", *map(str, arguments)],
        stderr=subprocess.PIPE,
        text=True,
        errors="surrogateescape",
        timeout=600,
        env=env,
        **options,
    )


@pytest.fixture(scope="module")
def run_kernel(tmp_path_factory):
    """run_kernel(XDG_CACHE_HOME=...): what KERNEL prints there, and says on stderr.

    Each run is a process that has compiled nothing; only the imports are shared.
    """
    folder = tmp_path_factory.mktemp("forked")
    with subprocess.Popen(
        [sys.executable, "-c", FORKED],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=environment(),
    ) as process:

        def run(**changed):
            process.stdin.write(json.dumps([environment(**changed), str(folder)]) + "\n")
            process.stdin.flush()
            assert process.stdout.readline() == "done\n"
            return (folder / "out").read_text(), (folder / "err").read_text()

        yield run
        process.stdin.close()
        assert process.wait(300) == 0


UNWRITABLE = {
    "no cache folder": {"TELEOPDESIGN_CACHE": NOWHERE},
    "a file for a cache folder": {"TELEOPDESIGN_CACHE": __file__},
    "a home that is not there": {"HOME": NOWHERE},
    "no home": {"HOME": None},
    "nothing": {"HOME": NOWHERE, "TMPDIR": NOWHERE, "XDG_CACHE_HOME": NOWHERE},
}


@posix
@pytest.mark.slow
@pytest.mark.parametrize("place", UNWRITABLE)
def test_laws_are_compiled_wherever_nothing_can_be_written(place, run_kernel, tmp_path):
    changed = UNWRITABLE[place] | ({"XDG_CACHE_HOME": str(tmp_path)} if place == "no home" else {})
    out, errors = run_kernel(**changed)
    assert (out.split()[:2], errors) == (["42", "1.0"], "")


@pytest.mark.slow
@posix
def test_machine_code_is_kept_for_the_user_alone_and_used_again(tmp_path):
    place = {"XDG_CACHE_HOME": str(tmp_path)}  # two processes from their very start
    assert [python(KERNEL, env=place).stdout.split()[-1] for _ in range(2)] == ["0", "1"]
    folder = tmp_path / "teleopdesign" / "machine_code"
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


@pytest.mark.slow
@posix
@pytest.mark.parametrize("damage", ["another source", "short code"])
def test_what_is_kept_is_not_run_where_it_is_not_what_was_kept(damage, run_kernel, tmp_path):
    run_kernel(XDG_CACHE_HOME=str(tmp_path))
    folder = tmp_path / "teleopdesign" / "machine_code"
    (source,) = folder.glob("*.py")
    text = source.read_text()
    if damage == "another source":
        source.write_text("print('it ran')\n" + text)
    else:
        (file,) = (folder / "__pycache__").glob("*.nbc")
        file.write_bytes(file.read_bytes()[:20])
    for _ in range(2):
        out, errors = run_kernel(XDG_CACHE_HOME=str(tmp_path))
        assert (out.split()[:2], errors) == (["42", "1.0"], "")
    if damage == "another source":
        assert source.read_text() == text
    else:
        assert out.split()[-1] == "1", "what was damaged was made anew"


@pytest.mark.slow
@posix
@pytest.mark.parametrize("whose", ["open to others", "a link"])
def test_a_cache_folder_that_others_may_write_to_is_not_used(whose, run_kernel, tmp_path):
    folder = tmp_path / "teleopdesign" / "machine_code"
    folder.parent.mkdir()
    if whose == "a link":
        (tmp_path / "elsewhere").mkdir()
        folder.symlink_to(tmp_path / "elsewhere")
    else:
        folder.mkdir()
        folder.chmod(0o777)
    assert run_kernel(XDG_CACHE_HOME=str(tmp_path)) == ("42 1.0 0\n", "")
    assert list(folder.iterdir()) == []


# terminals


@pytest.mark.slow
def test_a_terminal_that_knows_ascii_alone_is_given_ascii(tmp_path):
    terminal = {"LANG": "C", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    file = tmp_path / "drag_\u00b5.py"
    file.write_text('"""\u00b5 \u2248 0.1"""\n')
    done = command("effects", "--effect", file, env=terminal, stdout=subprocess.PIPE)
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert "\\xb5" in done.stderr or "\\udcc2" in done.stderr


@pytest.mark.slow
@posix
def test_a_full_standard_output_is_one_line():
    with open("/dev/full", "w") as full:
        done = command("effects", stdout=full)
    assert done.returncode == 2
    assert done.stderr.startswith("teleopdesign: No space left") and done.stderr.count("\n") == 1


@pytest.mark.slow
@posix
def test_a_closed_standard_output_is_no_error():
    code = f"exec {sys.executable} -m teleopdesign.cli effects >&-"
    done = subprocess.run(["sh", "-c", code], capture_output=True, text=True, env=environment())
    assert (done.returncode, done.stderr) == (0, "")


# results that cannot be written are refused before the work

SOURCES = {"check": ROD, "describe": ROD, "design": ROD, "diagnose": ROD, "next": ROD,
           "passivity": ROD, "derive": "haptic-interface",
           "simulate": "world-haptics-2005", "study": "study.toml"}  # fmt: skip
RESULTS = [
    ("check", "--json", "a.json"),
    ("demo", "--output", "demo"),
    ("describe", "--effect-file", "a.py"),
    ("design", "--output", "design"),
    ("diagnose", "--figure", "a.png"),
    ("diagnose", "--report", "a.html"),
    ("next", "--output", "a.csv"),
    ("passivity", "--json", "a.json"),
    ("simulate", "--output", "a.csv"),
    ("study", "--out", "a.nc"),
]


@posix
@pytest.mark.parametrize(("name", "option", "file"), RESULTS)
def test_a_result_that_cannot_be_written_is_refused_before_the_work(name, option, file, capsys):
    source = [str(SOURCES[name])] if name in SOURCES else []
    source += ["--duration", "1"] if name == "simulate" else []
    assert main([name, *source, option, f"/proc/{file}"]) == 2
    out = capsys.readouterr()
    assert out.out == "" and out.err.count("\n") == 1 and f"/proc/{file}: " in out.err


def test_a_disk_without_room_is_refused_before_the_work(tmp_path):
    resource = pytest.importorskip("resource")
    file = tmp_path / "answer.json"
    file.write_text("the one before")
    done = command(
        "diagnose",
        ROD,
        "--json",
        file,
        stdout=subprocess.PIPE,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)),
        env={"PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert done.returncode == 2 and done.stdout == ""
    assert f"{file}: cannot be written: File too large" in done.stderr
    assert file.read_text() == "the one before" and list(tmp_path.iterdir()) == [file]
