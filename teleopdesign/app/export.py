"""Files that the page writes: report, answer, figure, the compensation as a diagram, a script."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ..base.errors import TeleopDesignError
from ..base.files import write_beside, write_text
from ..diagnose import write_answer
from ..diagnose.by_simulation import simulated_if_possible
from .pages import propose_design
from .workbench import Workbench

#: name of the folder with what is written, below the page's folder
RESULTS = "results"


def script(bench: Workbench, folder: str | None = None) -> str:
    """A Python script that makes the same model: the experiment, then each added effect."""
    place = folder or bench.experiment.folder.name
    lines = [
        "import teleopdesign as td",
        "",
        f"experiment = td.load_experiment({place!r})",
        "model = td.Model.from_experiment(experiment)",
    ]
    for rung in bench.rungs:
        if rung.added is not None:
            lines.append(
                f"model = model.with_effect({rung.added.effect.name!r}, at={rung.added.at!r})"
            )
    lines += [
        "model = td.fit(model, experiment)",
        "print(model)",
        "print(td.compare(model, experiment))",
    ]
    return "\n".join(lines)


def write_all(
    bench: Workbench, folder: Path, say: Callable[[str], None] = lambda text: None
) -> str:
    """Write all files below `folder`/results; returns one line with their names.

    say: receives the name of each step
    """
    from ..show.report import write_report
    from ..unexplained import where_it_fails

    target = folder / RESULTS / bench.experiment.folder.name
    target.mkdir(parents=True, exist_ok=True)
    say("report, answer and figure")
    diagnosis = bench.diagnosis()
    left = where_it_fails(diagnosis.model, diagnosis.prepared, diagnosis.floor)
    simulation = simulated_if_possible(diagnosis)
    write_report(diagnosis, target / "report.html", unexplained=left, simulation=simulation)
    write_answer(diagnosis, target / "answer.json")
    with write_beside(target / "figure.svg") as part:
        diagnosis.plot().savefig(part, format="svg")
    write_text(target / "script.py", script(bench, str(bench.experiment.folder)) + "\n")
    names = ["report.html", "answer.json", "figure.svg", "script.py"]
    missing = []
    for body in bench.model.bodies:
        say(f"compensation for {body}")
        try:
            text = propose_design(bench, body).to_toml()
        except TeleopDesignError as error:
            missing.append(f"; no compensation for {body}: {error}")
        else:
            names.append(f"{body}_interface.toml")
            write_text(target / names[-1], text)
    return f"written to {target.relative_to(folder)}: {', '.join(names)}{''.join(missing)}"
