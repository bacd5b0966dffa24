"""Spoilt files that follow the branches of a reader: atheris changes what led to new branches.

    python tests/trust/guided_fuzz.py [READER ...] [--runs N] [--folder DIR]

Each reader is fuzzed in a process of its own, from a good file and the corpus. A file that ends in
anything but one line, or that takes more than 10 s or 2 GB, is kept in DIR. Needs the extra `fuzz`.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
#: seconds, and MB with the libraries that are loaded
SECONDS, MEMORY = 10, 2048
LONGEST = 20_000  # bytes: the good files have fewer, but for records
#: folders of the package that read files: only in these are branches followed
READ = ("measurement", "diagrams", "studies", "arms", "effects", "passivity", "diagnose/answers")


def modules_to_leave() -> list[str]:
    """Modules of the other folders, and those with functions that numba compiles."""
    package = TESTS.parent / "teleopdesign"
    left = []
    for path in sorted(package.rglob("*.py")):
        place = path.relative_to(package)
        compiled = "compile_and_keep" in path.read_text(encoding="utf-8")
        if compiled or not place.as_posix().startswith(READ):
            parts = place.with_suffix("").parts
            left.append(".".join(("teleopdesign", *(p for p in parts if p != "__init__"))))
    return left


def fuzz(reader: str, runs: int, seeds: Path, kept: Path) -> None:
    """Fuzz one reader; ends this process, with a status other than 0 where a file fails."""
    import atheris

    sys.path.insert(0, str(TESTS))
    with atheris.instrument_imports(include=["teleopdesign"], exclude=modules_to_leave()):
        from trust.fuzzing import CORPUS, READERS, TOKENS, read_spoilt

    seeds.joinpath("good").write_bytes(READERS[reader][0])
    for path in CORPUS.glob(f"{reader}/*"):
        if path.name != "library_without_end":
            seeds.joinpath(path.name).write_bytes(path.read_bytes())
    words = ("".join(f"\\x{byte:02x}" for byte in token) for token in TOKENS if len(token) < 60)
    dictionary = seeds.parent / "words"
    dictionary.write_text("".join(f'"{word}"\n' for word in words))
    options = {
        "runs": runs,
        "timeout": SECONDS,
        "rss_limit_mb": MEMORY,
        "max_len": max(LONGEST, len(READERS[reader][0])),
        "dict": dictionary,
        "artifact_prefix": f"{kept}/{reader}-",
        "verbosity": 0,
    }
    arguments = [f"-{name}={value}" for name, value in options.items()]
    atheris.Setup(
        [sys.argv[0], *arguments, str(seeds)], lambda content: read_spoilt(reader, content)
    )
    atheris.Fuzz()


def failing(readers: list[str], runs: int, kept: Path) -> list[str]:
    """The readers that a file made fail, each fuzzed in a process."""
    broken = []
    for reader in readers:
        with tempfile.TemporaryDirectory() as scratch:
            seeds = Path(scratch) / "seeds"
            seeds.mkdir()
            command = [sys.executable, __file__, "--one", reader, "--runs", str(runs)]
            command += ["--seeds", str(seeds), "--folder", str(kept)]
            done = subprocess.run(command, capture_output=True, text=True, errors="replace")
        if done.returncode:
            broken.append(reader)
            print(done.stderr[-3000:], file=sys.stderr)
        print(f"{reader}: {'FAILS' if done.returncode else 'no failure'}", flush=True)
    return broken


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("readers", nargs="*", help="names; none: all")
    parser.add_argument("--runs", type=int, default=2000, help="files for each reader")
    parser.add_argument("--folder", type=Path, default=Path("build/fuzz"), help="where they go")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    parser.add_argument("--seeds", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    if find_spec("atheris") is None:
        print('atheris is not installed: pip install "teleopdesign[fuzz]"', file=sys.stderr)
        return 2
    if options.one:
        fuzz(options.one, options.runs, options.seeds, options.folder.resolve())
        return 0
    sys.path.insert(0, str(TESTS))
    from trust.fuzzing import READERS

    if unknown := [name for name in options.readers if name not in READERS]:
        print(f"unknown reader {unknown[0]}, expected one of {', '.join(READERS)}", file=sys.stderr)
        return 2
    return bool(failing(options.readers or list(READERS), options.runs, options.folder.resolve()))


if __name__ == "__main__":
    sys.exit(main())
