"""The ladder of a diagnosis, over the parts of an experiment.

A part is what is searched together: the one or two bodies of an experiment, or one joint of an arm.
The joints of an arm share the parameters of its links.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

from ..measurement.experiment import Experiment
from ..model import Model
from .cores import one_thread_of_algebra
from .diagnosis import Diagnosis
from .ladder_state import restrict_candidates
from .narrower_band import choose_band, narrower_to_search
from .parts_ladder import begin_parts, climb_parts, conclude_parts
from .parts_result import diagnosis_of_parts
from .search_plan import PLAN, SearchPlan


@one_thread_of_algebra()
def find_missing(
    experiment: Experiment,
    model: Model | None = None,
    *,
    progress: Callable[[str], None] | None = None,
    seed: int = 0,
    plan: SearchPlan = PLAN,
    among: Collection[str] | None = None,
) -> Diagnosis:
    """Compare a model with an experiment and add the effects that its check records support.

    model: of an arm with a body for each joint; None: the model that the experiment describes
    Of more than `SearchPlan.long` samples, only `SearchPlan.windows` samples are searched, in
    windows spread evenly over the records; errors are those of the whole records. Those of an arm
    are searched whole.
    progress: called with a line of text at each step (a `ProgressLine` while candidates are fitted)
    seed: of the random numbers for the noise floor;  plan: extent of the search, such as `QUICK`
    among: names of the candidate effects; None: all that the model knows
    raises ExperimentError: the experiment lacks what the comparison needs
    raises ModelError: `among` holds an unknown name
    """
    stated, report = model or Model.from_experiment(experiment), progress or (lambda _: None)
    if among is not None:
        stated = restrict_candidates(among, stated)

    def search(bandwidth: float | None = None) -> Diagnosis:
        prepared, parts, first = begin_parts(
            experiment, stated, report, bandwidth=bandwidth, seed=seed, plan=plan
        )
        rungs = climb_parts(parts, first, prepared, report)
        return diagnosis_of_parts(*conclude_parts(prepared, parts, rungs), stated)

    diagnosis = search()
    if (band := narrower_to_search(diagnosis)) is not None:
        report(f"once more, up to {band.bandwidth:.3g} Hz")
        diagnosis = choose_band(diagnosis, search(band.bandwidth))
    return diagnosis if among is None else _with_candidates_named(among, diagnosis)


def _with_candidates_named(among: Collection[str], diagnosis: Diagnosis) -> Diagnosis:
    """The diagnosis, with the names of the candidates that its search was restricted to."""
    words = f"only these effects were candidates: {', '.join(sorted(among))}"
    joints = {j: _with_candidates_named(among, one) for j, one in diagnosis.joints.items()}
    return replace(diagnosis, left_out=(*diagnosis.left_out, words), joints=joints)
