"""The page of a diagnosis, with every section."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ModelError
from ._options import say

if TYPE_CHECKING:
    from ..base.finding import Finding
    from ..diagnose import ArmDiagnosis, Diagnosis


def write_page(diagnosis: Diagnosis, path: Path) -> None:
    """Write the page, with findings on the recording, the residual, and what to measure next."""
    from ..fitted_checks import check_experiment
    from ..show.report import write_report
    from ..unexplained import where_it_fails

    say("checking the recording")
    soundness = check_experiment(diagnosis.experiment, diagnosis.before.model)
    say("describing what is left")
    left = where_it_fails(diagnosis.after, diagnosis.prepared, diagnosis.floor)
    steps = _next_steps(diagnosis)
    say("")
    write_report(diagnosis, path, soundness=soundness, unexplained=left, next_steps=steps)


def _next_steps(diagnosis: Diagnosis) -> tuple[Finding, ...]:
    """What to measure next; nothing where nothing is open, or no motion was shown to be safe."""
    from ..next_experiment import propose, shown_limits

    if diagnosis.verdict != "undecided" and not diagnosis.groups:
        return ()
    try:
        shown_limits(diagnosis.prepared)
    except ModelError:
        return ()
    return propose(diagnosis, progress=say).findings()


def write_arm_page(diagnosis: ArmDiagnosis, path: Path) -> None:
    """Write the page of an arm, with findings on the recording and the residual of each joint."""
    from ..fitted_checks import check_experiment
    from ..show.report import write_arm_report
    from ..unexplained import where_it_fails

    say("checking the recording")
    soundness = check_experiment(diagnosis.experiment)
    left = {}
    for joint, one in diagnosis.joints.items():
        say(f"describing what is left at {joint}")
        left[joint] = where_it_fails(one.after, one.prepared, one.floor)
    say("")
    write_arm_report(diagnosis, path, soundness=soundness, unexplained=left)
