"""How large the package is, by the figures that its bounds are about.

python golden/size.py [--json FILE] [--list]      --list: also every file behind a figure
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
NAME = "teleopdesign"
#: files that hold no text
BINARY = (".gz", ".png", ".npz", ".mat", ".ico", ".woff2")
#: numbers that are no thresholds: nothing, one, its opposite, a pair
PLAIN = (0, 1, -1, 2)
#: what a user does first with a device: its wiring and its frequency response, on numbers
BODE = """
import sys
import teleopdesign as td
body = td.Body("prismatic", {"inertia": td.Value(0.15)})
body = body.with_effect(td.EFFECTS["viscous"], {"damping": 0.4})
diagram = td.haptic_interface(body, hand=td.hand(mass=0.3, damping=2, stiffness=300))
td.bode(diagram)
print("\\n".join(sorted(m for m in sys.modules if m.partition(".")[0] == "teleopdesign")))
"""


def files_of(package: Path) -> list[Path]:
    """Files of the package that hold text: modules, templates, tables; no compiled ones."""
    every = (p for p in sorted(package.rglob("*")) if p.is_file())
    return [p for p in every if p.suffix not in BINARY and "__pycache__" not in p.parts]


def text_lines(package: Path) -> dict[str, int]:
    """Lines of text by folder of the package."""
    counts: Counter[str] = Counter()
    for path in files_of(package):
        counts[_folder(path, package)] += path.read_bytes().count(b"\n")
    return dict(counts)


def number_of_files(package: Path) -> int:
    """Files of the package that hold text."""
    return len(files_of(package))


def thresholds(package: Path) -> dict[str, dict[str, int]]:
    """Folder -> numbers in "constants", "fields" and "comparisons".

    constants: names that a module sets to a number or to numbers;  fields: the same in a class
    comparisons: numbers in comparisons other than those of PLAIN
    """
    counts: dict[str, Counter[str]] = {}
    for path in _modules(package).values():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        here = counts.setdefault(_folder(path, package), Counter())
        here["constants"] += sum(_is_set_to_numbers(node) for node in tree.body)
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                here["fields"] += sum(_is_set_to_numbers(each) for each in node.body)
            elif isinstance(node, ast.Compare):
                numbers = (n for side in (node.left, *node.comparators) for n in _numbers(side))
                here["comparisons"] += sum(n not in PLAIN for n in numbers)
    kinds = ("constants", "fields", "comparisons")
    return {f: {kind: counts[f][kind] for kind in kinds} for f in sorted(counts)}


def _is_set_to_numbers(node: ast.stmt) -> bool:
    """Is this an assignment of a number, or of a tuple or table of numbers, to a name?"""
    if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
        return False
    value = node.value
    parts = [value]
    if isinstance(value, ast.Tuple):
        parts = value.elts
    elif isinstance(value, ast.Dict):
        parts = value.values
    return bool(parts) and all(_is_number(part) for part in parts)


def _is_number(node: ast.expr) -> bool:
    """A number, its opposite, or an arithmetic expression of numbers."""
    if isinstance(node, ast.UnaryOp):
        return _is_number(node.operand)
    if isinstance(node, ast.BinOp):
        return _is_number(node.left) and _is_number(node.right)
    return isinstance(node, ast.Constant) and _is_real(node.value)


def _is_real(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _numbers(node: ast.expr) -> Iterator[float]:
    """Numbers of a side of a comparison, also within arithmetic; not arguments and indices."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield from (-n for n in _numbers(node.operand))
    elif isinstance(node, ast.BinOp):
        yield from _numbers(node.left)
        yield from _numbers(node.right)
    elif isinstance(node, ast.Constant) and _is_real(node.value):
        yield float(node.value)  # type: ignore[arg-type]


def importers(package: Path) -> dict[str, set[str]]:
    """Module -> modules of the package that import it, wherever in the file they do."""
    modules = _modules(package)
    users: dict[str, set[str]] = {name: set() for name in modules}
    for name, path in modules.items():
        base = name if path.name == "__init__.py" else name.rpartition(".")[0]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            for target in _imported(node, base, modules):
                if target != name:
                    users[target].add(name)
    return users


def single_importers(package: Path) -> dict[str, str]:
    """Module that one other imports -> this other; packages' own `__init__` are no such modules."""
    modules = _modules(package)
    return {
        name: next(iter(users))
        for name, users in sorted(importers(package).items())
        if len(users) == 1 and modules[name].name != "__init__.py"
    }


def _imported(node: ast.AST, base: str, modules: Mapping[str, Path]) -> Iterator[str]:
    """Modules of the package that a statement imports; base: package of the importing module."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names if alias.name in modules)
    elif isinstance(node, ast.ImportFrom):
        start = base.split(".")[: len(base.split(".")) - node.level + 1] if node.level else []
        origin = ".".join([*start, *([node.module] if node.module else [])])
        names = {f"{origin}.{alias.name}" for alias in node.names}
        yield from names & modules.keys()
        if origin in modules and (not names <= modules.keys()):
            yield origin


def effect_names(package: Path) -> dict[str, int]:
    """File outside effects/ -> how often it spells the name of an effect as a text."""
    names = {
        path.stem
        for path in (package / "effects").glob("*.py")
        if re.search(r"^EFFECT\b.*=", path.read_text(encoding="utf-8"), re.MULTILINE)
    }
    counts: dict[str, int] = {}
    for path in _modules(package).values():
        place = path.relative_to(package)
        if place.parts[0] == "effects":
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        texts = (n.value for n in ast.walk(tree) if isinstance(n, ast.Constant))
        count = sum(isinstance(t, str) and t.partition(".")[0] in names for t in texts)
        if count:
            counts[place.as_posix()] = count
    return counts


def modules_of_a_bode_plot(root: Path = ROOT) -> list[str]:
    """Modules of the package that a device's Bode plot loads, in a process of its own."""
    path = os.pathsep.join(filter(None, (str(root), os.environ.get("PYTHONPATH"))))
    done = subprocess.run(
        [sys.executable, "-c", BODE],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.split()


def test_lines(tests: Path) -> dict[str, int]:
    """Lines of the tests' Python, and kB of what else lies in their folder."""
    every = [p for p in tests.rglob("*") if p.is_file() and "__pycache__" not in p.parts]
    code = [p for p in every if p.suffix == ".py"]
    data = [p for p in every if p.suffix != ".py"]
    return {
        "lines": sum(p.read_bytes().count(b"\n") for p in code),
        "data_files": len(data),
        "data_kB": kilobytes(data),
    }


def kilobytes(paths: Sequence[Path]) -> int:
    """Size of some files, kB."""
    return round(sum(p.stat().st_size for p in paths) / 1000)


def _modules(package: Path) -> dict[str, Path]:
    """Dotted name -> file, of every module of the package."""
    named = {}
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package.parent).with_suffix("").parts
        named[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return named


def _folder(path: Path, package: Path) -> str:
    """First folder below the package; "." for files of the package itself."""
    parts = path.relative_to(package).parts
    return parts[0] if len(parts) > 1 else "."


def figures(root: Path = ROOT) -> dict[str, Any]:
    """Every figure, by name."""
    package = root / NAME
    lines, limits, names = text_lines(package), thresholds(package), effect_names(package)
    single, loaded = single_importers(package), modules_of_a_bode_plot(root)
    return {
        "text_lines": sum(lines.values()),
        "text_lines_by_folder": lines,
        "files": number_of_files(package),
        "thresholds": sum(sum(kinds.values()) for kinds in limits.values()),
        "thresholds_by_folder": limits,
        "files_with_one_importer": len(single),
        "one_importer": single,
        "effect_names_outside_effects": sum(names.values()),
        "files_that_name_effects": len(names),
        "effect_names_by_file": names,
        "modules_of_a_bode_plot": len(loaded),
        "modules_loaded": loaded,
        "tests": test_lines(root / "tests"),
        "docs_kB": kilobytes(list((root / "docs").glob("*.md"))),
        "changelog_kB": kilobytes([root / "CHANGELOG.md"]),
    }


def report(numbers: Mapping[str, Any], *, whole: bool = False) -> str:
    """The figures as lines of text;  whole: with every file behind them."""
    tests = numbers["tests"]
    rows = [
        ("text lines", numbers["text_lines"]),
        ("files", numbers["files"]),
        ("thresholds", numbers["thresholds"]),
        ("files with one importer", numbers["files_with_one_importer"]),
        ("names of effects outside effects/", numbers["effect_names_outside_effects"]),
        ("files that name effects", numbers["files_that_name_effects"]),
        ("modules of a Bode plot", numbers["modules_of_a_bode_plot"]),
        ("lines of tests", tests["lines"]),
        ("files of test data", tests["data_files"]),
        ("kB of test data", tests["data_kB"]),
        ("kB of docs/*.md", numbers["docs_kB"]),
        ("kB of CHANGELOG.md", numbers["changelog_kB"]),
    ]
    lines = [f"{name:<36}{number:>8}" for name, number in rows]
    lines += ["", f"{'folder':<20}{'lines':>8}{'constants':>11}{'fields':>8}{'comparisons':>13}"]
    limits = numbers["thresholds_by_folder"]
    for folder, count in sorted(numbers["text_lines_by_folder"].items(), key=lambda kv: -kv[1]):
        kinds = limits.get(folder, dict.fromkeys(("constants", "fields", "comparisons"), 0))
        lines.append(
            f"{folder:<20}{count:>8}{kinds['constants']:>11}{kinds['fields']:>8}"
            f"{kinds['comparisons']:>13}"
        )
    if whole:
        lines += ["", "files with one importer:"]
        lines += [f"  {name} <- {user}" for name, user in numbers["one_importer"].items()]
        lines += ["", "names of effects:"]
        by_count = sorted(numbers["effect_names_by_file"].items(), key=lambda kv: -kv[1])
        lines += [f"  {count:>4} {name}" for name, count in by_count]
        lines += ["", "modules of a Bode plot:", *(f"  {m}" for m in numbers["modules_loaded"])]
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the figures, and write them where a file is named."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures")
    parser.add_argument("--list", action="store_true", help="every file behind a figure")
    options = parser.parse_args(arguments)
    numbers = figures()
    print(report(numbers, whole=options.list))
    if options.json:
        options.json.write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
