"""Every block of a diagram against its recording: the cuts, one after the other.

`compare`, `rank` and `describe` take bodies, or each cut of a whole diagram.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any, overload

from ..base.arguments import check_types
from ..base.errors import ExperimentError, ModelError, unknown
from ..diagnose import Comparison, Diagnosis, Ranking
from ..diagnose import compare as compare_bodies
from ..diagnose import find_missing as find_missing_in_bodies
from ..diagnose import rank as rank_bodies
from ..diagnose.by_simulation import SimulationComparison
from ..diagnose.cores import one_thread_of_algebra
from ..diagnose.search_plan import PLAN, SearchPlan
from ..effects import EFFECTS, Effect
from ..measurement.experiment import Experiment
from ..model import Model
from ..unexplained import ResidualDescription
from ..unexplained import describe as describe_bodies
from .body import body_experiment, diagnose_body, model_of_body
from .channel_doubts import doubt_channels
from .computer_fit import data_of_computer, floors
from .computer_search import ComputerLadder, ComputerStep, climb, step_of
from .control_rows import ControlFit
from .cuts import COMPUTER, Cut, Cuts
from .diagnosis import BlockDiagnosis
from .diagram_experiment import DiagramExperiment
from .joined_cut import climb_joined, placed_for, rank_laws


@check_types
@one_thread_of_algebra()
def find_missing(
    experiment: Experiment | DiagramExperiment,
    model: Model | None = None,
    *,
    progress: Callable[[str], None] | None = None,
    seed: int = 0,
    plan: SearchPlan | None = None,
    among: Collection[str] | None = None,
    at: Collection[str] | None = None,
    known: Mapping[str, Effect] | None = None,
) -> Diagnosis | BlockDiagnosis:
    """Find the effects that a model of bodies, or a whole diagram, lacks.

    experiment: of bodies, as `diagnose.find_missing` takes it, or of a whole diagram
    model: of bodies only; a diagram's values stand in its file
    among: names of candidate effects of bodies; all effects of controller blocks are tried
    at: names of the cuts of a diagram that are compared, such as ("R_A",); None: all
    plan: how wide and how long the search is; None: as is usual
    known: effects of bodies by name, with those of the user; of a diagram only; None: EFFECTS
    raises ExperimentError, ModelError: the records lack what the comparison needs

        >>> experiment = td.load_experiment(td.example("rod"))
        >>> td.find_missing(experiment, among=["stribeck", "bias"]).verdict
        'effects_missing'
    """
    plan, known = plan or PLAN, EFFECTS if known is None else known
    if isinstance(experiment, Experiment):
        return find_missing_in_bodies(
            experiment, model, progress=progress, seed=seed, plan=plan, among=among
        )
    if model is not None:
        raise ModelError("find_missing: found a model beside a diagram, which has its own values")
    if doubt := doubt_channels(experiment):
        raise ExperimentError(
            f"{experiment.title}: {doubt}: state the unit and sign of each column"
        )
    report = progress or (lambda _: None)
    cuts, bodies = _select(experiment.cuts, at), {}
    joined: dict[str, ComputerLadder] = {}
    options: dict[str, Any] = {"known": known, "report": report, "seed": seed, "plan": plan}
    if among is not None:
        options["among"] = among
    for cut in sorted(cuts.of("body"), key=lambda c: COMPUTER not in c.blocks):
        try:
            if COMPUTER in cut.blocks:
                model = model_of_body(experiment.diagram, cut, known)
                joined[cut.name] = climb_joined(experiment, cut, model, report, seed=seed)
            placed = placed_for(cut, joined)
            bodies[cut.name] = diagnose_body(experiment, cut, placed=placed, **options)
        except (ModelError, ExperimentError) as error:
            cuts = _without_cut(cuts, cut.name, str(error))
            joined.pop(cut.name, None)
    data, ladder = None, None
    if computed := (*cuts.of("computer"), *cuts.of("wiring")):
        try:
            data = data_of_computer(experiment, cuts, bodies)
            ladder = climb(data, floors(data, experiment, seed), report)
        except ModelError as error:
            for cut in computed:
                cuts = _without_cut(cuts, cut.name, str(error))
    if not (bodies or ladder):
        raise ExperimentError(f"{experiment.title}: no block can be tested: {_reasons(cuts)}")
    bodies = {c.name: bodies[c.name] for c in cuts.of("body")}
    return BlockDiagnosis(experiment, cuts, bodies, ladder, data, joined)


def _select(cuts: Cuts, at: Collection[str] | None) -> Cuts:
    """The cuts with these names.

    raises ExperimentError: no such cut
    """
    names = [c.name for c in cuts.tested]
    for name in at or ():
        if name not in names:
            raise ExperimentError(f"find_missing: at: {unknown('cut', name, names)}")
    for name in names if at is not None else ():
        if name not in (at or ()):
            cuts = _without_cut(cuts, name, "its cut was left out")
    return cuts


def _reasons(cuts: Cuts) -> str:
    """Why blocks are untested, each reason once."""
    texts = dict.fromkeys(cuts.untested.values())
    blocks = {why: [b for b, text in cuts.untested.items() if text == why] for why in texts}
    return "; ".join(f"{', '.join(names)}: {why}" for why, names in blocks.items())


def _without_cut(cuts: Cuts, name: str, why: str) -> Cuts:
    """The cuts without one of them, whose blocks are then untested."""
    cut = next(c for c in cuts.tested if c.name == name)
    left = tuple(c for c in cuts.tested if c is not cut)
    done = {block for c in left for block in c.blocks}
    return replace(
        cuts,
        tested=left,
        untested={**cuts.untested, **{b: why for b in cut.blocks if b not in done}},
    )


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
