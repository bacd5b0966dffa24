"""Write the report of a diagnosis: one self-contained HTML file."""

from __future__ import annotations

import hashlib
import json
import math
import re
from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ..diagnose import Diagnosis
from ..finding import Finding
from ..plain_data import write_text
from .figures import WIDE, colour_scale, graph_figure, ladder_figure, step_figure
from .page import Page, page_data, page_of
from .words import number, percent, short, typeset, unit_text, with_error

TEMPLATES = Path(__file__).with_name("templates")


@dataclass(frozen=True)
class Figures:
    """The page's pictures; scales, steps and the rest for each body, findings by (section, row)."""

    ladder: Markup
    scales: tuple[Markup, ...]
    steps: tuple[tuple[Markup, ...], ...]
    over_velocity: tuple[Markup, ...]
    excerpts: tuple[Markup, ...]
    findings: dict[tuple[str, int], Markup]


def write_report(
    diagnosis: Diagnosis,
    path: str | Path,
    *,
    soundness: Sequence[Finding] = (),
    unexplained: Sequence[Finding] = (),
    next_steps: Sequence[Finding] = (),
) -> None:
    """Write the page of a diagnosis; the same diagnosis has the same bytes.

    soundness: findings about the recording;  unexplained: about what the last model leaves
    next_steps: what to measure next; a section without findings is left out
    """
    page = page_of(diagnosis, soundness=soundness, unexplained=unexplained, next_steps=next_steps)
    html = render(page, figures_of(page), page_data(page, diagnosis))
    write_text(path, html)


def render(page: Page, figures: Figures, data: dict[str, Any]) -> str:
    """The page as HTML; every text of it is escaped."""
    return render_page("report.html.jinja", page, figures, data)


def render_page(name: str, page: object, figures: object, data: dict[str, Any]) -> str:
    """A page by the template of that name, with what is embedded in it; its texts are escaped."""
    template = _environment().get_template(name)
    script = figure_script()
    text = template.render(
        page=page,
        figures=figures,
        data=embedded_json(data),
        script=script,
        script_digest=_digest_of(script),
    )
    return text + "\n"


def figure_script() -> Markup:
    """The page's only script: it opens figures. It is the package's, no text of a file is in it."""
    return Markup((TEMPLATES / "figures.js.jinja").read_text(encoding="utf-8"))


def _digest_of(script: str) -> str:
    """What the page's policy allows to run: this text alone, whatever else got into the page."""
    digest = b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    return f"sha256-{digest}"


def embedded_json(data: dict[str, Any]) -> Markup:
    """JSON that may stand in a <script> element: no text in it can end the element."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def figures_of(page: Page) -> Figures:
    """Every picture of the page."""
    sections = {
        "cannot-tell": page.cannot_tell,
        "unexplained": page.unexplained,
        "next": page.next_steps,
        "soundness": page.soundness,
    }
    return Figures(
        ladder=ladder_figure(page.ladder, page.floor),
        scales=tuple(colour_scale(v) for v in page.views),
        steps=tuple(tuple(step_figure(v, k) for k in range(len(v.steps))) for v in page.views),
        over_velocity=tuple(
            graph_figure(
                v.over_velocity,
                _describe_figure(v.body, "mean residual over velocity"),
                width=WIDE,
            )
            for v in page.views
        ),
        excerpts=tuple(
            graph_figure(
                v.excerpt,
                _describe_figure(v.body, "measured and modelled force"),
                width=WIDE,
            )
            for v in page.views
        ),
        findings={
            (section, i): graph_figure(f.graph, f"{f.topic}: {f.sentence}")
            for section, rows in sections.items()
            for i, f in enumerate(rows)
            if f.graph is not None
        },
    )


def _describe_figure(body: str, what: str) -> str:
    return f"{body}: {what}, before and after."


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "number": number,
        "short": short,
        "with_error": with_error,
        "percent": percent,
        "unit": unit_text,
        "finite": math.isfinite,
        "share": _share,
        "named": _emphasise_names,
        "soft": _soft,
        "typeset": typeset,
    }
    return environment


def _soft(text: str) -> Markup:
    """A name, escaped, that may be broken after an underscore, a point or a slash."""
    parts = re.split(r"(?<=[_./])", text)
    return Markup("<wbr>").join(parts)


def _emphasise_names(text: str, names: Iterable[str]) -> Markup:
    """A sentence, escaped, in which whole words that are these names stand out."""
    known = set(names)
    parts = re.split(r"(\w+)", text)
    return Markup("").join(Markup("<b>{}</b>").format(p) if p in known else p for p in parts)


def _share(whole: float, part: float) -> str:
    """Part of a whole in percent, at most all of it, for the length of a bar."""
    return f"{min(max(100 * part / whole, 0.0), 100.0) if whole > 0 else 0.0:.1f}"
