"""Which column numbers the trials of a log, and the longest of them, on which physics is tried."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..column_names import WORDS, words_of
from ..record_clock import FEWEST, segments_of
from .content import Array, Survey, SurveyedColumn

#: rows of a trial, on average: what changes more often is a signal
ROWS_OF_A_TRIAL = 50


def trial_column(raw: Mapping[str, Array]) -> str | None:
    """The column that numbers trials, by its name and by whole numbers that seldom change."""
    for name, values in raw.items():
        if not set(WORDS["segment"]).intersection(words_of(name)):
            continue
        changes = int(np.count_nonzero(np.diff(values)))
        if np.all(values == np.round(values)) and 0 < changes * ROWS_OF_A_TRIAL < len(values):
            return name
    return None


def name_trials(survey: Survey, raw: Mapping[str, Array]) -> None:
    """Take the column that numbers trials as that of segments, and say where trials begin."""
    name = trial_column(raw)
    if name is None:
        return
    survey.channels["segment"] = {"column": name}
    changes = int(np.count_nonzero(np.diff(raw[name])))
    survey.notes.append(f"{name!r} numbers {changes + 1} trials: each is a segment")
    # the pause between two trials is interpolated, its label too: no two rows there are alike
    starts = [rows.start for rows in _trials(survey) if rows.stop - rows.start > 1]
    survey.trials = tuple(float(survey.time[k]) for k in starts[1:])


def longest_trial(survey: Survey) -> dict[str, SurveyedColumn]:
    """The columns in the longest trial; all rows, where it is short or the log has no trials.

    Between two trials a position may leap: of such a leap no physics tells signs or units.
    """
    longest = max(_trials(survey), key=lambda rows: rows.stop - rows.start)
    rows = longest.stop - longest.start
    if rows < FEWEST:
        return survey.columns
    return {n: replace(c, values=c.values[longest]) for n, c in survey.columns.items()}


def _trials(survey: Survey) -> tuple[slice, ...]:
    name = survey.channels.get("segment", {}).get("column")
    column = survey.columns.get(name) if name else None
    return segments_of(None if column is None else column.values, len(survey.time))
