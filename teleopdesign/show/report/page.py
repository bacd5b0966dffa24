"""The report of a diagnosis: the content of its page, and one self-contained HTML file."""

from __future__ import annotations

import hashlib
import json
import math
import re
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ...base.files import make_plain, write_text
from ...base.finding import Finding, Series
from ...base.sentences import number_on_page as number
from ...base.sentences import percent_on_page as percent
from ...base.sentences import short_on_page as short
from ...base.sentences import typeset
from ...base.sentences import unit_on_page as unit_text
from ...base.sentences import with_error_on_page as with_error
from ...diagnose import Diagnosis, SimulationComparison
from ...diagnose.answer import answer
from ...studies.fingerprint import versions
from ..diagnose.verdict import sentence
from ..figures.graph import thin_series
from .candidate_table import (
    COLUMNS,
    PageRow,
    candidate_rows,
    candidate_steps,
    describe_judgement,
    ladder_lines,
    sentence_of,
    verdict,
)
from .cannot_tell import cannot_tell
from .figures import WIDE, colour_scale, graph_figure, impedance_figure, ladder_figure, step_figure
from .motion import impedance_views, simulated_motions
from .residuals import body_views
from .tables import added_effects, channel_rows, correlation_rows, parameter_rows, record_rows

#: most points of one series of a finding's graph, drawn and in the page's data
POINTS = 400
#: significant digits of arrays in the page's data: finer than any figure shows
DIGITS = 5


#: findings on what is left; of an arm, joint -> such findings
Unexplained = Sequence[Finding] | Mapping[str, Sequence[Finding]]


def page_of(
    diagnosis: Diagnosis,
    *,
    soundness: Sequence[Finding] = (),
    unexplained: Unexplained = (),
    next_steps: Sequence[Finding] = (),
    simulation: SimulationComparison | None = None,
) -> PageRow:
    """The content of the page of a diagnosis, from top to bottom, as plain numbers and texts.

    Of an arm, what is said of a body stands in the pages of its joints.
    joints: name, errors with all joints estimated together, verdict on the joint, and its own page
    links: base parameters of an arm's links, SI; stderr: None if it is not determined

    soundness: findings on the recording;  unexplained: findings on the last residual
    next_steps: findings on what to measure next; a section without findings is left out
    simulation: of the final model, driven by the recorded forces
    """
    experiment, ladder = diagnosis.experiment, ladder_lines(diagnosis)
    left = unexplained if isinstance(unexplained, Mapping) else {"": unexplained}
    body = None if diagnosis.joints else diagnosis  # of one arm each joint is a body
    rows = () if body is None else parameter_rows(body)
    return {
        "title": experiment.title,
        "folder": experiment.folder.name,
        "verdict": verdict(diagnosis),
        "named": tuple(
            sorted({r.added.effect.name for r in diagnosis.rungs if r.added is not None})
        ),
        "judged_on": describe_judgement(experiment),
        "shown": "check records" if experiment.check_records else "fit records",
        "before": diagnosis.before.check_error,
        "after": diagnosis.after.check_error,
        "floor": diagnosis.floor.value,
        "floor_source": diagnosis.floor.source,
        "left": diagnosis.left,
        "learnable": sentence_of(diagnosis.learnable),
        "near_reversals": sentence_of(diagnosis.near_reversals),
        "repeats": sentence_of(diagnosis.repeats),
        "ladder": ladder,
        "joints": tuple(
            _joint(diagnosis, j, left.get(j, ()), simulation) for j in diagnosis.joints
        ),
        "links": tuple(
            {"name": name, "unit": one.unit, "value": one.value, "stderr": make_plain(one.stderr)}
            for name, one in diagnosis.links.items()
        ),
        "added": () if body is None else added_effects(body, rows),
        "views": ()
        if body is None or body.kind
        else body_views(body, tuple(line["name"] for line in ladder)),
        "parameters": rows,
        "correlations": () if body is None else correlation_rows(body.last_fit),
        "simulated": () if body is None else simulated_motions(simulation, body.model.bodies),
        "impedances": () if body is None or body.kind else impedance_views(body),
        "candidate_steps": () if body is None else candidate_steps(body),
        "candidates": () if body is None else candidate_rows(body),
        "cannot_tell": () if body is None else cannot_tell(body),
        "soundness": limit_size(soundness),
        "unexplained": limit_size(left.get("", ())),
        "next_steps": limit_size(next_steps),
        "records": record_rows(experiment),
        "reading": experiment.reading,
        "channels": channel_rows(experiment),
        "bandwidth": diagnosis.bandwidth,
        "bandwidth_stated": experiment.bandwidth == diagnosis.bandwidth,
        "version": versions()["teleopdesign"] or "(not installed)",
    }


def _joint(
    diagnosis: Diagnosis,
    joint: str,
    left: Sequence[Finding],
    simulation: SimulationComparison | None,
) -> PageRow:
    one = diagnosis.joints[joint]
    return {
        "name": joint,
        "before": diagnosis.before.joints[joint].check_error,
        "after": diagnosis.after.joints[joint].check_error,
        "floor": one.floor.value,
        "left": one.left,
        "sentence": sentence(one).removeprefix("verdict: "),
        "page": page_of(one, unexplained=left, simulation=simulation),
    }


def limit_size(findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """The findings, with few enough points in their graphs that the page stays small."""
    return tuple(
        f if f.graph is None else replace(f, graph=replace(f.graph, series=_thin(f.graph.series)))
        for f in findings
    )


def _thin(series: tuple[Series, ...]) -> tuple[Series, ...]:
    return tuple(thin_series(s, POINTS) for s in series)


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
    data = {"answer": make_plain(answer(diagnosis)), "report": make_plain(page, digits=DIGITS)}
    write_text(path, render(page, data))


def render(
    page: PageRow, data: dict[str, Any], figures: Mapping[str, Callable[..., Markup]] = FIGURES
) -> str:
    """The page as HTML with embedded data, all its texts escaped; figures: those of `FIGURES`."""
    template = _environment().get_template("report.html.jinja")
    script = figure_script()
    digest = hashlib.sha256(script.encode()).digest()  # of the only script that the policy allows
    text = template.render(
        page=page,
        figures=figures,
        data=embedded_json(data),
        script=script,
        script_digest=f"sha256-{b64encode(digest).decode('ascii')}",
    )
    return text + "\n"


def figure_script() -> Markup:
    """The only script of the page, which opens figures; it contains no text from a file."""
    return Markup((TEMPLATES / "figures.js.jinja").read_text(encoding="utf-8"))


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
