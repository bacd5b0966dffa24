"""What `teleopdesign new` understood of a log: every channel over time, and force over velocity."""

from __future__ import annotations

import textwrap
import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...base.files import write_beside
from ...base.units import unit_of
from ...measurement.channel import BODY_QUANTITIES
from ...measurement.experiment import Experiment
from ...measurement.first_guess import motion_columns
from ...measurement.survey import Survey
from .style import further_fonts

#: points of a line: more are not seen
_POINTS = 4000
#: colours of what is fitted and of what is checked
_SHADES = {"fit": "tab:blue", "check": "tab:orange"}
#: columns in no channel that are named below the picture; inches that a line of theirs takes
_UNUSED = 12
_LINE = 0.16
#: most letters of such a line
_LETTERS = 125
#: width of the picture, inches beside, below and above its axes (beside: a label of two lines and
#: numbers such as -0.00015), and part of their height between
_WIDTH, _MARGINS, _BETWEEN = 9.0, (1.2, 0.55, 0.15, 0.3), 0.45


def save_survey(figure: Figure, path: Path) -> None:
    """Write the figure as PNG; `explain_boxes` names the letters that no font has."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        with write_beside(path) as part:
            figure.savefig(part, format="png", pil_kwargs={"compress_level": 1})


def draw_survey(survey: Survey, experiment: Experiment) -> Figure:
    """The channels in SI units, with fit and check records shaded in different colours.

    Columns of the log that are in no channel are listed below, each with the reason.
    """
    with rc_context({"font.family": ["DejaVu Sans", *further_fonts()]}):
        return _draw_survey(survey, experiment)


def _draw_survey(survey: Survey, experiment: Experiment) -> Figure:
    keys = [k for k in experiment.channels if experiment.channels[k].body is not None]
    lines = (textwrap.wrap(line, _LETTERS) for line in unused_lines(survey.unused))
    unused = [part for line in lines for part in line]
    height = 1.7 * len(keys) + 2.6 + _LINE * len(unused)
    below = _MARGINS[1] + _LINE * len(unused)
    figure = Figure(figsize=(_WIDTH, height))
    grid = figure.add_gridspec(
        len(keys) + 1,
        1,
        height_ratios=[1.0] * len(keys) + [1.5],
        # margins in place of a constrained layout, which draws every text twice more
        left=_MARGINS[0] / _WIDTH,
        right=1.0 - _MARGINS[2] / _WIDTH,
        bottom=below / height,
        top=1.0 - _MARGINS[3] / height,
        hspace=_BETWEEN,
    )
    first = None
    for row, key in enumerate(keys):
        axes = figure.add_subplot(grid[row], sharex=first)
        first = first or axes
        channel = experiment.channels[key]
        kind = BODY_QUANTITIES[channel.quantity]
        for record in experiment.records:
            some = slice(None, None, max(1, len(record.time) // _POINTS))
            shade = _SHADES[record.use]
            axes.plot(record.time[some], record.signals[key][some], lw=0.7, color=shade)
        axes.set_ylabel(f"{channel.quantity.replace('_', ' ')}\n({unit_of(kind, survey.axis)})")
        axes.set_title(f'column "{channel.column}" in {channel.unit}', fontsize=9, loc="left")
    if first is not None:
        figure.axes[len(keys) - 1].set_xlabel("time (s); blue: fit, orange: check")
    axes = figure.add_subplot(grid[len(keys)])
    body = next(iter(experiment.bodies))
    record = experiment.fit_records[0]
    rows = max(record.segments, key=lambda s: s.stop - s.start)
    velocity, _, _ = motion_columns(record.signals[f"{body}.position"][rows], record.sample_time)
    some = slice(None, None, max(1, len(velocity) // _POINTS))
    force = record.signals[f"{body}.actuator_force"][rows]
    axes.plot(velocity[some], force[some], ".", ms=2, color="0.5")
    if survey.first is not None:
        v = np.linspace(velocity.min(), velocity.max(), 401)
        line = survey.first.level * np.sign(v) + survey.first.damping * v
        axes.plot(v, line, lw=1.5, color="tab:red", label="friction of the first guess")
        axes.legend(frameon=False, fontsize=8)
    axes.set_xlabel(f"velocity ({unit_of('velocity', survey.axis)})")
    axes.set_ylabel(f"actuator force ({unit_of('force', survey.axis)})")
    if unused:
        figure.text(0.01, 0.05 / height, "\n".join(unused), fontsize=8, parse_math=False)
    return figure


def unused_lines(unused: Mapping[str, str]) -> list[str]:
    """Lines of text on columns that are in no channel: at most `_UNUSED`, then a summary."""
    if not unused:
        return []
    lines = [f'not used: "{name}": {why}' for name, why in unused.items()]
    more = len(lines) - _UNUSED
    return lines if more <= 0 else [*lines[:_UNUSED], f"... and {more} more: see experiment.toml"]


def shade_spans(panels: Iterable[Axes], spans: Sequence[tuple[float, float]]) -> None:
    """Shade the fit span and the check span in every panel, and label them in the first panel."""
    for k, axes in enumerate(panels):
        for (use, shade), (begin, end) in zip(_SHADES.items(), spans, strict=True):
            axes.axvspan(begin, end, color=shade, alpha=0.15, lw=0, label=use)
        if k == 0:
            axes.legend(frameon=False, fontsize=8, ncols=2, loc="upper right")
