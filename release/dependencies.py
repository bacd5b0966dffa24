"""What the package stands on: lowest versions, the versions of development, licences.

python release/dependencies.py lowest       # lowest.txt: every dependency at its declared bound
python release/dependencies.py lock         # lock.txt: what this environment has, for development
python release/dependencies.py licences     # docs/licences.md: the licence of each
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterable, Mapping
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

HERE = Path(__file__).parent
PROJECT = tomllib.loads((HERE.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS: Mapping[str, list[str]] = PROJECT["optional-dependencies"]
#: extras of which neither the package nor `make lowest` needs anything, or that need a GPU
_NOT_TESTED = ("bench", "cuda", "docs", "fuzz")
#: of the tools for tests, those that run them; the others read the code
_RUNNERS = ("hypothesis", "polars", "pytest")
#: tools of development, which a user of the package does not install
_TOOLS = ("bench", "docs", "fuzz", "test")
#: licences that ask something of who hands on changed or linked code
_COPYLEFT = re.compile(r"GPL|MPL|Mozilla|EUPL|EPL|CDDL|Affero", re.IGNORECASE)


def bounds() -> dict[str, str]:
    """Package -> the lowest version declared, of the core and of every extra that is tested."""
    wanted = list(PROJECT["dependencies"])
    for extra, packages in EXTRAS.items():
        if extra not in _NOT_TESTED:
            named = (Requirement(p).name for p in packages)
            wanted += [
                p
                for p, name in zip(packages, named, strict=True)
                if extra != "test" or name in _RUNNERS
            ]
    matches = (re.fullmatch(r"([A-Za-z0-9_.-]+)>=([0-9.]+)", p) for p in wanted)
    return {m[1]: m[2] for m in matches if m is not None}


def installed(requirements: Iterable[str]) -> dict[str, Distribution]:
    """The distributions that requirements need, and those that these need, by name."""
    queue = [Requirement(r) for r in requirements]
    pairs: set[tuple[str, str]] = set()
    result: dict[str, Distribution] = {}
    while queue:
        wanted = queue.pop()
        name = canonicalize_name(wanted.name)
        for extra in ("", *wanted.extras):
            if (name, extra) in pairs:
                continue
            pairs.add((name, extra))
            if name == PROJECT["name"]:
                more = EXTRAS[extra] if extra else PROJECT["dependencies"]
            else:
                try:
                    result[name] = distribution(name)
                except PackageNotFoundError:
                    if wanted.marker is not None:
                        continue  # for another machine, or another Python
                    raise SystemExit(
                        f"{name}: is not installed; run make test docs first"
                    ) from None
                more = result[name].requires or []
            for text in more:
                needed = Requirement(text)
                if needed.marker is None or needed.marker.evaluate({"extra": extra}):
                    queue.append(needed)
    return dict(sorted(result.items()))


def licence_of(package: Distribution) -> str:
    """As the distribution states it: in its metadata, else in the first lines of its licence."""
    meta = package.metadata
    if expression := meta.get("License-Expression"):
        return str(expression)
    classifiers = [
        text.rpartition(" :: ")[2]
        for text in meta.get_all("Classifier") or []
        if text.startswith("License :: ") and not text.endswith("OSI Approved")
    ]
    if classifiers:
        return " or ".join(classifiers)
    if lines := _lines(meta.get("License") or ""):
        return lines[0][:60]
    files = [f for f in package.files or [] if "licenses" in f.parts]
    lines = [line for file in files for line in _lines(file.read_text())[:2]]
    return ", ".join(lines) or "not stated in its metadata"


def _lines(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines() if line.strip()]


def lowest() -> str:
    """Constraints: each dependency at the lowest version that pyproject.toml declares."""
    head = "# Written by `make lowest` from pyproject.toml: the lowest versions declared."
    return "\n".join([head, *(f"{n}=={v}" for n, v in sorted(bounds().items()))]) + "\n"


def lock() -> str:
    """Constraints: the versions of this environment that the package and its tools need."""
    version = ".".join(map(str, sys.version_info[:2]))
    head = [
        f"# Written by `make lock` with Python {version} on {sys.platform}: versions that passed.",
        '# pip install -e ".[test,docs,fuzz]" -c release/lock.txt',
    ]
    distributions = installed([f"{PROJECT['name']}[docs,fuzz,test]"])
    return "\n".join([*head, *(f"{n}=={d.version}" for n, d in distributions.items())]) + "\n"


def licences() -> str:
    """A page of the docs."""
    core = installed([PROJECT["name"]])
    wanted = (e for e in EXTRAS if e not in (*_TOOLS, *_NOT_TESTED))
    users = installed(f"{PROJECT['name']}[{e}]" for e in wanted)
    tools = installed([f"{PROJECT['name']}[docs,fuzz,test]"])
    tables = {
        "Always installed": core,
        "With the extras that users install": {n: d for n, d in users.items() if n not in core},
        "Tools of development": {n: d for n, d in tools.items() if n not in users},
    }
    lines = [
        "# Licences",
        "",
        "The package is under the MIT licence. What it installs has the licences below, as each",
        "distribution states it in its metadata (`make licences` writes this page).",
        "",
        *_on_copyleft(tables),
        "",
        "The extra `cuda` is not listed: `numba-cuda` (BSD-2-Clause) installs parts of CUDA, which",
        "are under NVIDIA's licence.",
    ]
    for title, distributions in tables.items():
        lines += ["", f"## {title}", "", "| package | version | licence |", "| --- | --- | --- |"]
        lines += [f"| {n} | {d.version} | {licence_of(d)} |" for n, d in distributions.items()]
    return "\n".join(lines) + "\n"


def _on_copyleft(tables: Mapping[str, Mapping[str, Distribution]]) -> list[str]:
    """A line for each package whose licence asks something of who hands code on."""
    named = [
        f"- `{name}` ({title.lower()}): {licence_of(package)}"
        for title, distributions in tables.items()
        for name, package in distributions.items()
        if _COPYLEFT.search(licence_of(package))
    ]
    if not named:
        return ["None of them is under a copyleft licence."]
    return [
        "Copyleft among them; each is used as it is installed, none is changed or handed on with",
        "the package. MPL asks that changes of its files stay open; `docutils` is mostly in",
        "the public domain, its part under the GPL is a mode of an editor:",
        "",
        *named,
    ]


#: what to write -> where
OUTPUTS = {
    "lowest": (lowest, HERE / "lowest.txt"),
    "lock": (lock, HERE / "lock.txt"),
    "licences": (licences, HERE.parent / "docs" / "licences.md"),
}

if __name__ == "__main__":
    for wish in sys.argv[1:]:
        write, path = OUTPUTS[wish]
        path.write_text(write(), encoding="utf-8")
        print(path)
