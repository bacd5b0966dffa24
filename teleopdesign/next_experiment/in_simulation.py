"""Test of a proposal: each rival in turn is the truth, and the simulated records are diagnosed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from ..base.shown import Shown
from ..diagnose.diagnosis import Diagnosis
from ..diagnose.ladder import find_missing
from .prediction import run_twice, with_records
from .proposal import Proposal
from .rivals import Rival


@dataclass(frozen=True)
class SimulatedDiagnosis(Shown):
    """A diagnosis of the present and the new records, with one rival as the truth.

    named: whether the truth, and no other effect instead of it, is named
    """

    truth: Rival
    named: bool
    diagnosis: Diagnosis


def show_in_simulation(
    proposal: Proposal,
    *,
    seconds: float = float("inf"),
    progress: Callable[[str], None] | None = None,
    seed: int = 100,
) -> tuple[SimulatedDiagnosis, ...]:
    """Diagnose the present records with new records of the motion, for each rival as the truth.

    seconds: no further rival is started after this time;  seed: of the new records' sensor errors
    returns: empty where the proposal has no motion
    """
    shown: list[SimulatedDiagnosis] = []
    began = time.perf_counter()
    for i, rival in enumerate(proposal.rivals):
        if proposal.plan is None or time.perf_counter() - began > seconds:
            break
        if progress is not None:
            progress(f"simulating records with {rival} as the true effect")
        new = run_twice(rival.model, proposal.plan, proposal.bench, seed=seed + i)
        experiment = with_records(proposal.diagnosis.experiment, new)
        diagnosis = find_missing(experiment, proposal.diagnosis.before.model)
        shown.append(SimulatedDiagnosis(rival, names_alone(diagnosis, rival), diagnosis))
    return tuple(shown)


def names_alone(diagnosis: Diagnosis, rival: Rival) -> bool:
    """Whether a diagnosis names the rival's effect, and no other explains the records as well."""
    key = rival.candidate.key
    return diagnosis.verdict == "effects_missing" and any(
        r.added is not None and r.added.key == key and not r.alternatives for r in diagnosis.rungs
    )
