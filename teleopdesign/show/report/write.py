"""Write the report of a diagnosis: one self-contained HTML file."""

from __future__ import annotations

import hashlib
import json
import math
import re
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ...base.files import write_text
from ...base.finding import Finding
from ...base.sentences import number_on_page as number
from ...base.sentences import percent_on_page as percent
from ...base.sentences import short_on_page as short
from ...base.sentences import typeset
from ...base.sentences import unit_on_page as unit_text
from ...base.sentences import with_error_on_page as with_error
from ...diagnose import Diagnosis, SimulationComparison
from .candidate_table import COLUMNS
from .figures import WIDE, colour_scale, graph_figure, impedance_figure, ladder_figure, step_figure
from .page import Page, Unexplained, page_data, page_of

TEMPLATES = Path(__file__).with_name("templates")


#: the pictures of a page by the names that its template calls
FIGURES: Mapping[str, Callable[..., Markup]] = {
    "ladder": ladder_figure,
    "scale": colour_scale,
    "step": step_figure,
    "graph": graph_figure,
    "wide": partial(graph_figure, width=WIDE),
    "impedance": impedance_figure,
}


def write_report(
    diagnosis: Diagnosis,
    path: str | Path,
    *,
    soundness: Sequence[Finding] = (),
    unexplained: Unexplained = (),
    next_steps: Sequence[Finding] = (),
    simulation: SimulationComparison | None = None,
) -> None:
    """Write the page of a diagnosis; the same diagnosis gives the same bytes.

    soundness: findings on the recording;  unexplained: findings on the last residual, of an arm
        those of each joint
    next_steps: findings on what to measure next; a section without findings is left out
    simulation: of the final model, driven by the recorded forces; None: that section is left out
    """
    page = page_of(
        diagnosis,
        soundness=soundness,
        unexplained=unexplained,
        next_steps=next_steps,
        simulation=simulation,
    )
    write_text(path, render(page, page_data(page, diagnosis)))


def render(
    page: Page, data: dict[str, Any], figures: Mapping[str, Callable[..., Markup]] = FIGURES
) -> str:
    """The page as HTML with embedded data, all its texts escaped; figures: those of `FIGURES`."""
    template = _environment().get_template("report.html.jinja")
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
    """The only script of the page, which opens figures; it contains no text from a file."""
    return Markup((TEMPLATES / "figures.js.jinja").read_text(encoding="utf-8"))


def _digest_of(script: str) -> str:
    """Digest of the only script that the policy of the page allows to run."""
    digest = b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    return f"sha256-{digest}"


def embedded_json(data: dict[str, Any]) -> Markup:
    """JSON for a <script> element, in which no text can end the element."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["columns"] = COLUMNS
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
    """A name, escaped, with possible line breaks after underscores, points and slashes."""
    parts = re.split(r"(?<=[_./])", text)
    return Markup("<wbr>").join(parts)


def _emphasise_names(text: str, names: Iterable[str]) -> Markup:
    """A sentence, escaped, with the whole words among `names` in bold."""
    known = set(names)
    parts = re.split(r"(\w+)", text)
    return Markup("").join(Markup("<b>{}</b>").format(p) if p in known else p for p in parts)


def _share(whole: float, part: float) -> str:
    """Part of a whole in percent, 0 to 100, as the length of a bar."""
    return f"{min(max(100 * part / whole, 0.0), 100.0) if whole > 0 else 0.0:.1f}"
