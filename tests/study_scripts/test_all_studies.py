"""`make studies`: every study runs, none changes the next, and one that fails is named."""

import subprocess
import sys

import _all

#: the runner without the libraries, which these scripts do not need
RUN = "import sys, _all; _all.IMPORTED = (); sys.exit(_all.main())"
CHANGES = """import os, sys, warnings
assert os.getcwd() != "/" and not hasattr(sys, "mark") and "/mark" not in sys.path
os.chdir("/")
sys.mark = True
sys.path.append("/mark")
warnings.simplefilter("error")
print(__name__, *sys.argv[1:])
"""


def _run(folder, *arguments):
    command = [sys.executable, "-c", RUN, "--folder", str(folder), "--jobs", "1", *arguments]
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=False,
        env={"PYTHONPATH": str(_all.__file__).rpartition("/")[0], "PATH": ""},
    )


def test_no_study_changes_the_next(tmp_path):
    for name in ("a", "b", "_shared"):
        (tmp_path / f"{name}.py").write_text(CHANGES)
    done = _run(tmp_path, "--quick", "--output", "X")
    assert done.returncode == 0, done.stdout + done.stderr
    printed = [f"== {tmp_path / name}\n__main__ --quick --output X\n" for name in ("a.py", "b.py")]
    assert done.stdout == "\n".join(printed) + "\n"


def test_a_study_that_fails_is_named_and_the_others_run(tmp_path):
    scripts = {
        "a": "raise ValueError('too stiff')",
        "b": "import sys; sys.exit(3)",
        "c": "import os; os.kill(os.getpid(), 9)",
        "d": "print('fine')",
    }
    for name, script in scripts.items():
        (tmp_path / f"{name}.py").write_text(script)
    done = _run(tmp_path)
    assert done.returncode == 1
    assert done.stderr == f"failed: {', '.join(str(tmp_path / f'{n}.py') for n in 'abc')}\n"
    assert "ValueError: too stiff" in done.stdout
    assert "fine" in done.stdout
