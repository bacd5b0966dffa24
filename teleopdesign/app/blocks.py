"""A whole diagram on the page: which block is wrong, the candidates of each, and what is left."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.files import write_beside
from ..base.sentences import percent, with_error_on_page
from ..block_cuts import BlockDiagnosis, find_missing, load_experiment, write_answer
from ..measurement.experiment import Experiment
from .export import RESULTS
from .workbench import Workbench

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: in the list of blocks: the candidates of all
EVERY = "every block"


def open_experiment(
    folder: str | Path,
    *,
    among: Collection[str] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Workbench | BlockDiagnosis:
    """A workbench for the experiment in a folder, or the diagnosis of its whole diagram.

    among: names of the candidates of bodies
    raises ExperimentError: the experiment lacks something that the comparison needs
    """
    experiment = load_experiment(folder)
    if isinstance(experiment, Experiment):
        return Workbench.of(experiment, among=among, progress=progress)
    diagnosis = find_missing(experiment, among=among, progress=progress)
    assert isinstance(diagnosis, BlockDiagnosis)
    return diagnosis


def places(diagnosis: BlockDiagnosis) -> tuple[str, ...]:
    """Every block, then the places of its candidates in the order of the cuts."""
    return (EVERY, *dict.fromkeys(b for cut in diagnosis.cuts.tested for b in cut.blocks))


def verdict(diagnosis: BlockDiagnosis) -> str:
    """The verdict as Markdown."""
    return f"**{repr(diagnosis).splitlines()[-1]}**"


def candidate_rows(diagnosis: BlockDiagnosis, place: str = EVERY) -> list[dict[str, str]]:
    """The candidates at a block, the most probable first, as rows of a table."""
    named = {*diagnosis.missing}
    listed = {key for group in diagnosis.groups for key in group} - named
    rows = []
    for one in diagnosis.answer()["candidates"]:
        key = one["effect"], one["at"]
        if place not in (EVERY, one["at"]):
            continue
        values = [
            f"{name} = {' ± '.join(with_error_on_page(v['value'], v['stderr']))} {v['unit']}"
            for name, v in one["parameters"].items()
        ]
        rows.append(
            {
                "effect": one["effect"],
                "at": one["at"],
                "probability": f"{100 * one['probability']:.0f} %",
                "check error": percent(one["check_error"], ".3g"),
                "verdict": "missing" if key in named else "or" if key in listed else "no",
                "parameters": ", ".join(text.removesuffix(" 1") for text in values),
            }
        )
    return rows


def residual_figures(diagnosis: BlockDiagnosis) -> dict[str, Figure]:
    """What is left at the computer's cuts, and at each body, before and after."""
    made = {} if diagnosis.data is None else {"The computer": diagnosis.plot_residuals()}
    return made | {name: body.plot() for name, body in diagnosis.bodies.items()}


def write_all(
    diagnosis: BlockDiagnosis, folder: Path, say: Callable[[str], None] = lambda text: None
) -> str:
    """Write report, answer and picture below `folder`/results; returns one line with their names.

    say: receives the name of each step
    """
    from ..show.block_cuts.text import write_block_report

    target = folder / RESULTS / diagnosis.experiment.folder.name
    target.mkdir(parents=True, exist_ok=True)
    say("report, answer and picture")
    write_block_report(diagnosis, target / "report.html")
    write_answer(diagnosis, target / "answer.json")
    with write_beside(target / "blocks.svg") as part:
        diagnosis.plot().savefig(part, format="svg")
    return f"written to {target.relative_to(folder)}: report.html, answer.json, blocks.svg"
