"""Equations as MathML, which browsers draw by themselves: a page shows them without a network.

The converter is docutils' own. An equation that it cannot read is a warning: the build fails.
"""

from __future__ import annotations

import re
from html import unescape
from typing import Any
from xml.etree import ElementTree

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util.logging import getLogger

_LOG = getLogger(__name__)
#: names of characters that HTML knows and XML does not
_ENTITY = re.compile(r"&(?!(?:amp|lt|gt|quot|apos);)[A-Za-z]+;")
_SPACE = "http://www.w3.org/1998/Math/MathML"
ElementTree.register_namespace("", _SPACE)


def markup(latex: str, *, as_block: bool) -> str:
    """MathML of an equation; raises MathError where the converter does not know a command."""
    text = _ENTITY.sub(lambda e: unescape(e[0]), tex2mathml(latex.strip(), as_block=as_block))
    tree = ElementTree.fromstring(text)
    for stack in tree.iter(f"{{{_SPACE}}}munderover"):
        base, below, above = stack
        if base.get("movablelimits") is None:
            # an accented letter with an index: the converter puts the index below, as under a sum
            stack.tag = f"{{{_SPACE}}}msub"
            accented = ElementTree.Element(f"{{{_SPACE}}}mover", {"accent": "true"})
            accented.extend([base, above])
            stack[:] = [accented, below]
    return ElementTree.tostring(tree, encoding="unicode")


def _convert(node: nodes.Element, *, as_block: bool) -> str:
    try:
        return markup(node.astext(), as_block=as_block)
    except MathError as problem:
        _LOG.warning("equation %r: %s", node.astext(), problem, location=node)
        return ""


def _inline(writer: Any, node: nodes.Element) -> None:
    writer.body.append(_convert(node, as_block=False))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.Element) -> None:
    writer.body.append(f'<div class="math">\n{_convert(node, as_block=True)}\n</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
