"""From a log to an experiment: the proposed channels, the user's choices, and the new folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.errors import ExperimentError
from ..check import look_at, stopping_findings
from ..measurement.description import lever_arm, motor_constant, plain_number
from ..measurement.experiment import load_experiment
from ..measurement.new_folder import FitAndCheck, check_spans, make_folder
from ..measurement.survey import Choices, Survey, spans_of, survey_log
from ..measurement.tables import open_log
from .files import resolve_inside

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: most points of a line in the preview: more are not visible
POINTS = 3000
#: entries of a form of the page, by the name of the field; empty or None: to be detected
Answers = Mapping[str, str | None]
#: quantity in the forms of the page -> its name in the survey
QUANTITIES = {
    "time": "time",
    "position": "position",
    "actuator force": "actuator_force",
    "hand force": "interaction_force",
}
#: number in the forms of the page -> its name in the survey
NUMBERS = {
    "gear ratio": "gear_ratio",
    "counts per turn": "counts_per_turn",
    "sample rate (Hz)": "sample_rate",
}


@dataclass(frozen=True)
class Preview:
    """The interpretation of a log with the user's choices.

    columns: names of the log's columns;  survey: proposed channels
    """

    name: str
    columns: tuple[str, ...]
    survey: Survey

    def table(self) -> str:
        """Channels with column, unit and the reason of each guess, as Markdown.

        Columns in no channel follow, each with its reason.
        """
        lines = ["| channel | column | unit | guessed |", "|:---|:---|:---|:---|"]
        for key, entry in self.survey.channels.items():
            why = "; ".join(w for k, w in self.survey.guesses.items() if k.split(".")[1:2] == [key])
            column = entry.get("column", entry.get("value", ""))
            lines.append(
                f"| {key} | {_cell(column)} | {_cell(entry.get('unit', ''))} | {_cell(why)} |"
            )
        for column, why in self.survey.unused.items():
            lines.append(f"| not used | {_cell(column)} | | {_cell(why)} |")
        return "\n".join(lines)

    def guessed_units(self) -> str:
        """Which units are guesses, and where to type them; "" if every unit is known."""
        guessed = [
            f"*{name}* ({_cell(entry['unit'])})"
            for name, key in QUANTITIES.items()
            if f"channels.{key}.unit" in self.survey.guesses
            and "unit" in (entry := self.survey.channels.get(key, {}))
        ]
        if not guessed:
            return ""
        names = ", ".join(guessed)
        return f"No column name states the unit of {names}: type the unit if the guess is wrong."

    def spans(self) -> FitAndCheck:
        """The proposed fit and check spans, s from the first row, within the log."""
        (begin, cut), (after, _) = spans_of(self.survey.duration, self.survey.trials)
        return (begin, cut), (after, self.survey.duration)

    def plot(self, spans: FitAndCheck | None = None) -> Figure:
        """The columns of the channels over time, with the values of the log.

        spans: drawn over them: the fit and the check record
        """
        from matplotlib.figure import Figure

        from ..show.figures.log import shade_spans

        shown = [
            (key, entry)
            for key, entry in self.survey.channels.items()
            if key not in ("time", "segment") and entry.get("column") in self.survey.columns
        ]
        figure = Figure(figsize=(8.5, 1.5 * max(1, len(shown))), layout="constrained")
        panels = figure.subplots(max(1, len(shown)), 1, sharex=True, squeeze=False)[:, 0]
        some = slice(None, None, max(1, len(self.survey.time) // POINTS))
        for axes, (key, entry) in zip(panels, shown, strict=False):
            values = self.survey.columns[entry["column"]].values
            axes.plot(self.survey.time[some], values[some], lw=0.8)
            axes.set_ylabel(f"{key.replace('_', ' ')}\n({entry.get('unit', '')})")
        if spans is not None:
            shade_spans(panels, spans)
        panels[-1].set_xlabel("time (s)")
        return figure


def columns_of(folder: Path, name: str) -> tuple[str, ...]:
    """The names of all columns of a log.

    raises ExperimentError: the log cannot be read
    """
    path = resolve_inside(folder, name)
    return tuple(open_log(path, path.name).names)


def preview(folder: Path, name: str, answers: Answers | None = None) -> Preview:
    """Interpret a log of the folder.

    answers: columns, units, axis and constants that the user states; the rest is detected
    raises ExperimentError: the log cannot be read, or holds no position or no force; an answer that
        is no number, or a unit that does not fit
    """
    path = resolve_inside(folder, name)
    log = open_log(path, path.name)
    answers = answers or {}
    choices = choices_of(answers)
    if units := units_of(answers):
        choices = _with_units(choices, units, survey_log(log, path.name, choices), path.name)
    return Preview(name, tuple(log.names), survey_log(log, path.name, choices))


def _with_units(choices: Choices, units: Mapping[str, str], survey: Survey, file: str) -> Choices:
    """Choices with the units of channels as units of columns; these columns are then fixed."""
    columns: dict[str, Any] = {}
    for key in units:
        column = survey.channels.get(key, {}).get("column")
        if column is None:
            shown = next(name for name, channel in QUANTITIES.items() if channel == key)
            raise ExperimentError(f"{file}: {shown} unit: choose the column of the {shown} as well")
        columns[key] = column
    named = {columns[key]: unit for key, unit in units.items()}
    return replace(choices, units=named, **columns)


def spans_of_sliders(fit: Sequence[float], check: Sequence[float], shown: Preview) -> FitAndCheck:
    """The spans of two sliders; raises ExperimentError: spans that overlap or are empty."""
    spans = (fit[0], fit[1]), (check[0], check[1])
    check_spans(spans, shown.survey.duration, Path(shown.name).name)
    return spans


def make_experiment(folder: Path, shown: Preview, spans: FitAndCheck | None = None) -> str:
    """Make the experiment's folder beside the log; returns its name relative to the page's folder.

    spans: of the fit and the check record; default: the proposed ones
    raises ExperimentError: the folder exists already, or cannot be written; spans that overlap
    """
    log = resolve_inside(folder, shown.name)
    stem = log.name.split(".")[0] or "experiment"
    target = resolve_inside(folder, f"{stem}_experiment")
    if target.exists():
        raise ExperimentError(f"{target.name}: is there already: rename it or the log")
    make_folder(shown.survey, [log], target, title=stem, spans=spans)
    return str(target.relative_to(folder))


def describe_made(folder: Path, name: str) -> str:
    """What to do with an experiment that was made, or why no diagnosis of it can answer."""
    recording = look_at(load_experiment(resolve_inside(folder, name)))
    reasons = " ".join(f.sentence for f in stopping_findings(recording))
    return f"{name} is created: {reasons or 'open it above'}"


def choices_of(answers: Answers) -> Choices:
    """Columns, axis and constants from a form of the page; an empty answer: to be detected.

    answers: by the names of `QUANTITIES` and `NUMBERS`, "axis", and "torque constant" and "lever
        arm" with their units
    raises ExperimentError: a constant that is no number
    """
    stated: dict[str, Any] = {key: answers.get(name) or None for name, key in QUANTITIES.items()}
    stated |= {key: _number(answers, name) for name, key in NUMBERS.items()}
    constant = (answers.get("torque constant") or "").strip()
    arm = (answers.get("lever arm") or "").strip()
    return Choices(
        axis=answers.get("axis") or None,
        torque_constant=motor_constant(constant, where="torque constant") if constant else None,
        lever_arm=lever_arm(arm, where="lever arm") if arm else None,
        **stated,
    )


def units_of(answers: Answers) -> dict[str, str]:
    """The units that a form of the page states, by channel."""
    units = {key: (answers.get(f"{name} unit") or "").strip() for name, key in QUANTITIES.items()}
    return {key: unit for key, unit in units.items() if unit}


def _number(answers: Answers, name: str) -> float | None:
    text = (answers.get(name) or "").strip()
    return plain_number(text, where=name) if text else None


def _cell(text: object) -> str:
    """A text for a cell of a Markdown table, shown letter by letter: "N*m" is no emphasis."""
    plain = " ".join(str(text).split())
    return "".join(c if c.isalnum() or c == " " or ord(c) > 127 else f"&#{ord(c)};" for c in plain)
