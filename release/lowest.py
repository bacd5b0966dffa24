"""Writes lowest.txt: every dependency at the lowest version that pyproject.toml declares.

python release/lowest.py            # make lowest installs them and runs tests
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

HERE = Path(__file__).parent
OUTPUT = HERE / "lowest.txt"
#: extras that neither the package nor the tests chosen for `make lowest` need
NOT_TESTED = ("bench", "docs")
#: of the tools, only those that run tests
TOOLS = ("hypothesis", "polars", "pytest")


def bounds() -> dict[str, str]:
    """Package -> the lowest version declared, of the core and of every extra that is tested."""
    project = tomllib.loads((HERE.parent / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    wanted = list(project["dependencies"])
    for name, packages in extras.items():
        if name in NOT_TESTED:
            continue
        wanted += [p for p in packages if name != "test" or p.split(">=")[0] in TOOLS]
    split = (re.fullmatch(r"([A-Za-z0-9_.-]+)>=([0-9.]+)", p) for p in wanted)
    return {match[1]: match[2] for match in split if match is not None}


def text() -> str:
    """The constraints file."""
    lines = ["# Written by `make lowest.txt` from pyproject.toml: the lowest versions declared."]
    return "\n".join([*lines, *(f"{n}=={v}" for n, v in sorted(bounds().items()))]) + "\n"


if __name__ == "__main__":
    OUTPUT.write_text(text())
    print(OUTPUT)
