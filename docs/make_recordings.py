"""Fill the printed parts of docs/recordings.md from real runs.

python docs/make_recordings.py [--source FOLDER]

--source: a folder of copies of the public recordings, laid out as OWNER/REPOSITORY/PATH, in place
of downloading them
"""

from __future__ import annotations

import argparse
import re
import tempfile
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

import matplotlib.pyplot as plt

import teleopdesign as td
from teleopdesign.measurement.recordings import RECORDINGS
from teleopdesign.unexplained import where_it_fails

DOCS = Path(__file__).resolve().parent
PAGE = DOCS / "recordings.md"
PICTURES = DOCS / "_static" / "recordings"
#: sentences of what the last model leaves that the page shows
SENTENCES = 4


def diagnosed(source: str | None) -> Iterator[tuple[str, td.Diagnosis | None, str]]:
    """Name, diagnosis (None where there was no answer), and why there was none."""
    with tempfile.TemporaryDirectory() as folder:
        for name in RECORDINGS:
            place = Path(folder) if source else None
            given = {"source": source} if source else {}
            experiment = td.load_experiment(td.fetch(name, place, **given))
            try:
                found = td.find_missing(experiment)
            except Exception as error:  # the others are still worth having; the row says it
                yield name, None, type(error).__name__
                continue
            print(found, flush=True)
            yield name, found, ""


def recordings(runs: Sequence[tuple[str, td.Diagnosis | None, str]]) -> str:
    lines = ["| recording | ladder: check error (%) | floor (%) | verdict |"]
    lines.append("| --- | --- | --- | --- |")
    for name, found, why in runs:
        row = _ladder(found) if found else f"| | no answer: {why}"
        lines.append(f"| `{name}` | {row} |")
    return "\n".join(lines)


def page(runs: Sequence[tuple[str, td.Diagnosis | None, str]]) -> str:
    """A section for each recording: what the diagnosis says, its figure, what is left."""
    PICTURES.mkdir(exist_ok=True)
    parts = []
    for name, found, why in runs:
        parts.append(f"### {name}\n")
        if found is None:
            parts.append(f"No answer: {why}.\n")
            continue
        picture = PICTURES / f"{name}.png"
        with plt.rc_context({"savefig.dpi": 100}):
            found.plot().savefig(picture)
        left = where_it_fails(found.after, found.prepared, found.floor)[:SENTENCES]
        said = (
            "\n".join(f"- {one.sentence}" for one in left) or "- nothing that depends on anything"
        )
        text = str(found).replace(str(found.experiment.folder), name)
        parts.append(f"```text\n{text}\n```\n")
        parts.append(f"![Forces, residuals and ladder of {name}](_static/recordings/{name}.png)\n")
        parts.append(f"What the last model leaves:\n\n{said}\n")
    return "\n".join(parts)


def _ladder(found: td.Diagnosis) -> str:
    steps = []
    for rung in found.rungs:
        if rung.added is None:
            text = "model"
        else:
            text = " or ".join(f"`{c.effect.name}`" for c in (rung.added, *rung.alternatives))
        steps.append(f"{text} {100 * rung.fit.check_error:.2f}")
    floor = f"{100 * found.floor.value:.2f}"
    return f"{' → '.join(steps)} | {floor} | {found.verdict}, {found.left:.0f} floors left"


def fill(text: str, what: str, printed: str) -> str:
    begin = f"<!-- printed by docs/make_recordings.py: {what} -->\n"
    pattern = re.escape(begin) + r".*?(?=<!-- end -->)"
    return re.sub(pattern, lambda _: f"{begin}\n{printed}\n\n", text, flags=re.S)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--source", help="folder of copies of the public recordings")
    source = parser.parse_args().source
    warnings.simplefilter("ignore")
    runs = list(diagnosed(source))
    text = PAGE.read_text(encoding="utf-8")
    for what, block in {"recordings": recordings(runs), "what is found": page(runs)}.items():
        text = fill(text, what, block)
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
