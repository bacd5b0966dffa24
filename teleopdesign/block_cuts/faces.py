"""`compare`, `rank` and `describe` of bodies, or of each cut of a whole diagram."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, overload

from ..diagnose import Comparison, Ranking
from ..diagnose import compare as compare_bodies
from ..diagnose import rank as rank_bodies
from ..diagnose.by_simulation import SimulationComparison
from ..measurement.experiment import Experiment
from ..model import Model
from ..unexplained import ResidualDescription
from ..unexplained import describe as describe_bodies
from .body import body_experiment, model_of_body
from .computer_fit import floors
from .computer_search import ComputerStep, step_of
from .control_rows import ControlFit
from .cuts import COMPUTER, Cut
from .diagram_experiment import DiagramExperiment
from .joined_cut import rank_laws
from .search import data_of_computer


@overload
def compare(model: DiagramExperiment) -> Mapping[str, Comparison | ControlFit]: ...


@overload
def compare(
    model: Model, experiment: Experiment, **options: Any
) -> Comparison | SimulationComparison: ...


def compare(
    model: Model | DiagramExperiment, experiment: Experiment | None = None, **options: Any
) -> Comparison | SimulationComparison | Mapping[str, Comparison | ControlFit]:
    """Compare a model with every record, without estimation; options as `diagnose.compare`.

    model: of bodies, or an experiment of a whole diagram, which has its own
    returns: of a diagram: cut -> comparison of its body, or what the stated laws leave

        >>> experiment = td.load_experiment(td.example("rod"))
        >>> td.compare(td.Model.from_experiment(experiment), experiment)
        Comparison below 60 Hz
          fit error    8.68 %
          check error  9.48 %
          noise floor  0.94 %  (stated resolution and noise)
    """
    if isinstance(model, Model):
        whole: Comparison | SimulationComparison
        whole = compare_bodies(model, _of_bodies(experiment), **options)
        return whole
    made: dict[str, Comparison | ControlFit] = {}
    for cut, body, known in _bodies(model):
        one = compare_bodies(known, body, **options)
        assert isinstance(one, Comparison)
        made[cut.name] = one
    if computed := _names_of_computer(model):
        fit = data_of_computer(model, model.cuts, {}).at(())
        made |= dict.fromkeys(computed, fit)
    return made


@overload
def rank(model: DiagramExperiment) -> Mapping[str, Ranking | ComputerStep]: ...


@overload
def rank(model: Model, experiment: Experiment) -> Ranking: ...


def rank(
    model: Model | DiagramExperiment, experiment: Experiment | None = None
) -> Ranking | Mapping[str, Ranking | ComputerStep]:
    """Effects that a model may lack, each added alone and fitted, best first.

    model: of bodies, or an experiment of a whole diagram, which has its own
    returns: of a diagram: cut -> ranking of its body, or of the effects of controllers; "Z_M, laws"
        -> ranking of the laws that give the command in the cut of a body

        >>> experiment = td.load_experiment(td.example("rod"))
        >>> model = td.fit(td.Model.from_experiment(experiment), experiment)
        >>> td.rank(model, experiment).best.candidate.effect.name
        'stribeck'
    """
    if isinstance(model, Model):
        return rank_bodies(model, _of_bodies(experiment))
    made: dict[str, Ranking | ComputerStep] = {}
    for cut, body, known in _bodies(model):
        made[cut.name] = rank_bodies(known, body)
        if COMPUTER in cut.blocks:
            made[f"{cut.name}, laws"] = rank_laws(model, cut, known)
    if computed := _names_of_computer(model):
        data = data_of_computer(model, model.cuts, {})
        made |= dict.fromkeys(computed, step_of(data, data.base(), floors(data, model)))
    return made


@overload
def describe(model: DiagramExperiment) -> Mapping[str, ResidualDescription]: ...


@overload
def describe(model: Model, experiment: Experiment, *, seed: int = 0) -> ResidualDescription: ...


def describe(
    model: Model | DiagramExperiment, experiment: Experiment | None = None, *, seed: int = 0
) -> ResidualDescription | Mapping[str, ResidualDescription]:
    """Estimate a model again, then describe where it fails and what its residual depends on.

    model: of bodies, or an experiment of a whole diagram, which has its own
    experiment: dependences are estimated on its fit records and tested on its check records
    seed: of the random numbers for the noise floor
    returns: of a diagram: cut -> description of its body; laws of a computer have no free force

        >>> experiment = td.load_experiment(td.example("rod"))
        >>> description = td.describe(td.Model.from_experiment(experiment), experiment)
        >>> print(description.findings[0])
        warning the model leaves 7 % of the force, 7.2 times what sensor noise would leave.
    """
    if isinstance(model, Model):
        return describe_bodies(model, _of_bodies(experiment), seed=seed)
    bodies = _bodies(model)
    return {cut.name: describe_bodies(known, body, seed=seed) for cut, body, known in bodies}


def _of_bodies(experiment: Experiment | None) -> Experiment:
    if not isinstance(experiment, Experiment):
        raise TypeError("a model of bodies needs an experiment of bodies beside it")
    return experiment


def _bodies(experiment: DiagramExperiment) -> Iterator[tuple[Cut, Experiment, Model]]:
    """The cuts of bodies, each with its experiment and the model of its diagram."""
    for cut in experiment.cuts.of("body"):
        yield cut, body_experiment(experiment, cut), model_of_body(experiment.diagram, cut)


def _names_of_computer(experiment: DiagramExperiment) -> tuple[str, ...]:
    cuts = experiment.cuts
    return tuple(c.name for c in (*cuts.of("computer"), *cuts.of("wiring")))
