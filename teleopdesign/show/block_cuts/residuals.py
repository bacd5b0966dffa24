"""What is left at each cut of the computer, over time and over the variables of its blocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...block_cuts.computer import velocity_of
from ...block_cuts.diagnosis import BlockDiagnosis
from ...diagrams import Control
from ..figures.style import CASES, TWO_COLUMNS, symbol
from ..registry import shows

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...measurement.filtering import Array

#: most points of a cloud
POINTS = 3000
GREY, COLOUR = "0.6", CASES["MBC"][0]


@shows("panels")
def plot_residuals(diagnosis: BlockDiagnosis) -> Figure:
    """A row a cut of the computer: residual before (grey) and after, low-passed, on check rows."""
    import matplotlib.pyplot as plt

    data, ladder = diagnosis.data, diagnosis.computer
    cuts = () if data is None else data.part.cuts
    columns = max([len(_variables(diagnosis, 0, cut.name)) for cut in cuts], default=1)
    page, axes = plt.subplots(
        max(len(cuts), 1),
        columns,
        sharey="row",
        figsize=(TWO_COLUMNS, 1.9 * max(len(cuts), 1)),
        squeeze=False,
        layout="constrained",
    )
    if data is None or ladder is None:
        return page
    record = next((i for i, r in enumerate(data.rows) if r.use == "check"), 0)
    rows = data.masks[record]["check"]
    for line, cut in zip(axes, cuts, strict=True):
        unit = "N" if diagnosis.experiment.axis(cut.signal) == "prismatic" else "N m"
        variables = _variables(diagnosis, record, cut.name)
        for one, (label, values) in zip(line, variables.items(), strict=False):
            for fit, colour in ((ladder.base, GREY), (ladder.last, COLOUR)):
                made = data.predictions(fit.placed)[record][cut.signal]
                left = data.recorded[record][cut.signal] - np.roll(made, fit.shift)
                every = max(1, int(np.sum(rows)) // POINTS)
                style = "-" if label == "t [s]" else "."
                one.plot(
                    values[rows][::every],
                    left[rows][::every],
                    style,
                    color=colour,
                    ms=1.5,
                    rasterized=True,
                )
            one.set_xlabel(label)
        line[0].set_ylabel(f"residual of {symbol(cut.signal)} [{unit}]")
    return page


def _variables(diagnosis: BlockDiagnosis, record: int, name: str) -> dict[str, Array]:
    """Label -> values at the rows: time, the inputs of the blocks of a cut, and their velocity."""
    assert diagnosis.data is not None
    rows, diagram = diagnosis.data.rows[record], diagnosis.experiment.diagram
    cut = next(c for c in diagnosis.data.part.cuts if c.name == name)
    count = len(next(iter(rows.signals.values())))
    variables: dict[str, Array] = {
        "t [s]": np.asarray(np.arange(count) * rows.period, dtype=np.float64)
    }
    for signal in cut.inputs:
        values = rows.signals[signal]
        motion = diagram.is_position(signal)
        if motion and any(signal in _motions(diagnosis, b) for b in cut.blocks):
            variables[f"velocity of {symbol(signal)}"] = velocity_of(values, rows.period)
        elif not motion:
            variables[symbol(signal)] = values
    return variables


def _motions(diagnosis: BlockDiagnosis, name: str) -> set[str]:
    """Positions on which a controller's motion depends."""
    diagram = diagnosis.experiment.diagram
    block = diagram.block(name) if diagram.has(name) else None
    if not isinstance(block, Control) or not block.motion:
        return set()
    return {x.name for x in diagram.position(block.motion).free_symbols}
