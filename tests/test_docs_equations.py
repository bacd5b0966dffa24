"""Equations of the docs: each can be written as MathML, so that no page needs a network."""

import importlib
import re
import sys
from pathlib import Path

import pytest

from teleopdesign import EFFECTS

pytest.importorskip("sphinx")
DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture(scope="module")
def extension():
    """An extension of the docs by name."""
    sys.path.insert(0, str(DOCS / "_extensions"))
    yield importlib.import_module
    sys.path.remove(str(DOCS / "_extensions"))


def equations(text):
    """(LaTeX, whether it stands alone) of a page."""
    text = re.sub(r"^```.*?^```$|`[^`\n]*`", "", text, flags=re.S | re.M)
    alone = re.findall(r"\$\$(.+?)\$\$", text, flags=re.S)
    within = re.findall(r"\$([^$\n]+?)\$", re.sub(r"\$\$.+?\$\$", "", text, flags=re.S))
    return [(latex, True) for latex in alone] + [(latex, False) for latex in within]


@pytest.mark.parametrize("page", sorted(p.name for p in DOCS.glob("*.md")))
def test_every_equation_of_a_page_becomes_mathml(page, extension):
    markup = extension("mathml").markup
    for latex, alone in equations((DOCS / page).read_text(encoding="utf-8")):
        assert markup(latex, as_block=alone).startswith("<math"), latex


def test_every_law_of_the_catalogue_becomes_mathml(extension):
    laws = equations(extension("catalogue").effects())
    assert len(laws) >= len(EFFECTS)
    for latex, alone in laws:
        assert extension("mathml").markup(latex, as_block=alone).startswith("<math"), latex


def test_an_index_of_an_accented_letter_stands_beside_it(extension):
    text = extension("mathml").markup(r"\hat Z_M + \sum_{i=1}^n \dot x_i", as_block=False)
    assert text.count("<msub>") == 2
    assert text.count("<munderover>") == 1  # the limits of the sum


def test_pages_load_no_script_from_elsewhere():
    assert "mathjax" not in (DOCS / "conf.py").read_text(encoding="utf-8").lower()
