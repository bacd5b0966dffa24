"""Fill the printed parts of the README from real runs.

python docs/make_readme.py [--source FOLDER]

--source: a folder of copies of the public recordings, laid out as OWNER/REPOSITORY/PATH, in place
of downloading them
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import teleopdesign as td
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.recordings import RECORDINGS

README = Path(__file__).resolve().parents[1] / "README.md"
PACKAGE = Path(td.__file__).parent


def demo() -> str:
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "teleopdesign.cli", "demo"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    return f"```text\n{done.stdout.replace(f'{PACKAGE.parent}/', '').strip()}\n```"


def effects() -> str:
    roles: dict[str, list[str]] = {}
    for name, effect in EFFECTS.items():
        roles.setdefault(effect.role.replace("_", " "), []).append(f"`{name}`")
    rows = [f"| {role} | {', '.join(names)} |" for role, names in roles.items()]
    return "\n".join(["| role | effects |", "| --- | --- |", *rows])


def recordings(source: str | None) -> str:
    lines = ["| recording | ladder: check error (%) | floor (%) | verdict | time (s) |"]
    lines.append("| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for name in RECORDINGS:
            place = Path(folder) if source else None
            given = {"source": source} if source else {}
            experiment = td.load_experiment(td.fetch(name, place, **given))
            start = time.perf_counter()
            try:
                found = td.find_missing(experiment)
            except Exception as error:  # the others are still worth having; the row says it
                lines.append(f"| `{name}` | | | no answer: {type(error).__name__} | |")
                continue
            print(found, flush=True)
            lines.append(f"| `{name}` | {_ladder(found)} | {time.perf_counter() - start:.0f} |")
    return "\n".join(lines)


def _ladder(found: td.Diagnosis) -> str:
    steps = []
    for rung in found.rungs:
        if rung.added is None:
            text = "model"
        else:
            text = " or ".join(f"`{c.effect.name}`" for c in (rung.added, *rung.equals))
        steps.append(f"{text} {100 * rung.fit.check_error:.2f}")
    floor = f"{100 * found.floor.value:.2f}"
    return f"{' → '.join(steps)} | {floor} | {found.verdict}, {found.left:.0f} floors left"


def fill(text: str, what: str, printed: str) -> str:
    begin = f"<!-- printed by docs/make_readme.py: {what} -->\n"
    pattern = re.escape(begin) + r".*?(?=<!-- end -->)"
    return re.sub(pattern, lambda _: f"{begin}\n{printed}\n\n", text, flags=re.S)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--source", help="folder of copies of the public recordings")
    source = parser.parse_args().source
    warnings.simplefilter("ignore")
    text = README.read_text(encoding="utf-8")
    for what, printed in (
        ("demo", demo),
        ("effects", effects),
        ("recordings", lambda: recordings(source)),
    ):
        text = fill(text, what, printed())
        README.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
