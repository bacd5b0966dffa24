"""Which small changes of the package does no test notice? Draws them, runs tests on each.

    python tests/trust/mutants.py teleopdesign/effects tests/effects --number 40 --seed 1

Each mutant is one changed operator, condition or number in a copy of the package; tests run until
one fails. Those that all tests pass are printed as survivors, to be looked at one by one. Texts of
errors and of lines that raise are not changed.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
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
    found: list[Mutant] = []

    def span(node: ast.expr) -> tuple[int, int]:
        assert node.end_lineno is not None and node.end_col_offset is not None
        begin = starts[node.lineno - 1] + node.col_offset
        return begin, starts[node.end_lineno - 1] + node.end_col_offset

    def replace(node: ast.expr, text: str) -> None:
        found.append(Mutant(path, *span(node), text))

    def operator(left: ast.expr, right: ast.expr, sign: str, new: str) -> None:
        begin, end = span(left)[1], span(right)[0]
        at = content[begin:end].find(sign.encode())
        if at >= 0:
            found.append(Mutant(path, begin + at, begin + at + len(sign), new))

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
    return found


def survives(mutant: Mutant, copy: Path, tests: list[str], seconds: float) -> bool:
    """Whether all tests pass in the copy with that change; one that hangs is noticed."""
    target = copy / mutant.path.relative_to(ROOT)
    before = target.read_bytes()
    target.write_bytes(mutant.source())
    word = mutant.path.stem.strip("_")
    first = [str(p.relative_to(copy)) for t in tests for p in (copy / t).rglob(f"test*{word}*.py")]
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    try:
        ended = subprocess.run(
            [*command, *first, *tests],
            cwd=copy,
            env={**os.environ, "PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"},
            capture_output=True,
            timeout=seconds,
            check=False,
        )
        return ended.returncode == 0
    except subprocess.TimeoutExpired:
        return False
    finally:
        target.write_bytes(before)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("source", type=Path, help="folder or file of the package")
    parser.add_argument("tests", nargs="+", help="tests that should notice a change")
    parser.add_argument("--number", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=600, help="for the tests of one mutant")
    options = parser.parse_args()
    source = options.source.resolve()
    files = sorted(source.rglob("*.py")) if source.is_dir() else [source]
    every = [m for f in files for m in mutants_of(f)]
    chosen = random.Random(options.seed).sample(every, min(options.number, len(every)))
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch) / "copy"
        hidden = shutil.ignore_patterns(".*", "__pycache__", "build", "dist")
        shutil.copytree(ROOT, copy, ignore=hidden)
        survivors = 0
        for number, mutant in enumerate(chosen, start=1):
            began = time.monotonic()
            survived = survives(mutant, copy, options.tests, options.seconds)
            survivors += survived
            word = "SURVIVED" if survived else "killed"
            taken = time.monotonic() - began
            print(f"{number} {word} in {taken:.0f} s: {mutant}", flush=True)
    print(f"{len(chosen) - survivors} of {len(chosen)} killed, drawn from {len(every)}")


if __name__ == "__main__":
    main()
