"""Which planted faults does a suite notice? Each is one wrong snippet in a copy of the tree.

    python golden/faults.py                    # all faults of faults.toml, plain tests: some hours
    python golden/faults.py wall "two passes"  # those whose name holds one of these texts
    python golden/faults.py --anchors-only     # is each right snippet there, exactly once? a second
    python golden/faults.py --suite slow       # tests marked slow; golden: freeze.py and compare.py

A fault belongs to no file: its right snippet is looked for in the whole package. Where that is not
there once, the fault is to be anchored anew, and counts as not noticed. Tests that name the changed
module run first, then those of folders near it, then all others, up to the first that fails. This
test must pass without the fault; otherwise it is left out. `frozen/faults.toml` keeps which test
noticed each fault, and is written after each one. The next call begins with that test's file.

Each fault begins in a fresh copy with the machine code of the right package, or without any, where
the changed file has to do with machine code. Nothing is written outside of the scratch folder.
Exit status 1: a fault is to be anchored anew, or is not noticed any more.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "teleopdesign"
FAULTS, TABLE = ROOT / "golden" / "faults.toml", ROOT / "golden" / "frozen" / "faults.toml"
#: holds that each snippet is there: in a copy with a fault one is not
GUARD = "tests/trust/test_faults.py"
LEFT_OUT = (".git", ".venv", "__pycache__", "build", "dist", "*_cache", ".hypothesis", "*.egg-info")
SUFFIXES = {".py", ".toml", ".jinja", ".jinja2", ".j2"}
#: a file with one of these words makes machine code, or is made into it
MACHINE_CODE = re.compile(r"\b(numba|njit|jitted|compile_and_keep|compile_source)\b")
#: s of one run of tests, after which it counts as without end
LONGEST = 5400.0
ENDLESS = "no end within"


@dataclass(frozen=True)
class Fault:
    """A wrong snippet (`new`) in place of a right one (`old`); near: test folders to run first."""

    name: str
    kind: str
    part: str
    old: str
    new: str
    near: tuple[str, ...] = ()

    def places(self, texts: Mapping[Path, str]) -> list[tuple[Path, int, int]]:
        """File, first and last position of each occurrence of the right snippet."""
        words = self.old.split()
        pattern = re.compile(r"\s+".join(map(re.escape, words)))
        some = ((path, text) for path, text in texts.items() if words[0] in text)
        return [(path, *m.span()) for path, text in some for m in pattern.finditer(text)]


@dataclass(frozen=True)
class Verdict:
    """The test that notices a fault, the suite that it belongs to, and the time; or none.

    survived: suites that all passed with the fault
    """

    name: str
    by: str = ""
    suite: str = ""
    seconds: float = 0.0
    survived: tuple[str, ...] = ()

    def __str__(self) -> str:
        if self.by:
            return f"{self.suite}, {self.seconds:.0f} s: {self.by}"
        return f"SURVIVED {', '.join(self.survived)}"


def read_faults(path: Path = FAULTS) -> list[Fault]:
    """The planted faults of a file."""
    entries = tomllib.loads(path.read_text(encoding="utf-8"))["fault"]
    return [Fault(**{**entry, "near": tuple(entry.get("near", ()))}) for entry in entries]


def read_table(path: Path = TABLE) -> dict[str, Verdict]:
    """Name of a fault -> the verdict on it, as last written; empty where there is no file."""
    if not path.exists():
        return {}
    entries = tomllib.loads(path.read_text(encoding="utf-8")).get("verdict", ())
    verdicts = (Verdict(**{**e, "survived": tuple(e.get("survived", ()))}) for e in entries)
    return {one.name: one for one in verdicts}


def write_table(table: Mapping[str, Verdict], path: Path = TABLE) -> None:
    """Write the verdicts, in the order of the faults."""
    lines = ["# Which test notices each planted fault: written by faults.py.", ""]
    for fault in read_faults():
        if (one := table.get(fault.name)) is None:
            continue
        lines += ["[[verdict]]", f"name = {json.dumps(one.name)}"]
        lines += [f"{key} = {json.dumps(getattr(one, key))}" for key in ("by", "suite") if one.by]
        lines += [f"seconds = {one.seconds:.0f}.0"] if one.by else []
        lines += [f"survived = {json.dumps(one.survived)}"] if one.survived else []
        lines.append("")
    path.write_text("\n".join(lines), encoding="utf-8")


def package_texts(root: Path = ROOT) -> dict[Path, str]:
    """Path relative to the root -> text, of each file of the package."""
    files = (p for p in sorted((root / PACKAGE).rglob("*")) if p.suffix in SUFFIXES)
    return {path.relative_to(root): path.read_text(encoding="utf-8") for path in files}


def with_fault(fault: Fault, texts: Mapping[Path, str]) -> tuple[Path, str]:
    """The changed file and its text; raises LookupError: the right snippet is not there once."""
    places = fault.places(texts)
    if len(places) != 1:
        raise LookupError(f"its snippet is in the package {len(places)} times")
    ((path, begin, end),) = places
    text = texts[path][:begin] + fault.new + texts[path][end:]
    if path.suffix == ".py":
        compile(text, str(path), "exec")
    return path, text


@dataclass(frozen=True)
class Workshop:
    """A folder with the healthy tree, and the copy in which faults are planted."""

    scratch: Path
    jobs: int

    @property
    def healthy(self) -> Path:
        """The tree without a fault, with what was compiled of it."""
        return self.scratch / "healthy"

    @property
    def copy(self) -> Path:
        """The tree with one fault."""
        return self.scratch / "copy"

    def set_up(self) -> None:
        """Copy the tree; what was compiled of files that have not changed since stays."""
        hidden = shutil.ignore_patterns(*LEFT_OUT)
        shutil.copytree(ROOT, self.healthy, ignore=hidden, dirs_exist_ok=True)
        for path in [*self.healthy.rglob("*.py")]:
            if not (ROOT / path.relative_to(self.healthy)).exists():
                path.unlink()

    def fresh_copy(self, path: Path, text: str) -> None:
        """The copy, with another text of one file."""
        shutil.rmtree(self.copy, ignore_errors=True)
        shutil.copytree(self.healthy, self.copy, symlinks=True)
        self.plant(path, text)
        if MACHINE_CODE.search(text):
            for kept in (*self.copy.rglob("*.nbi"), *self.copy.rglob("*.nbc")):
                kept.unlink()
            shutil.rmtree(self.copy / ".cache", ignore_errors=True)

    def plant(self, path: Path, text: str) -> None:
        """Write one file of the copy; its time is now, so that nothing compiled of it is used."""
        (self.copy / path).write_text(text, encoding="utf-8")

    def run(self, command: Sequence[str], at: Path) -> tuple[int, str]:
        """Exit status and output; status -1: no end within `LONGEST`."""
        more = {"PYTHONPATH": str(at), "TELEOPDESIGN_CACHE": str(at / ".cache"), "CI": "1"}
        more |= {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
        more["TELEOPDESIGN_SHARED"] = os.environ.get(
            "TELEOPDESIGN_SHARED", str(ROOT.parent / "shared")
        )
        kept = {n: v for n, v in os.environ.items() if n != "PYTHONDONTWRITEBYTECODE"}
        with subprocess.Popen(
            [sys.executable, *command],
            cwd=at,
            env={**kept, **more},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        ) as process:
            try:
                output, _ = process.communicate(timeout=LONGEST)
                return process.returncode, output
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                return -1, ""

    def first_failure(
        self, tests: Sequence[str], *, slow: bool, without: Sequence[str], at: Path
    ) -> str:
        """The first test that fails; "" where all pass."""
        command = ["-m", "pytest", "-q", "-x", "--tb=no", "-rfE", "-p", "no:cacheprovider"]
        command += ["-n", str(self.jobs), "-m", "slow" if slow else "not slow"]
        for one in (GUARD, *without):
            command += ["--deselect" if "::" in one else "--ignore", one]
        status, output = self.run([*command, *tests], at)
        if status == -1:
            return f"{ENDLESS} {LONGEST:g} s"
        failures = re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", output, re.M)
        if not all("::" in test for test in failures) or not failures and status not in (0, 5):
            raise RuntimeError(f"pytest ended with status {status}:\n{output[-2000:]}")
        return failures[0] if failures else ""

    def passes(self, test: str, *, slow: bool, at: Path) -> bool:
        """Whether one test passes by itself."""
        command = ["-m", "pytest", "-q", "--tb=no", "-p", "no:cacheprovider", test]
        status, _ = self.run([*command, "-m", "slow" if slow else "not slow"], at)
        return status == 0


def stages(fault: Fault, path: Path, before: Verdict | None, root: Path) -> Iterator[list[str]]:
    """Tests to run one after another: the nearest to the changed file first, at last all."""
    if before is not None and (file := before.by.partition("::")[0]) and (root / file).is_file():
        yield [file]
    module = ".".join(path.with_suffix("").parts[-2:])
    files = sorted((root / "tests").rglob("test_*.py"))
    naming = [f for f in files if module in f.read_text(encoding="utf-8")]
    if naming:
        yield [f.relative_to(root).as_posix() for f in naming]
    near = dict.fromkeys((*fault.near, path.parts[1]))
    if folders := [f"tests/{n}" for n in near if (root / "tests" / n).is_dir()]:
        yield folders


def judge_by_tests(
    shop: Workshop, fault: Fault, before: Verdict | None, *, slow: bool, near: bool
) -> str:
    """The first test that notices a fault; "" where none does.

    slow: tests marked slow, in place of the plain ones;  near: only the tests near the changed file
    """
    texts = package_texts(shop.healthy)
    path, text = with_fault(fault, texts)
    shop.fresh_copy(path, text)
    sick: list[str] = []
    done: list[str] = []
    for tests in [*stages(fault, path, before, shop.copy), *([] if near else [["tests"]])]:
        todo = [one for one in tests if one not in done]
        while todo:
            first = shop.first_failure(todo, slow=slow, without=(*done, *sick), at=shop.copy)
            if not first or first.startswith(ENDLESS):
                if first:
                    return first
                break
            shop.plant(path, texts[path])
            if shop.passes(first, slow=slow, at=shop.copy):
                return first
            sick.append(first)
            print(f"  fails without the fault, too: {first}", flush=True)
            shop.plant(path, text)
        done += todo
    return ""


def judge_by_golden(shop: Workshop, fault: Fault) -> str:
    """What compare.py says first of the answers with a fault; "" where they are the same."""
    shop.fresh_copy(*with_fault(fault, package_texts(shop.healthy)))
    out = shop.copy / "build" / "golden"
    status, output = shop.run(["golden/freeze.py", str(out)], shop.copy)
    if status:
        return f"freeze.py: {(output.strip().splitlines() or ['no end'])[-1]}"
    status, output = shop.run(["golden/compare.py", "golden/frozen", str(out)], shop.copy)
    lines = [line for line in output.splitlines() if " -> " in line or ": only " in line]
    return f"compare.py: {lines[0]}" if status and lines else ""


def judge(
    shop: Workshop, fault: Fault, before: Verdict | None, *, suite: str, near: bool
) -> Verdict:
    """The verdict of a suite on a fault; what another suite said before is kept."""
    began = time.monotonic()
    if suite == "golden":
        by = judge_by_golden(shop, fault)
    else:
        by = judge_by_tests(shop, fault, before, slow=suite == "slow", near=near)
    words = f"{suite}, near" if near and suite != "golden" else suite
    seconds = time.monotonic() - began
    kept = () if before is None else tuple(s for s in before.survived if s != words)
    if by:
        return Verdict(fault.name, by, suite, seconds, kept)
    return Verdict(fault.name, survived=(*kept, words))


def warm(shop: Workshop) -> None:
    """Compile what the plain tests need, once for all faults."""
    print("all plain tests without a fault, once", flush=True)
    command = ["-m", "pytest", "-q", "--tb=no", "-p", "no:cacheprovider", "-n", str(shop.jobs)]
    _, output = shop.run(command, shop.healthy)
    print("\n".join(output.splitlines()[-20:]), flush=True)


def choose(faults: Sequence[Fault], names: Sequence[str]) -> list[Fault]:
    """The faults whose names hold one of these texts; all without texts."""
    return [f for f in faults if not names or any(n.lower() in f.name.lower() for n in names)]


def unanchored(faults: Sequence[Fault]) -> dict[str, str]:
    """Name of each fault whose snippet is not in the package once -> what is wrong."""
    texts, wrong = package_texts(), {}
    for fault in faults:
        try:
            with_fault(fault, texts)
        except (LookupError, SyntaxError) as problem:
            wrong[fault.name] = str(problem)
    return wrong


def run_all(faults: Sequence[Fault], options: argparse.Namespace, scratch: Path) -> int:
    """Judge each fault, write the table after each, print the counts; returns the exit status."""
    shop, table, lost = Workshop(scratch, options.jobs), read_table(), 0
    shop.set_up()
    if options.warm:
        warm(shop)
    for number, fault in enumerate(faults, start=1):
        before = table.get(fault.name)
        print(f"{number}/{len(faults)} {fault.name}", flush=True)
        try:
            one = judge(shop, fault, before, suite=options.suite, near=options.near)
        except RuntimeError as problem:  # the tests could not be run: nothing is said of the fault
            print(f"  {problem}", flush=True)
            lost += 1
            continue
        print(f"  {one}", flush=True)
        if before is not None and before.by and not one.by:
            if before.suite != options.suite or options.near:  # other tests noticed it
                one = replace(before, survived=one.survived)
            else:
                lost += 1
                print(f"  not noticed any more; before: {before}", flush=True)
        table[fault.name] = one
        write_table(table)
    verdicts = [table[f.name] for f in faults if f.name in table]
    for suite in ("plain", "slow", "golden"):
        print(f"{sum(v.suite == suite for v in verdicts)} of {len(faults)} noticed by {suite}")
    return int(lost > 0)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", help="texts in the names of faults; none: all faults")
    parser.add_argument("--anchors-only", action="store_true", help="only look for the snippets")
    parser.add_argument("--suite", choices=("plain", "slow", "golden"), default="plain")
    parser.add_argument("--near", action="store_true", help="only tests near the changed file")
    parser.add_argument("--survivors", action="store_true", help="only faults that none noticed")
    parser.add_argument("--warm", action="store_true", help="first run all plain tests once")
    parser.add_argument("--jobs", type=int, default=int(os.environ.get("JOBS", "2")))
    parser.add_argument(
        "--scratch", type=Path, help="folder that is kept; default: a temporary one"
    )
    options = parser.parse_args()
    faults = choose(read_faults(), options.names)
    if options.survivors:
        noticed = {name for name, one in read_table().items() if one.by}
        faults = [f for f in faults if f.name not in noticed]
    wrong = unanchored(faults)
    for name, why in wrong.items():
        print(f"to be anchored anew: {name}: {why}")
    print(f"{len(faults) - len(wrong)} of {len(faults)} faults are anchored")
    if options.anchors_only:
        return int(bool(wrong))
    anchored = [f for f in faults if f.name not in wrong]
    if options.scratch is not None:
        return max(run_all(anchored, options, options.scratch.resolve()), int(bool(wrong)))
    with tempfile.TemporaryDirectory() as scratch:
        return max(run_all(anchored, options, Path(scratch)), int(bool(wrong)))


if __name__ == "__main__":
    sys.exit(main())
