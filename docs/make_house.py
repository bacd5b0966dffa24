"""The picture of the house for docs/design.md: folders in the order in which they may import.

python docs/make_house.py
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "teleopdesign"
STYLE = PACKAGE / "show" / "figures" / "teleopdesign.mplstyle"
OUTPUT = Path(__file__).parent / "_static" / "house.svg"
#: what the rooms of a layer are for, by one room of it
FLOORS = {
    "cli": "what a user types",
    "show": "shows results, computes nothing",
    "papers": "statements of the papers",
    "design": "from a model to controllers",
    "fitted_checks": "around a diagnosis",
    "diagnose": "models against records",
    "passivity": "claims of whole diagrams",
    "frequency": "responses and margins",
    "derive": "diagrams: symbols, time",
    "realise": "every form of a law",
    "check": "records without a fit",
    "model": "bodies at places",
    "diagrams": "wiring",
    "blocks": "equations",
    "effects": "physics; records",
    "arms": "links of an arm",
    "base": "words that all share",
}
COLOURS = {"effects": "#0072B2", "measurement": "#D55E00"}


def layers() -> list[list[str]]:
    """Folders of each layer, the highest first, as the import contract has them."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (contract,) = settings["tool"]["importlinter"]["contracts"]
    rows = [row.replace("|", ":").split(":") for row in contract["layers"]]
    rows = [[name.strip(" ()") for name in row] for row in rows]
    there = {p.stem for p in PACKAGE.iterdir()}
    return [[name for name in row if name in there] for row in rows]


def draw() -> plt.Figure:
    """A row of boxes for each layer; a box may use what stands below it."""
    rows = [row for row in layers() if row]
    with plt.style.context(STYLE):
        figure, axes = plt.subplots(figsize=(7.16, 0.37 * len(rows) + 0.2), layout="constrained")
        axes.set_axis_off()
        axes.set_xlim(0, 100)
        axes.set_ylim(len(rows), 0)
        for y, row in enumerate(rows):
            width = 74 / len(row)
            for x, name in enumerate(row):
                edge = COLOURS.get(name, "black")
                left = 25 + x * width
                box = plt.Rectangle((left, y + 0.1), width - 0.6, 0.8, fc="white", ec=edge, lw=0.8)
                axes.add_patch(box)
                size = 7 if width > 11 else 4.8
                middle = left + (width - 0.6) / 2
                axes.text(middle, y + 0.5, name, ha="center", va="center", fontsize=size)
            words = next((text for room, text in FLOORS.items() if room in row), "")
            axes.text(24, y + 0.5, words, ha="right", va="center", fontsize=6.5, style="italic")
    return figure


if __name__ == "__main__":
    plt.rcParams |= {"svg.hashsalt": "teleopdesign", "svg.fonttype": "none"}
    draw().savefig(OUTPUT, metadata={"Date": None})
    print(f"{OUTPUT}: {OUTPUT.stat().st_size / 1000:.0f} kB")
