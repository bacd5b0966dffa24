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
