"""The proposal: the next motion, the reason for it, what it will show, and what it cannot show.

The proposed motion as a CSV file for a servo.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.files import harmless_cell, make_plain, write_beside
from ..base.finding import Finding
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of, look
from ..base.units import si_factor
from ..diagnose.diagnosis import Diagnosis
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from .limits import Limits
from .prediction import DECIDES, SAME, Curves, DeterminedParameter, Separation
from .remedies import Remedy
from .rivals import Rival, pairs
from .synthesis import Bench, PlannedMotion

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Reference(ByValue):
    """Positions for the servos of the bodies (SI).

    time: s, (n,), uniform with the record's sample time;  position: body -> (n,)
    parts: clauses on the motion, in their order;  repeats: of all parts together
    """

    time: Array
    position: Mapping[str, Array]
    parts: tuple[str, ...]
    repeats: int

    @property
    def duration(self) -> float:
        """Length, s."""
        return float(self.time[-1])


@dataclass(frozen=True, eq=False)
class Proposal(Shown, ByValue):
    """The motion to measure next, which separates the rivals.

    rivals: models that the present records leave open; empty where the records decide
    reference: the motion; None where there are no rivals, or no motion keeps the limits
    separations: one for each truth and each of its rivals
    determined: parameters that become determinable
    remedies: pair of rivals (numbers) that the motion does not separate -> simulated changes
    limits: body -> limits that the motion keeps
    bench, plan: for simulated records of the motion (`show_in_simulation`)
    """

    diagnosis: Diagnosis
    rivals: tuple[Rival, ...]
    reference: Reference | None
    separations: tuple[Separation, ...]
    determined: tuple[DeterminedParameter, ...]
    curves: tuple[Curves, ...]
    remedies: Mapping[tuple[int, int], tuple[Remedy, ...]]
    limits: Mapping[str, Limits]
    bench: Bench = field(repr=False)
    plan: PlannedMotion | None = field(default=None, repr=False)

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """Pairs of rivals (numbers) of one question, each once."""
        return [(i, j) for i, j in pairs(self.rivals) if i < j]

    def both(self, pair: tuple[int, int]) -> list[Separation]:
        """Both separations of a pair of rivals, each of them as the truth."""
        ids = {id(self.rivals[i]) for i in pair}
        return [s for s in self.separations if {id(s.truth), id(s.other)} == ids]

    def decides(self, pair: tuple[int, int]) -> bool:
        """Whether the motion separates two rivals, whichever of them is the truth."""
        both = self.both(pair)
        return len(both) == 2 and all(s.predicted >= DECIDES for s in both)

    @property
    def is_useful(self) -> bool:
        """Whether the motion separates any two rivals better than the present records do."""
        return any(s.predicted > max(s.present, SAME) for s in self.separations)

    @property
    def sentence(self) -> str:
        """The motion and its expected result, in words."""
        return str(look(self, "sentence"))

    def findings(self) -> tuple[Finding, ...]:
        """The proposal as findings: the motion, the separations, what becomes determinable."""
        return tuple(look(self, "findings"))

    def plot(self) -> Figure:
        """Figure of the motion, the residual of a wrong model along it, and the separations."""
        return figure_of(self)


def proposal_data(proposal: Proposal) -> dict[str, Any]:
    """The proposal as plain data (SI) for a JSON file.

    Separations in noise floors (1: a right model's error); times in s, bodies by name.
    """
    reference = proposal.reference
    data = {
        "verdict": proposal.diagnosis.verdict,
        "sentence": proposal.sentence,
        "rivals": [_place(r) for r in proposal.rivals],
        "reference": None
        if reference is None
        else {
            "duration": reference.duration,
            "parts": list(reference.parts),
            "repeats": reference.repeats,
        },
        "separations": [
            {
                "truth": _place(s.truth),
                "other": _place(s.other),
                "present": s.present,
                "predicted": s.predicted,
                "score": s.score,
            }
            for s in proposal.separations
        ],
        "determined": [asdict(d) for d in proposal.determined],
        "remedies": [
            {
                "rivals": [_place(proposal.rivals[i]) for i in pair],
                "tried": [asdict(r) for r in value],
            }
            for pair, value in proposal.remedies.items()
        ],
        "limits": {b: asdict(value) for b, value in proposal.limits.items()},
    }
    content: dict[str, Any] = make_plain(data)
    return content


def _place(rival: Any) -> dict[str, str]:
    return {"effect": rival.candidate.effect.name, "at": rival.candidate.at}


def write_reference(reference: Reference, experiment: Experiment, path: str | Path) -> None:
    """Write time and position reference of each body, with header and units of the experiment.

    Without a time channel the first column is t, in s.
    """
    clock = experiment.channels.get("time")
    head, columns, forms = ["t"], [reference.time], ["%.9g"]
    if clock is not None:
        head = [clock.column]
        columns = [reference.time / si_factor(clock.unit, quantity="time")]
    for body, position in reference.position.items():
        channel = experiment.channels[f"{body}.position"]
        factor = si_factor(channel.unit, quantity="position", axis=experiment.axis(body))
        head.append(channel.column)
        columns.append(position / factor)
        forms.append("%.9g")
    with write_beside(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerow(map(harmless_cell, head))
        np.savetxt(file, np.column_stack(columns), fmt=forms, delimiter=",")
