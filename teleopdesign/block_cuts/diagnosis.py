"""The result: every block against the measurement, as one ladder over all cuts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..diagnose import Diagnosis
from ..diagnose.answer import answer
from ..diagnose.candidates import Candidate
from ..diagnose.criteria import CRITERIA
from ..diagnose.statements import VerdictName
from .computer import Placed
from .computer_fit import ControlData
from .computer_search import Attempt, ComputerLadder, ComputerStep
from .cuts import Cuts, same_effects
from .cuts_ladder import CutsRow, Key, join_ladders
from .diagram_experiment import DiagramExperiment

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class BlockDiagnosis(Shown, ByValue):
    """Which block of a diagram differs from the recording, and by which effect.

    cuts: what is tested, and what is not
    bodies: cut -> diagnosis of its body;  computer: ladder of the other cuts; None: none
    data: of these cuts;  joined: cut of a body whose command the laws give -> ladder of the laws
    """

    experiment: DiagramExperiment
    cuts: Cuts
    bodies: Mapping[str, Diagnosis]
    computer: ComputerLadder | None
    data: ControlData | None = None
    joined: Mapping[str, ComputerLadder] = field(default_factory=dict)

    @property
    def ladders(self) -> tuple[ComputerLadder, ...]:
        """The ladders of laws: in the cuts of bodies, and in those of the computer."""
        alone = () if self.computer is None else (self.computer,)
        return (*self.joined.values(), *alone)

    @property
    def steps(self) -> tuple[ComputerStep, ...]:
        """The steps of the ladders of laws."""
        return tuple(step for ladder in self.ladders for step in ladder.steps)

    @property
    def placed(self) -> tuple[tuple[Placed, float], ...]:
        """Effects of laws and free parameters at the end of their ladders, with standard errors."""
        ends = [ladder.last for ladder in self.ladders]
        pairs = (pair for fit in ends for pair in zip(fit.placed, fit.stderr, strict=True))
        return tuple({p.key: (p, error) for p, error in pairs}.values())

    @cached_property
    def floors(self) -> dict[str, float]:
        """Cut -> error that sensors and rounding alone would leave."""
        made = {name: d.floor.value for name, d in self.bodies.items()}
        made |= self.computer.floors if self.computer is not None else {}
        return {c.name: made[c.name] for c in self.cuts.tested if c.name in made}

    @cached_property
    def rows(self) -> tuple[CutsRow, ...]:
        """The ladder of all cuts together; no row raises its error."""
        return join_ladders(self.cuts, self.bodies, self.joined, self.computer)

    @property
    def check(self) -> str:
        """What the check errors are of: "records", or "blocks of fit" where none is for checks."""
        logs = self.experiment.logs
        return "records" if any(log.use == "check" for log in logs) else "blocks of fit"

    @property
    def named_in_computer(self) -> tuple[Attempt, ...]:
        """Accepted effects of the computer that are probable enough, without look-alikes."""
        return tuple(
            s.accepted
            for s in self.steps
            if s.accepted is not None and not s.likes and s.accepted.probability >= CRITERIA.named
        )

    @property
    def missing(self) -> tuple[Key, ...]:
        """Effects that are missing, with their places, in the order of the ladder."""
        named = {t.added.key for t in self.named_in_computer}
        for name, d in self.bodies.items():
            alone = (one for one in d.missing if not self._equal_effects(name, one))
            named |= {(one.effect.name, one.at) for one in alone}
        added = (r.added for r in self.rows if r.added in named and r.added is not None)
        return tuple(dict.fromkeys(added))

    @property
    def adequate(self) -> dict[str, bool]:
        """Cut -> whether what is left of it is noise."""
        made = {name: d.verdict == "model_adequate" for name, d in self.bodies.items()}
        for name, ladder in self.joined.items():
            made[name] &= not ladder.accepted
        if self.computer is not None:
            fine = self.computer.is_adequate and not self.computer.accepted
            made |= dict.fromkeys(self.computer.floors, fine)
        return made

    @property
    def verdict(self) -> VerdictName:
        """Of the tested cuts only."""
        if self.missing:
            return "effects_missing"
        return "model_adequate" if all(self.adequate.values()) else "undecided"

    @property
    def groups(self) -> tuple[tuple[Key, ...], ...]:
        """Effects that explain the records equally well, the accepted one first."""
        groups = []
        for name, d in self.bodies.items():
            listed = [list(group) for group in d.indistinguishable]
            alone = [[one] for one in d.missing if not any(one in group for group in listed)]
            for group in listed + [one for one in alone if self._equal_effects(name, one[0])]:
                keys = [(c.effect.name, c.at) for c in group]
                keys += [key for c in group for key in self._equal_effects(name, c)]
                groups.append(tuple(dict.fromkeys(keys)))
        for s in self.steps:
            if s.accepted is not None and s.likes:
                groups.append((s.accepted.added.key, *s.likes))
        return tuple(groups)

    def _equal_effects(self, cut: str, one: Candidate) -> tuple[Key, ...]:
        """Effects at other blocks of a body's cut that are the same by the wiring."""
        place = next(c for c in self.cuts.tested if c.name == cut)
        return same_effects(self.experiment.diagram, place, one.effect)

    @property
    def left(self) -> dict[str, float]:
        """Cut -> last check error over its floor."""
        last = self.rows[-1].check
        return {n: last[n] / f if f else float("inf") for n, f in self.floors.items()}

    def answer(self) -> dict[str, Any]:
        """The answer as plain data, in the format of a diagnosis; SI units."""
        bodies = {name: answer(d) for name, d in self.bodies.items()}
        candidates = [c for name, one in bodies.items() for c in self._share_candidates(name, one)]
        candidates += self._candidates_of_computer()
        parameters = {n: v for one in bodies.values() for n, v in one["model_parameters"].items()}
        parameters |= self._parameters_of_laws()
        shifts = {n: v for one in bodies.values() for n, v in one["record_shift"].items()}
        return {
            "verdict": self.verdict,
            "missing": [_place(key) for key in self.missing],
            "ladder": [
                {
                    "added": None if r.added is None else _place(r.added),
                    "fit_error": r.fit_error,
                    "check_error": r.check_error,
                    "cuts": dict(r.check),
                }
                for r in self.rows
            ],
            "noise_floor": float(np.sqrt(np.mean(np.square(list(self.floors.values()))))),
            "floors": self.floors,
            "check": self.check,
            "candidates": sorted(candidates, key=lambda c: -c["probability"]),
            "indistinguishable": [[_place(key) for key in group] for group in self.groups],
            "cannot_tell": [known for one in bodies.values() for known in one["cannot_tell"]],
            "model_parameters": parameters,
            "tested": {c.name: list(c.blocks) for c in self.cuts.tested},
            "untested": dict(self.cuts.untested),
            "to_separate": {c.name: list(c.separating) for c in self.cuts.tested if c.separating},
            "assumed": self.experiment.assumed,
            "record_shift": shifts | self._shift_of_computer(),
            "bodies": bodies,
        }

    def _share_candidates(self, cut: str, body: Mapping[str, Any]) -> list[dict[str, Any]]:
        """The candidates of a body; what is the same at other blocks shares its probability."""
        shared = []
        effects = {one.candidate.key: one.candidate for one in self.bodies[cut].candidates}
        for one in body["candidates"]:
            same = self._equal_effects(cut, effects[one["effect"], one["at"]])
            for key in ((one["effect"], one["at"]), *same):
                part = one["probability"] / (1 + len(same))
                shared.append({**one, **_place(key), "probability": part})
        return shared

    def _parameters_of_laws(self) -> dict[str, Any]:
        """Free parameters of controllers at the end of the ladder."""
        return {
            f"{p.at}.{p.effect.parameter}": {
                "value": p.value,
                "stderr": stderr,
                "unit": self.experiment.unit(p.effect, p.at),
            }
            for p, stderr in self.placed
            if p.effect.of_law
        }

    def _shift_of_computer(self) -> dict[str, Any]:
        if self.computer is None or self.data is None or not self.computer.last.shift:
            return {}
        late = self.computer.last.shift * self.data.rows[0].period
        return {name: {"value": late, "unit": "s"} for name in self.computer.floors}

    def _candidates_of_computer(self) -> list[dict[str, Any]]:
        """Every effect of a controller tried, by the step at which it was most probable."""
        best: dict[Key, Attempt] = {}
        for step in self.steps:
            for one in step.attempts:
                if one.added.key not in best or one.probability > best[one.added.key].probability:
                    best[one.added.key] = one
        return [
            {
                **_place(key),
                "probability": one.probability,
                "check_error": one.fit.error("check"),
                "cuts": one.fit.errors["check"],
                "refused": one.refused,
                "parameters": {
                    one.added.effect.parameter: {
                        "value": one.added.value,
                        "stderr": one.fit.stderr[-1],
                        "unit": self.experiment.unit(one.added.effect, one.added.at),
                    }
                },
            }
            for key, one in best.items()
        ]

    def plot(self) -> Figure:
        """The block diagram, each block coloured by the error of its cut."""
        return figure_of(self)

    def plot_residuals(self) -> Figure:
        """What is left at the computer's cuts, over time and the variables of their blocks."""
        return figure_of(self, kind="panels")


def _place(key: Key) -> dict[str, str]:
    return {"effect": key[0], "at": key[1]}
