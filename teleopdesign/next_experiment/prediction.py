"""Prediction for a proposed motion: every rival in turn is the truth, the others are refitted.

The motion is run twice: one record is fitted together with the present ones, the other is a check
record.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.units import unit_of
from ..diagnose.error import error_of
from ..diagnose.evidence import gain_score
from ..diagnose.fit import Fit, estimate
from ..diagnose.noise_floor import noise_floor
from ..diagnose.residual import relative_residuals
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.prepare import Stretch, prepare
from ..measurement.record import Record
from ..model import Model
from .rivals import Rival, pairs, rms_measured
from .synthesis import Bench, PlannedMotion, record_under

#: the two records of a proposed motion
FIT, CHECK = "next_fit", "next_check"
#: separation of two models, in noise floors, from which a motion decides between them: the error of
#: a right model is between one and about one and a half noise floors, so a smaller separation may
#: be an error of the method
DECIDES = 1.0
#: separation, in noise floors, below which the forces of two models count as equal
SAME = 0.05


@dataclass(frozen=True)
class Separation:
    """Error of one rival along the proposed motion if another is the truth.

    present: error on the present records beyond that of the truth, in noise floors
    predicted: the same on the new check record, after all rivals are refitted on all fit records
    score: how surely the truth then has the smaller error (standard deviations)
    """

    truth: Rival
    other: Rival
    present: float
    predicted: float
    score: float


@dataclass(frozen=True)
class DeterminedParameter:
    """A parameter that the present records leave open and the new one determines.

    before, after: standard error over value;  unit: of the value
    """

    name: str
    value: float
    unit: str
    before: float
    after: float


@dataclass(frozen=True)
class Curves:
    """Residual of a rival along the new check record, with that of the truth (n,).

    body: of the truth's effect;  unit: of the forces
    left: residual of the rival;  noise: residual of the truth
    """

    body: str
    unit: str
    time: Array
    left: Array
    noise: Array


@dataclass(frozen=True)
class RivalPrediction:
    """All predictions for one rival as the truth.

    truth: its number;  curves: of each other rival
    """

    truth: int
    separations: tuple[Separation, ...]
    determined: tuple[DeterminedParameter, ...]
    curves: tuple[Curves, ...]


def run_twice(
    truth: Model, plan: PlannedMotion, bench: Bench, *, seed: int
) -> tuple[Record, Record]:
    """The fit and the check record of the planned motion, with this model as the truth."""
    records = [
        record_under(truth, plan, bench, np.random.default_rng([seed, i]), file=name, use=use)
        for i, (name, use) in enumerate(((FIT, "fit"), (CHECK, "check")))
    ]
    return records[0], records[1]


def with_records(experiment: Experiment, records: Sequence[Record]) -> Experiment:
    """The experiment with additional records."""
    return replace(experiment, records=(*experiment.records, *records))


@dataclass(frozen=True)
class Refit:
    """Rivals fitted to all fit records together, with their residuals on the new check record.

    errors: of each rival, in noise floors of the new record or of the present ones, whichever are
        larger
    floor: one noise floor, as a relative force error
    """

    fits: tuple[Fit, ...]
    errors: tuple[float, ...]
    floor: float
    check: tuple[Stretch, ...]

    def separation(self, *, truth: int, other: int) -> float:
        """Error of one rival beyond another's, in noise floors (in quadrature); 0 if it is smaller.

        For measured records.
        """
        return float(np.sqrt(max(self.errors[other] ** 2 - self.errors[truth] ** 2, 0.0)))

    def predict_separation(self, *, truth: int, other: int) -> float:
        """Mean of `separation` over the sensors' errors, for simulated records of the truth."""
        both = (relative_residuals(self.fits[i].model, self.check) for i in (truth, other))
        apart = [b - a for (a, _), (b, _) in zip(*both, strict=True)]
        return error_of(self.check, apart) / self.floor


def refit(rivals: Sequence[Rival], new: Sequence[Record], bench: Bench, *, seed: int = 0) -> Refit:
    """Fit rivals to the present records and new ones, and compare them on the new check record.

    rivals: the first one for the noise floor;  new: records with the names `FIT` and `CHECK`
    """
    prepared = prepare(with_records(bench.experiment, new), bandwidth=bench.bandwidth)
    check = tuple(s for s in prepared.stretches if s.motion.file == CHECK)
    fits = tuple(estimate(r.model, prepared) for r in rivals)
    generator = np.random.default_rng(seed)
    check_floor = noise_floor(fits[0].model, replace(prepared, stretches=check), generator).value
    floor = max(check_floor, bench.floor / rms_measured(check))
    # relative to what acts by each model: one whose actuator passes less has gained nothing by that
    left = [[r for r, _ in relative_residuals(f.model, check)] for f in fits]
    return Refit(fits, tuple(error_of(check, r) / floor for r in left), floor, check)


def predict(
    number: int,
    rivals: Sequence[Rival],
    plan: PlannedMotion,
    bench: Bench,
    present: Mapping[tuple[int, int], float],
    *,
    seed: int,
) -> RivalPrediction:
    """The prediction with rival `number` as the truth: all its rivals are refitted to its records.

    present: (truth, other) -> separation on the present records
    """
    truth = rivals[number]
    against = [i for i in range(len(rivals)) if (number, i) in pairs(rivals)]
    new = run_twice(truth.model, plan, bench, seed=seed)
    fitted = refit([truth, *(rivals[i] for i in against)], new, bench, seed=seed)
    separations = tuple(
        Separation(
            truth,
            rivals[i],
            present[number, i],
            fitted.predict_separation(truth=0, other=k),
            _score(fitted.fits[k], fitted.fits[0]),
        )
        for k, i in enumerate(against, start=1)
    )
    curves = tuple(_curves(truth, fitted, k) for k in range(1, len(fitted.fits)))
    return RivalPrediction(
        number, separations, _determined_parameters(truth, fitted.fits[0]), curves
    )


def _score(other: Fit, truth: Fit) -> float:
    return gain_score(other.check_residual, truth.check_residual, truth.check_blocks)


def _curves(truth: Rival, fitted: Refit, other: int) -> Curves:
    """The residuals of the truth and of another rival, at the body of the truth's effect."""
    at = truth.candidate.at
    here = [s for s in fitted.check if s.motion.body == at] or list(fitted.check)
    (left, _), (noise, _) = (
        relative_residuals(fitted.fits[i].model, here[:1])[0] for i in (other, 0)
    )
    body, rows = here[0].motion.body, here[0].keep
    unit = unit_of("force", truth.model.body(body).axis)
    return Curves(body, unit, here[0].motion.time[rows], left, noise)


def find_least_determined(
    determined: Sequence[DeterminedParameter],
) -> tuple[DeterminedParameter, ...]:
    """Each parameter once, with its largest standard error over all truths."""
    least: dict[str, DeterminedParameter] = {}
    for d in determined:
        if d.name not in least or d.after > least[d.name].after:
            least[d.name] = d
    return tuple(least.values())


#: standard error over value from which a parameter counts as open, and below which it counts as
#: determined
LEFT_OPEN, DETERMINED = 0.25, 0.1


def _determined_parameters(truth: Rival, fit: Fit) -> tuple[DeterminedParameter, ...]:
    """Parameters of the truth that the present records leave open and all records determine."""
    rows = []
    for name in fit.free:
        old, new = truth.model.parameters[name], fit.model.parameters[name]
        size = np.pi if fit.model.declared(name).quantity == "angle" else abs(new.value)
        size = max(float(size), 1e-300)
        before, after = old.stderr / size, new.stderr / size
        # a standard error that is not a number: the records say nothing at all
        if not before < LEFT_OPEN and after < DETERMINED:
            rows.append(DeterminedParameter(name, new.value, fit.model.unit(name), before, after))
    return tuple(rows)
