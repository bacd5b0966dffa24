"""Layout of the page: buttons, tables and charts in rows and columns.

Each function lays out the arguments from a cell of the notebook; the notebook defines what a button
does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle
from typing import Any

import marimo as mo

from ..base.errors import TeleopDesignError
from ..block_cuts import BlockDiagnosis
from . import blocks, charts, export, logs, pages
from .workbench import Workbench

#: what marimo shows: an element of the page
PageElement = Any
Spans = Sequence[tuple[float, float]]
#: how many numbers to leave out before the next fields of a cell, which are fewer than eight. Names
#: that come back after sixteen turns are long forgotten
_FREE_NUMBERS = cycle(range(0, 128, 8))


def place_side_by_side(*elements: PageElement) -> PageElement:
    """Elements in a row; on a narrow page in several rows."""
    return mo.hstack(list(elements), justify="start", wrap=True)


def span_sliders(duration: float, proposed: Spans) -> tuple[PageElement, PageElement]:
    """Two sliders, for the fit span and the check span, s from the first row."""
    # nine digits: what the sliders show beside them is no rounding error
    duration = float(f"{duration:.9g}")
    proposed = [(float(f"{begin:.9g}"), float(f"{end:.9g}")) for begin, end in proposed]
    fit, check = (
        mo.ui.range_slider(
            start=0.0,
            stop=duration,
            step=duration / 500,
            value=list(span),
            show_value=True,
            debounce=True,
            full_width=True,
            label=f"{use} span (s)",
        )
        for use, span in zip(("fit", "check"), proposed, strict=True)
    )
    return fit, check


def column_form(columns: Sequence[str]) -> PageElement:
    """The form for a log: columns with their units, axis, constants."""
    fields: dict[str, PageElement] = {}
    for name in logs.QUANTITIES:
        fields[name] = mo.ui.dropdown(columns, label=name)
        fields[f"{name} unit"] = mo.ui.text(label=f"{name} unit", full_width=False)
    fields["axis"] = mo.ui.dropdown(["prismatic", "revolute"], label="axis")
    fields["torque constant"] = mo.ui.text(
        label="torque constant", placeholder="0.037 N*m/A or 12 N/A"
    )
    fields["lever arm"] = mo.ui.text(label="lever arm of a force in N", placeholder="70 mm")
    fields |= {name: mo.ui.text(label=name) for name in logs.NUMBERS}
    return mo.ui.dictionary(fields)


def form_rows(form: PageElement) -> PageElement:
    """The layout of the form: each column above its unit, then axis and constants."""
    fields = form.elements
    pairs = [mo.vstack([fields[name], fields[f"{name} unit"]]) for name in logs.QUANTITIES]
    others = [fields[name] for name in ("axis", "torque constant", "lever arm", *logs.NUMBERS)]
    return mo.vstack([place_side_by_side(*pairs), place_side_by_side(*others)])


def log_parts(
    form: PageElement,
    understood: logs.Preview | None,
    trouble: str,
    sliders: tuple[PageElement, PageElement],
    make: Callable[[logs.Preview, Any], object],
) -> list[PageElement]:
    """The interpretation of a log, and the button that makes an experiment of it.

    understood: None if `trouble` states why not
    make: called by the button with the preview and its spans
    """
    parts = [
        mo.md(
            "Where a field is empty, the column is chosen by names and physics. Choose another one "
            "if that is wrong:"
        ),
        form_rows(form),
    ]
    if understood is None:
        return [*parts, mo.callout(trouble, kind="warn")]
    parts.append(mo.md(understood.table()))
    if guessed := understood.guessed_units():
        parts.append(mo.md(guessed))
    parts += [mo.md("What is fitted, and what is checked:"), *sliders]
    try:
        spans = logs.spans_of_sliders(sliders[0].value, sliders[1].value, understood)
    except TeleopDesignError as error:
        return [*parts, mo.callout(str(error), kind="warn")]
    button = mo.ui.button(
        label="Make the experiment", on_click=lambda _: make(understood, spans), kind="success"
    )
    return [*parts, understood.plot(spans), button]


def begin_anew() -> None:
    """Let the fields that a cell makes next show their first choice, whatever stood there before.

    marimo names a field by its cell and its number in it, and the browser may keep the choice that
    it has for a name. So the fields of another ladder get numbers that those before did not have:
    buttons that nobody sees take these.
    """
    for _ in range(next(_FREE_NUMBERS)):
        mo.ui.button()


def residual_view(
    bench: Workbench, body: PageElement, use: PageElement, rung: PageElement
) -> PageElement:
    """The residual of one model, with the controls that select it."""
    data = pages.residuals(bench, rung.value)
    return mo.vstack(
        [
            place_side_by_side(body, use, rung),
            charts.residual_chart(data, body.value, use.value),
            mo.md("Draw a span in one panel: the others show the same samples."),
        ]
    )


def compare_view(
    bench: Workbench, models: tuple[PageElement, PageElement], body: PageElement, use: PageElement
) -> PageElement:
    """Two models side by side."""
    one, other = models
    parts = [place_side_by_side(one, other)]
    if one.value == other.value:
        parts.append(mo.md("Choose two models of the ladder; *Add* makes another one."))
    else:
        parts += [
            mo.md(pages.compare_rungs(bench, one.value, other.value)),
            charts.comparison_chart(
                *pages.carried_residuals(bench, one.value, other.value, body.value),
                body.value,
                use.value,
                (one.selected_key, other.selected_key),
            ),
        ]
    return mo.vstack(parts)


def ladder_view(
    bench: Workbench, candidate: PageElement, buttons: Mapping[str, PageElement]
) -> PageElement:
    """The ladder and the candidates; buttons: "add", "back", "rank", "all"."""
    return mo.vstack(
        [
            mo.md(pages.ladder(bench)),
            *([mo.md(words)] if (words := pages.verdict(bench)) else ()),
            place_side_by_side(candidate, buttons["add"], buttons["back"]),
            place_side_by_side(buttons["rank"], buttons["all"]),
            mo.ui.table(pages.candidate_rows(bench), selection=None, page_size=8)
            if bench.candidates
            else mo.md(
                "The effects that could be added to this model are not fitted yet: "
                "*Look for what else is missing* fits them."
            ),
        ]
    )


def slider_view(
    bench: Workbench,
    which: PageElement,
    factor: PageElement,
    body: PageElement,
    use: PageElement,
) -> PageElement:
    """One parameter moved: the new errors, and the force of the model beside the record."""
    if not which.value:
        return mo.md("This model has no free parameter.")
    parts = [
        place_side_by_side(which, factor),
        mo.md(pages.move_parameter(bench, which.value, factor.value)),
    ]
    data = pages.moved_residuals(bench, which.value, factor.value)
    if data is not None:
        parts.append(charts.residual_chart(data, body.value, use.value))
    if table := pages.correlations(bench):
        parts.append(mo.md(table))
    return mo.vstack(parts)


def simulation_view(bench: Workbench) -> PageElement:
    """Measured and simulated motion, and the correlations of the residual."""
    shown = pages.simulated_motion(bench)
    return mo.plain_text(shown) if isinstance(shown, str) else mo.as_html(shown)


def design_view(bench: Workbench, body: str) -> PageElement:
    """The compensation for a body: predictions, claims, diagram, Bode plot, simulation."""
    return mo.ui.tabs(
        {
            title: mo.vstack(
                [
                    *([mo.md(caption)] if caption else ()),
                    mo.plain_text(part) if isinstance(part, str) else part,
                ]
            )
            for title, caption, part in pages.design_parts(bench, body)
        }
    )


def export_view(bench: Workbench, write: PageElement) -> PageElement:
    """The button that writes files, and the script that repeats the user's steps."""
    sentence = (
        "Report (html), answer (json), figure (svg), for each body the compensation as a diagram "
        "(toml), and a script that repeats these steps."
    )
    script = mo.md(f"```python\n{export.script(bench)}\n```")
    return mo.vstack([mo.md(sentence), write, mo.accordion({"The script": script})])


def block_view(diagnosis: BlockDiagnosis, block: PageElement, write: PageElement) -> PageElement:
    """A whole diagram: each block in the colour of its error, its candidates, what is left."""
    return mo.vstack(
        [
            mo.md(blocks.verdict(diagnosis)),
            diagnosis.plot(),
            block,
            mo.ui.table(blocks.candidate_rows(diagnosis, block.value), selection=None, page_size=8),
            mo.accordion({"Ladder, cuts and groups": mo.plain_text(repr(diagnosis))}),
            mo.ui.tabs(blocks.residual_figures(diagnosis)),
            write,
        ]
    )
