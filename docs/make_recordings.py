"""Fill the printed parts of docs/recordings.md from what studies/recordings.py wrote.

python docs/make_recordings.py [--result FOLDER]

--result: the study's output; its rows and pictures are copied beside the page first. Without it the
page is printed from the copies
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from PIL import Image

DOCS = Path(__file__).resolve().parent
PAGE = DOCS / "recordings.md"
COPIES = DOCS / "_static" / "recordings"
ROWS = "recordings.json"
#: what "less likely than not" means, said once on the page
UNEXPLAINED = re.compile(r"; the force that [^.]* counts as unexplained")
#: pixels, of a picture on the page: those of a study are for print
WIDEST = 1000
sys.path.insert(0, str(DOCS.parent / "studies"))

from recordings import table  # noqa: E402  the study beside: its table is the page's


def sections(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """A section for each recording: the verdict and its figure; the rows hold the whole text."""
    parts = []
    for name, row in rows.items():
        if "skipped" in row:
            continue
        verdict = row["text"].rpartition("\nverdict: ")[2].strip()
        more = UNEXPLAINED.sub("", verdict).partition(". ")[2]  # the names stand in the table
        parts.append(f"### {name}\n\n{more}\n" if more else f"### {name}\n")
        if (COPIES / f"{name}.png").is_file():
            picture = f"_static/recordings/{name}.png"
            parts.append(f"![Forces and ladder of {name}]({picture})\n")
    return "\n".join(parts)


def fill(text: str, what: str, printed: str) -> str:
    """The page with one printed part anew."""
    begin = f"<!-- printed by docs/make_recordings.py: {what} -->\n"
    pattern = re.escape(begin) + r".*?(?=<!-- end -->)"
    return re.sub(pattern, lambda _: f"{begin}\n{printed}\n\n", text, flags=re.S)


def page(text: str, rows: Mapping[str, Mapping[str, Any]]) -> str:
    """The page with all printed parts anew."""
    for what, block in {"recordings": table(rows), "what is found": sections(rows)}.items():
        text = fill(text, what, block)
    return text


def main() -> None:
    """Copy and print; see the module's docstring."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--result", type=Path, help="folder that the study wrote")
    result = parser.parse_args().result
    if result is not None:
        COPIES.mkdir(exist_ok=True)
        shutil.copy(result / ROWS, COPIES / ROWS)
        for file in result.glob("*.png"):
            with Image.open(file) as picture:
                picture.thumbnail((WIDEST, WIDEST))
                picture.save(COPIES / file.name, optimize=True)
    rows = json.loads((COPIES / ROWS).read_text(encoding="utf-8"))
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8"), rows), encoding="utf-8")


if __name__ == "__main__":
    main()
