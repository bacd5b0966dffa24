"""A report of a whole diagram: one page with the picture, the ladder, and what is left."""

from __future__ import annotations

from html import escape
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

from ...base.files import write_text
from ...block_cuts.diagnosis import BlockDiagnosis

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<style>body {{ font-family: serif; max-width: 60em; margin: 2em auto; }}
svg {{ max-width: 100%; height: auto; }} pre {{ white-space: pre-wrap; }}</style></head>
<body><h1>{title}</h1>
{sections}
</body></html>
"""


def write_block_report(diagnosis: BlockDiagnosis, path: str | Path) -> None:
    """Write the page: the diagram in colours, the text, and the residuals before and after."""
    sections = [_as_svg(diagnosis.plot()), f"<pre>{escape(repr(diagnosis))}</pre>"]
    if diagnosis.data is not None:
        sections += ["<h2>The computer</h2>", "<p>Grey: the stated laws; blue: at the end.</p>"]
        sections.append(_as_svg(diagnosis.plot_residuals()))
    for name, body in diagnosis.bodies.items():
        sections += [f"<h2>{escape(name)}</h2>", _as_svg(body.plot())]
        sections.append(f"<pre>{escape(repr(body))}</pre>")
    title = escape(diagnosis.experiment.title)
    write_text(path, _PAGE.format(title=title, sections="\n".join(sections)))


def _as_svg(figure: Figure) -> str:
    """A figure as SVG inside a page."""
    import matplotlib.pyplot as plt

    out = StringIO()
    figure.savefig(out, format="svg")
    plt.close(figure)
    return out.getvalue()[out.getvalue().index("<svg") :]
