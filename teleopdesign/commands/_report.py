"""The page of a diagnosis, with every section."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ModelError
from ._options import say

if TYPE_CHECKING:
    from ..base.finding import Finding
    from ..diagnose import Diagnosis


def write_page(diagnosis: Diagnosis, path: Path) -> None:
    """Write the page, with findings on the recording, the residual, and what to measure next."""
    from ..fitted_checks import check_experiment
    from ..show.figures.friction_curve import curve_finding
    from ..show.report import write_report
    from ..unexplained import where_it_fails

    say("checking the recording")
    before = None if diagnosis.joints else diagnosis.before.model
    soundness = check_experiment(diagnosis.experiment, before)
    left = {}
    for part, one in (diagnosis.joints or {"": diagnosis}).items():
        say(f"describing what is left{f' at {part}' if part else ''}")
        left[part] = where_it_fails(one.model, one.prepared, one.floor)
        if one.kind:
            left[part] = (curve_finding(one), *left[part])
    steps = _next_steps(diagnosis)
    say("")
    write_report(diagnosis, path, soundness=soundness, unexplained=left, next_steps=steps)


def _next_steps(diagnosis: Diagnosis) -> tuple[Finding, ...]:
    """What to measure next; nothing where nothing is open, or no motion was shown to be safe."""
    from ..next_experiment import propose, shown_limits

    if (
        diagnosis.joints
        or diagnosis.kind
        or (diagnosis.verdict != "undecided" and not diagnosis.groups)
    ):
        return ()
    try:
        shown_limits(diagnosis.prepared)
    except ModelError:
        return ()
    return propose(diagnosis, progress=say).findings()
