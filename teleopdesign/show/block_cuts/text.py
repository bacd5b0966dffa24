"""A comparison of a whole diagram in a terminal: the ladder by cuts, what is missing, untested."""

from __future__ import annotations

from html import escape
from pathlib import Path

from ...base.files import write_text
from ...base.sentences import with_standard_error
from ...block_cuts.cuts_ladder import Key
from ...block_cuts.diagnosis import BlockDiagnosis
from ...diagnose.criteria import CRITERIA
from ..figures.style import as_svg
from ..registry import shows


@shows("text")
def block_diagnosis_text(diagnosis: BlockDiagnosis) -> str:
    """The ladder with a column a cut, values of added effects, verdict, and what is untested."""
    cuts = [c for c in diagnosis.cuts.tested if c.name in diagnosis.floors]
    lines = [_line("check error of each cut", [c.name for c in cuts], "all")]
    for row in diagnosis.rows:
        errors = [f"{100 * row.check[c.name]:.3g}%" for c in cuts]
        label = f"+ {_words(row.added)}" if row.added else "(your diagram, bodies re-estimated)"
        lines.append(_line(label, errors, f"{100 * row.check_error:.3g}%"))
        if row.added is not None:
            lines += [f"      {text}" for text in _parameters(diagnosis, row.added)]
            body = diagnosis.bodies.get(row.added[1])
            for open_value in () if body is None else body.undetermined:
                if open_value.candidate.key == row.added:
                    lines.append(f"      not determined: {open_value.sentence}")
    floors = [f"{100 * diagnosis.floors[c.name]:.3g}%" for c in cuts]
    lines.append(_line("noise floor", floors, ""))
    lines += ["", *map(str, diagnosis.cuts.tested)]
    lines += [f"untested: {block}: {why}" for block, why in diagnosis.cuts.untested.items()]
    for name, value in diagnosis.experiment.assumed.items():
        lines.append(f"assumed: {name} = {value}")
    for group in diagnosis.groups:
        lines.append(f"explain the records equally well: {', '.join(map(_words, group))}")
        lines += [f"    {text}" for text in _how_to_tell(diagnosis, group)]
    return "\n".join([*lines, "", _verdict(diagnosis)])


def _line(label: str, cells: list[str], last: str) -> str:
    return f"{label:<38}" + "".join(f"{cell:>10}" for cell in (*cells, last)).rstrip()


def _words(key: Key) -> str:
    return f"{key[0]} at {key[1]}"


def _how_to_tell(diagnosis: BlockDiagnosis, group: tuple[Key, ...]) -> list[str]:
    """Which further signals would separate the members of a group."""
    places = {at for _, at in group}
    if len(places) < 2:
        return []
    signals = [s for c in diagnosis.cuts.tested if places & set(c.blocks) for s in c.separating]
    return [f"to tell them apart: record {', '.join(dict.fromkeys(signals))}"] if signals else []


def _parameters(diagnosis: BlockDiagnosis, key: Key) -> list[str]:
    """Values of an added effect in the final models."""
    name, at = key
    if at in diagnosis.bodies:
        model = diagnosis.bodies[at].model
        rows = [
            (n.rpartition(".")[2], v.value, v.stderr, model.unit(n))
            for n, v in model.parameters.items()
            if n.startswith(f"{at}.{name}.")
        ]
    else:
        rows = [
            (p.effect.parameter, p.value, e, diagnosis.experiment.unit(p.effect, p.at))
            for p, e in diagnosis.placed
            if p.key == key
        ]
    return [f"{n} = {with_standard_error(v, e)} {u}".removesuffix(" 1") for n, v, e, u in rows]


def _verdict(diagnosis: BlockDiagnosis) -> str:
    if diagnosis.verdict == "effects_missing":
        return f"verdict: effects_missing: {', '.join(map(_words, diagnosis.missing))}."
    tested = ", ".join(dict.fromkeys(b for c in diagnosis.cuts.tested for b in c.blocks))
    if diagnosis.verdict == "model_adequate":
        return f"verdict: model_adequate. What is left of {tested} is noise."
    loud = [name for name, left in diagnosis.left.items() if left > CRITERIA.adequate]
    if diagnosis.groups and not loud:
        return "verdict: undecided. One effect of a group above is missing; no signal tells which."
    open_cuts = loud or [n for n, fine in diagnosis.adequate.items() if not fine]
    return f"verdict: undecided. More than noise is left at {', '.join(open_cuts)}."


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
    sections = [as_svg(diagnosis.plot()), f"<pre>{escape(repr(diagnosis))}</pre>"]
    if diagnosis.data is not None:
        sections += ["<h2>The computer</h2>", "<p>Grey: the stated laws; blue: at the end.</p>"]
        sections.append(as_svg(diagnosis.plot_residuals()))
    for name, body in diagnosis.bodies.items():
        sections += [f"<h2>{escape(name)}</h2>", as_svg(body.plot())]
        sections.append(f"<pre>{escape(repr(body))}</pre>")
    title = escape(diagnosis.experiment.title)
    write_text(path, _PAGE.format(title=title, sections="\n".join(sections)))
