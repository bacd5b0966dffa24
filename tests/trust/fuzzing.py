"""Good files of every kind that the package reads, what reads them, and ways to spoil them.

`make fuzz` draws many spoilt files; tests/trust/corpus holds those that once ended in a traceback.
"""

import json
import shutil
import tempfile
from functools import cache
from pathlib import Path

import h5py
import numpy as np
from hypothesis import strategies as st
from measurement.rod_example import ROD, rod_columns, rows
from passivity.small_certificates import storage
from security.diagram_file import diagram_file
from trust.fuzzed_logs import made_readers

from teleopdesign.base.errors import TeleopDesignError
from teleopdesign.cli import main
from teleopdesign.diagnose import load_answer
from teleopdesign.diagrams import read_diagram
from teleopdesign.effects import load_effect
from teleopdesign.fitted_checks import check_experiment
from teleopdesign.measurement import load_experiment
from teleopdesign.model import Model
from teleopdesign.studies import read_study_file

CORPUS = Path(__file__).parent / "corpus"
ROOT = Path(__file__).parents[2]

EFFECT = '''"""Own drag.

    F = D v
"""

from teleopdesign.effects import Effect, Parameter


def law(now, p):
    return p.drag * now.velocity


EFFECT = Effect(
    role="force",
    law=law,
    parameters={"drag": Parameter("damping", "D: force per velocity")},
    absent={"drag": 0.0},
    source="made for a test",
)
'''

#: a file of claims with one certificate, that of a spring and a damper
CLAIMS = {
    "claims": [{"statement": "a spring and a damper are passive", "certificates": [storage()]}]
}

STUDY = """\
[study]
model = "d.toml"
[axes]
"C.stiffness" = { from = 10, to = 20, points = 3 }
"M.inertia" = [0.1, 0.2]
[simulation]
duration = 0.2
motion.x = { amplitude = 0.01, frequency = 2.0 }
[measures]
force_error = {}
hand = { measure = "peak", signal = "x" }
"""


@cache
def experiment_bytes(ending):
    """Bytes of a good record of that format."""
    columns = rod_columns()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"r.{ending}"
        if ending == "csv":
            path.write_text(rows(columns))
        elif ending == "h5":
            with h5py.File(path, "w") as file:
                for name, values in columns.items():
                    file[name] = values[:600]
        else:
            import pyarrow as pa
            import pyarrow.parquet as pq

            pq.write_table(pa.table({n: np.asarray(v)[:600] for n, v in columns.items()}), path)
        return path.read_bytes()


def read_experiment(content, folder, *, ending="csv", part="record"):
    """Load an experiment of which one file is spoilt, and check what can be loaded."""
    record = f"fit.{ending}"
    toml = ROD.replace("fit.csv", record)
    (folder / "check.csv").write_bytes(experiment_bytes("csv"))
    (folder / record).write_bytes(content if part == "record" else experiment_bytes(ending))
    (folder / "experiment.toml").write_bytes(content if part == "toml" else toml.encode())
    experiment = load_experiment(folder)
    check_experiment(experiment, Model.from_experiment(experiment))


def read_file(content, folder, *, name, read):
    path = folder / name
    path.write_bytes(content)
    read(path)


def read_study(content, folder):
    (folder / "d.toml").write_text(diagram_file())
    read_file(content, folder, name="s.toml", read=read_study_file)


def read_by_command(path, *arguments):
    """A command's own reader; what it refuses is told on stderr."""
    if main([*arguments, str(path)]) not in (0, 2):
        raise AssertionError(f"{arguments}: a mistake of the package")


#: reader -> (a good file, what reads its bytes in a folder)
READERS = {
    "experiment": (ROD.encode(), lambda c, f: read_experiment(c, f, part="toml")),
    "csv": (experiment_bytes("csv"), lambda c, f: read_experiment(c, f)),
    "parquet": (experiment_bytes("parquet"), lambda c, f: read_experiment(c, f, ending="parquet")),
    "h5": (experiment_bytes("h5"), lambda c, f: read_experiment(c, f, ending="h5")),
    "answer": (
        (ROOT / "docs" / "examples" / "diagnosed_joint.json").read_bytes(),
        lambda c, f: read_file(c, f, name="a.json", read=lambda p: load_answer(p).model),
    ),
    "claims": (
        json.dumps(CLAIMS).encode(),
        lambda c, f: read_file(
            c, f, name="c.json", read=lambda p: read_by_command(p, "passivity", "--check")
        ),
    ),
    "diagram": (
        diagram_file().encode(),
        lambda c, f: read_file(c, f, name="d.toml", read=read_diagram),
    ),
    "study": (STUDY.encode(), lambda c, f: read_study(c, f)),
    "effect": (EFFECT.encode(), lambda c, f: read_file(c, f, name="own.py", read=load_effect)),
    **made_readers(),
}

#: what files are spoilt with: ends of ranges, odd texts, brackets
TOKENS = (
    *(b"nan inf -inf 1e999 -1e-999 1e308 0 -0 -1 999999999999999999999 0x10 1_0 .5 5. +".split()),
    *(b'true false null None [] {} [[]] [{}] "" \'\' "\xff" # , ; : = . " \' ( ) [ ] { }'.split()),
    *(c.encode() for c in ("\n", "\r", "\0", "\x1b[2J", "\u202e", "\ufeff", "\u2028", "é", " ")),
    b"[" * 300,
    b"9" * 5000,
    b"a." * 300,
)


@st.composite
def spoilt(draw, good):
    """The bytes of a good file after a few changes."""
    content = bytearray(good)
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, max(len(content) - 1, 0)))
        length = draw(st.sampled_from((0, 1, 2, 8, 64, 1000)))
        kind = draw(st.sampled_from(("byte", "cut", "token", "double", "end")))
        if kind == "byte" and content:
            content[at] = draw(st.integers(0, 255))
        elif kind == "cut":
            del content[at : at + length]
        elif kind == "token":
            content[at : at + min(length, 8)] = draw(st.sampled_from(TOKENS))
        elif kind == "double":
            content[at:at] = content[at : at + length]
        elif kind == "end":
            del content[at:]
    return bytes(content)


def read_spoilt(reader, content):
    """Read it: in one printable line where it is refused; any other error passes through."""
    folder = Path(tempfile.mkdtemp()) / "rod"
    folder.mkdir()
    try:
        READERS[reader][1](content, folder)
    except TeleopDesignError as error:
        if not str(error).isprintable():
            raise AssertionError(f"more than a line: {error!r}") from error
    finally:
        shutil.rmtree(folder.parent, ignore_errors=True)
