"""Pages print constants of the code by their names: what moves in the code moves in the pages."""

import re
import runpy
from functools import reduce
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_every_constant_on_a_page_is_there(page):
    for name in re.findall(r"@\{([\w.]+)\}", page.read_text(encoding="utf-8")):
        # a field with a default is named by its class, whose name begins with a capital
        *folders, last = re.split(r"\.(?=[A-Z])", name, maxsplit=1)
        module = import_module(".".join(["teleopdesign", *folders]))
        assert isinstance(reduce(getattr, last.split("."), module), (int, float)), name


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_every_file_that_an_example_reads_has_its_place_on_the_page(page):
    """A reader who types the page in an empty folder needs the files of `docs/examples`, too."""
    text = page.read_text(encoding="utf-8")
    blocks = re.findall(r"^```\{(?:session|shell)\}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    typed, missing = "".join(blocks), []
    for file in sorted((DOCS / "examples").glob("*.*")):
        word = re.escape(file.name)
        used = re.search(rf"(?<![\w./]){word}\b|^from {file.stem} import", typed, re.MULTILINE)
        if used and f"{{shown}} {file.name}" not in text and f"examples/{file.name}" not in text:
            missing.append(file.name)
    assert not missing


def test_the_picture_of_the_house_has_every_room_in_its_place():
    """`python docs/make_house.py` was forgotten when a layer was added."""
    drawing = (DOCS / "_static" / "house.svg").read_text(encoding="utf-8")
    house = runpy.run_path(str(DOCS / "make_house.py"))
    rooms = [name for row in house["layers"]() for name in row]
    words = re.findall(r"<text[^>]*>([^<]*)</text>", drawing)
    assert [w for w in words if w not in house["FLOORS"].values()] == rooms


def test_every_file_that_the_page_on_the_design_names_is_there():
    page = (DOCS / "design.md").read_text(encoding="utf-8")
    paths = re.findall(r"`([\w/]+\.py|\w+/[\w/]+)`", page)
    places = (ROOT, ROOT / "teleopdesign", *(ROOT / "teleopdesign").iterdir())
    paths = [p.removesuffix("/NAME.py") for p in paths]
    assert len(paths) > 40
    assert [p for p in paths if not any((place / p).exists() for place in places)] == []


def test_every_button_that_the_page_on_the_app_names_is_there():
    shown = "".join(p.read_text(encoding="utf-8") for p in (ROOT / "teleopdesign/app").glob("*.py"))
    page = (DOCS / "app.md").read_text(encoding="utf-8")
    labels = set(re.findall(r"(?<!\*)\*([A-Z][^*\n]+)\*(?!\*)", page))
    assert labels and [label for label in labels if label not in shown] == []
