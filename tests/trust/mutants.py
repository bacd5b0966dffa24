"""Which small changes of the package does no test notice? Draws them, runs tests on each.

    python tests/trust/mutants.py teleopdesign/effects tests/effects --number 40 --seed 1

Each mutant is one changed operator, condition or number in a copy of the package. The tests run
once on the copy as it is, and say which lines each of them runs (`lines_run.py`). Then for each
mutant tests run until one fails: those that run the changed line, then those that run another line
of its file, then the rest, for `--budget` seconds of them. Mutants that all these tests pass are
printed as survivors, to be looked at one by one. Texts of errors and of lines that raise are not
changed.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT, HERE = Path(__file__).parents[2], Path(__file__).parent
#: what takes most of the time of collecting tests, and no mutant changes
LIBRARIES = ("scipy.signal", "scipy.optimize", "scipy.stats", "sympy", "numba", "pandas", "h5py")
LIBRARIES += ("matplotlib.pyplot", "pytest")
COMPARED = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}
COMPARED |= {"in": "not in", "not in": "in", "is": "is not", "is not": "is"}
COMPUTED = {"+": "-", "-": "+", "*": "/", "/": "*", "**": "*", "//": "/", "%": "*", "@": "*"}
JOINED = {"and": "or", "or": "and"}
SIGNS = {
    **dict(zip((ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq), COMPARED, strict=False)),
    **{ast.In: "in", ast.NotIn: "not in", ast.Is: "is", ast.IsNot: "is not"},
    **{ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"},
    **{ast.FloorDiv: "//", ast.Mod: "%", ast.MatMult: "@", ast.And: "and", ast.Or: "or"},
}


@dataclass(frozen=True)
class Mutant:
    """A file, the place in it (bytes), and what stands there instead."""

    path: Path
    begin: int
    end: int
    text: str

    def source(self) -> bytes:
        """The whole file with the change."""
        content = self.path.read_bytes()
        return content[: self.begin] + self.text.encode() + content[self.end :]

    def __str__(self) -> str:
        content = self.path.read_bytes()
        row = content.count(b"\n", 0, self.begin)
        new = self.source().splitlines()[row].decode().strip()
        old = content.splitlines()[row].decode().strip()
        return f"{self.path.relative_to(ROOT)}:{row + 1}: {old}  ->  {new}"


def mutants_of(path: Path) -> list[Mutant]:
    """Every change that is tried in a file."""
    content = path.read_bytes()
    starts = [0]
    for line in content.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    mutants: list[Mutant] = []

    def span(node: ast.expr) -> tuple[int, int]:
        assert node.end_lineno is not None and node.end_col_offset is not None
        begin = starts[node.lineno - 1] + node.col_offset
        return begin, starts[node.end_lineno - 1] + node.end_col_offset

    def replace(node: ast.expr, text: str) -> None:
        mutants.append(Mutant(path, *span(node), text))

    def operator(left: ast.expr, right: ast.expr, sign: str, new: str) -> None:
        begin, end = span(left)[1], span(right)[0]
        at = content[begin:end].find(sign.encode())
        if at >= 0:
            mutants.append(Mutant(path, begin + at, begin + at + len(sign), new))

    def text_of(node: ast.expr) -> str:
        begin, end = span(node)
        return content[begin:end].decode()

    def visit(node: ast.AST) -> None:
        if isinstance(node, ast.Raise | ast.Assert | ast.JoinedStr):
            return
        if isinstance(node, ast.Compare):
            for left, sign, right in zip(
                [node.left, *node.comparators], node.ops, node.comparators, strict=False
            ):
                operator(left, right, SIGNS[type(sign)], COMPARED[SIGNS[type(sign)]])
        elif isinstance(node, ast.BinOp) and type(node.op) in SIGNS:
            operator(node.left, node.right, SIGNS[type(node.op)], COMPUTED[SIGNS[type(node.op)]])
        elif isinstance(node, ast.BoolOp):
            sign = SIGNS[type(node.op)]
            for left, right in zip(node.values, node.values[1:], strict=False):
                operator(left, right, sign, JOINED[sign])
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
            replace(node, f"({text_of(node.operand)})")
        elif isinstance(node, ast.If | ast.IfExp | ast.While):
            replace(node.test, f"(not ({text_of(node.test)}))")
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            replace(node, str(not node.value))
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            replace(node, f"({text_of(node)} + 1)")
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list"):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    visit(child)

    visit(ast.parse(content))
    return mutants


@dataclass(frozen=True)
class Ran:
    """A test, the seconds that it took, and the lines that it ran, by file of the package."""

    test: str
    seconds: float
    lines: dict[str, frozenset[int]]


def run_of(copy: Path, arguments: list[str], seconds: float | None = None, **more: str) -> int:
    """Exit status of pytest in the copy; -1 where it ran longer."""
    paths = os.pathsep.join([str(copy), str(copy / "tests" / "trust")])
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments]
    # CI: property-based tests draw the same examples each time
    places = {"PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": "1", "CI": "1"}
    with subprocess.Popen(
        command,
        cwd=copy,
        env={**os.environ, **places, **more},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as process:
        try:
            return process.wait(seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return -1


def run_in_copy_of_this_process(copy: Path, arguments: list[str], seconds: float) -> int:
    """As `run_of`, where the libraries are loaded already; the package is imported there anew."""
    process = os.fork()
    if process == 0:
        status = 70
        try:
            os.setsid()
            os.chdir(copy)
            for stream in (1, 2):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
            paths = [str(copy), str(copy / "tests" / "trust")]
            os.environ |= {"PYTHONPATH": os.pathsep.join(paths), "CI": "1"}
            sys.path[:] = [*paths, *(p for p in sys.path if Path(p) not in (ROOT, HERE))]
            sys.argv, sys.dont_write_bytecode = ["pytest"], True
            import pytest

            known = ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
            status = int(pytest.main(["-q", "-p", "no:cacheprovider", *known, *arguments]))
        finally:
            os._exit(status)
    ends = time.monotonic() + seconds
    while time.monotonic() < ends:
        done, how = os.waitpid(process, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(how)
        time.sleep(0.05)
    os.killpg(process, signal.SIGKILL)
    os.waitpid(process, 0)
    return -1


def load_libraries() -> bool:
    """Load what the tests need and no mutant changes; False: this system cannot copy a process."""
    if not hasattr(os, "fork"):
        return False
    for name in LIBRARIES:
        importlib.import_module(name)
    return True


def lines_of_tests(copy: Path, source: list[Path], tests: list[str], memory: Path) -> list[Ran]:
    """What each test runs on the copy as it is; from `memory` where that file is there."""
    if not memory.exists():
        watched = ":".join(str(copy / f.relative_to(ROOT)) for f in source)
        places = {"TELEOPDESIGN_LINES_OF": watched, "TELEOPDESIGN_LINES_TO": str(memory)}
        status = run_of(copy, ["-p", "lines_run", *tests], **places)
        if status:
            sys.exit(f"the tests do not pass without a change: status {status}")
        text = memory.read_text().replace(str(copy) + os.sep, "")
        memory.write_text(text)
    return [
        Ran(r["test"], r["seconds"], {f: frozenset(n) for f, n in r["lines"].items()})
        for r in json.loads(memory.read_text())
    ]


def chosen_tests(mutant: Mutant, every: list[Ran], budget: float) -> list[str]:
    """Tests to run on a mutant, those that run the changed line first, for `budget` seconds.

    Tests of one file stay together, so that what they share is made once.
    """
    file = str(mutant.path.relative_to(ROOT))
    content = mutant.path.read_bytes()
    row = content.count(b"\n", 0, mutant.begin) + 1
    ranks: tuple[list[Ran], list[Ran], list[Ran]] = ([], [], [])
    for ran in every:
        ranks[0 if row in ran.lines.get(file, ()) else 1 if file in ran.lines else 2].append(ran)
    word = mutant.path.stem.strip("_")
    chosen: list[str] = []
    for tests in ranks:
        files: dict[str, list[Ran]] = {}
        for ran in tests:
            files.setdefault(ran.test.partition("::")[0], []).append(ran)

        def cost(name: str, files: dict[str, list[Ran]] = files) -> tuple[bool, float]:
            return word not in Path(name).stem, sum(r.seconds for r in files[name])

        for name in sorted(files, key=cost):
            for ran in files[name]:
                if ran.seconds <= budget:
                    budget -= ran.seconds
                    chosen.append(ran.test)
    return chosen


def outcome(mutant: Mutant, copy: Path, every: list[Ran], budget: float) -> str:
    """ "SURVIVED" where all chosen tests pass in the copy with that change, "hung" or "killed"."""
    target = copy / mutant.path.relative_to(ROOT)
    before = target.read_bytes()
    target.write_bytes(mutant.source())
    listed, chosen = copy / "chosen_tests.txt", chosen_tests(mutant, every, budget)
    run = run_in_copy_of_this_process if load_libraries() else run_of
    arguments, longest = ["-x", "--rootdir", str(copy), f"@{listed}"], 10 * budget + 120
    try:
        listed.write_text("\n".join(chosen))
        status = run(copy, arguments, longest)
        if status == 4:  # a change of the catalogue renames tests: their files are run
            listed.write_text("\n".join(dict.fromkeys(t.partition("::")[0] for t in chosen)))
            status = run(copy, arguments, longest)
        if status == 70:
            sys.exit("the tests could not be run in a copy of this process")
        return {0: "SURVIVED", -1: "hung"}.get(status, "killed")
    finally:
        target.write_bytes(before)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("source", help="folders and files of the package, joined by commas")
    parser.add_argument("tests", nargs="+", help="tests that should notice a change")
    parser.add_argument("--number", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--budget", type=float, default=60, help="seconds of tests for each mutant")
    parser.add_argument("--from", dest="first", type=int, default=1, help="mutant to begin at")
    parser.add_argument("--seconds", type=float, help="begin no further mutant after so long")
    parser.add_argument("--lines", type=Path, help="file that keeps which lines the tests run")
    options = parser.parse_args()
    source = [Path(s).resolve() for s in options.source.split(",")]
    files = [f for s in source for f in (sorted(s.rglob("*.py")) if s.is_dir() else [s])]
    every = [m for f in files for m in mutants_of(f)]
    chosen = random.Random(options.seed).sample(every, min(options.number, len(every)))
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch) / "copy"
        hidden = shutil.ignore_patterns(".*", "__pycache__", "build", "dist")
        shutil.copytree(ROOT, copy, ignore=hidden)
        memory = options.lines or Path(scratch) / "lines.json"
        ran = lines_of_tests(copy, source, options.tests, memory)
        survivors = 0
        number, start = options.first - 1, time.monotonic()
        for number, mutant in list(enumerate(chosen, start=1))[options.first - 1 :]:
            began = time.monotonic()
            if options.seconds is not None and began - start > options.seconds:
                print(f"go on with --from {number}")
                number -= 1
                break
            word = outcome(mutant, copy, ran, options.budget)
            survivors += word == "SURVIVED"
            duration = time.monotonic() - began
            print(f"{number} {word} in {duration:.0f} s: {mutant}", flush=True)
    count = number - options.first + 1
    print(f"{count - survivors} of {count} killed, drawn from {len(every)}")


if __name__ == "__main__":
    main()
