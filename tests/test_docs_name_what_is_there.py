"""Pages print constants of the code by their names: what moves in the code moves in the pages."""

import re
from functools import reduce
from importlib import import_module
from pathlib import Path

import pytest

PAGES = sorted((Path(__file__).parents[1] / "docs").glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_every_constant_on_a_page_is_there(page):
    for name in re.findall(r"@\{([\w.]+)\}", page.read_text(encoding="utf-8")):
        # a field with a default is named by its class, whose name begins with a capital
        *folders, last = re.split(r"\.(?=[A-Z])", name, maxsplit=1)
        module = import_module(".".join(["teleopdesign", *folders]))
        assert isinstance(reduce(getattr, last.split("."), module), (int, float)), name


def test_the_robustness_study_is_written_in_at_most_thirty_lines():
    """Diagram, both studies, claim and both figures, as a reader types them."""
    docs = Path(__file__).parent.parent / "docs"
    page = (docs / "robustness_study.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```\{session\}\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    diagram = (docs / "examples" / "swing.toml").read_text(encoding="utf-8")
    lines = [*diagram.splitlines(), *"".join(blocks).splitlines()]
    typed = [line for line in lines if line.strip() and not line.startswith((":", "#"))]
    assert 20 < len(typed) <= 30
    assert max(map(len, typed)) <= 104
