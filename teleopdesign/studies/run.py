"""A study: measures of a model at every point of its parameters' axes."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePath
from typing import Any, Literal

from ..base.errors import ExperimentError, ModelError, quote, unknown
from ..diagrams import Diagram
from ..measurement.saving import content_digest, is_experiment
from ..simulate import Sampling, Trajectory
from ..simulate.sampling import SAMPLED
from .case import SimulatedCase
from .chosen_measures import check_case, measures_of
from .evaluate import StudyTask, check_parameters, units_of
from .fingerprint import fingerprint, versions
from .journal import Journal
from .outcomes import Clock, PointOutcome, Progress
from .points import Points, points_of
from .processes import run_on_cluster, run_on_this_machine
from .result import Study, check_netcdf, label_outcomes, read_study, without_reason


def study(
    model: Diagram | SimulatedCase | Callable[..., Any],
    axes: Mapping[str, Any] | Any,
    *,
    measures: Any,
    duration: float = 0.0,
    inputs: Mapping[str, Any] | None = None,
    motion: Mapping[str, Trajectory] | None = None,
    initial: Mapping[str, float] | None = None,
    computer: Sampling | Literal["continuous"] = SAMPLED,
    step: float = 1e-4,
    give: float = 1e-5,
    every_step: bool = False,
    units: Mapping[str, str] | None = None,
    labels: Mapping[str, str] | None = None,
    seed: int = 0,
    workers: int | None = None,
    scheduler: str = "",
    out: str | Path | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Study:
    """Measure a model at every point of its parameters' axes.

    model: a diagram, whose parameters have the names of `Diagram.values` and of `SimulatedCase`; or
        a function of the parameters that returns a diagram, a `SimulatedCase`, or any object that
        the measures accept
    axes: parameter -> values (several parameters: their product) or one value; points drawn
        together (`latin_hypercube`, `sobol`, ...); or a sequence of such, whose product is taken
    measures: names of `MEASURES`, `measure(...)`, functions; several in a list, or by name
    duration ... every_step: settings of `simulate` for a diagram; no duration: no simulation
    units: of a function's parameters and of measures, by name;  labels: names in figures
    seed: of measures that need randomness
    workers: processes of this machine; None: as many as it has cores, or none if that is as fast
    scheduler: address of a Dask cluster, "tcp://..."; the points are computed there
    out: netCDF file; finished points are kept beside it, and the same study continues from there
    progress: called with a `Progress` from time to time; `print` shows it as a line
    raises ModelError: an unknown parameter or measure, a model that cannot be sent
    raises ExperimentError: a file that cannot be written or is of another study, a cluster that
        cannot be reached
    A point that fails is NaN, and `failure` says why. The data do not depend on where the points
    were computed.

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> td.study(
        ...     td.haptic_interface(device),
        ...     {"Z_M.viscous.damping": [1.0, 2.0]},
        ...     measures=td.measure("rms", signal="L"),
        ...     duration=0.1,
        ...     inputs={"R_D": 1.0},
        ... )
        Study of the haptic interface: 2 Z_M.viscous.damping
          rms_L                    0.008701 to 0.00985 m
    """
    settings: dict[str, Any] = {
        "duration": duration,
        "inputs": dict(inputs or {}),
        "motion": dict(motion or {}),
        "initial": dict(initial or {}),
        "computer": computer,
        "step": step,
        "give": give,
        "every_step": every_step,
    }
    _check_places(workers, scheduler, seed)
    task = _task(model, settings, axes, measures, seed)
    by_name = _Words(dict(units or {}), dict(labels or {}))
    target = None if out is None else _check_target(Path(out))
    run = partial(_run, task, workers=workers, scheduler=scheduler, progress=progress)
    return _with_file(task, by_name, target, run)


@dataclass(frozen=True)
class _Words:
    """Units and labels from the user, by parameter or measure."""

    units: Mapping[str, str]
    labels: Mapping[str, str]


def _check_target(target: Path) -> Path:
    """The file of the result; raises ExperimentError: no netCDF file, or a folder."""
    if target.suffix != ".nc":
        raise ExperimentError(f"{target}: found {target.suffix!r}, expected a netCDF file, .nc")
    if target.is_dir():
        raise ExperimentError(f"{target}: is a folder, expected a file")
    return target


def _check_places(workers: int | None, scheduler: str, seed: int) -> None:
    if seed < 0:
        raise ModelError(f"study: seed: found {seed}, expected 0 or more")
    if workers is not None and workers < 1:
        raise ModelError(f"study: workers: found {workers}, expected 1 or more")
    if scheduler and workers is not None:
        raise ModelError("study: workers and scheduler: a cluster has its own workers")


def _task(
    model: Any, settings: Mapping[str, Any], axes: Any, measures: Any, seed: int
) -> StudyTask:
    """The task for every process, checked against the parameters of the model."""
    points, chosen = points_of(axes), measures_of(measures)
    for one in chosen:
        if one.name in points.columns:
            raise ModelError(f'measures: "{one.name}" is a parameter: name it otherwise')
    if isinstance(model, Diagram):
        model = SimulatedCase(model, **settings)
    if isinstance(model, SimulatedCase):
        model.check_names(points.names)
        check_case(model, points, chosen)
    else:
        check_parameters(model, points)
    return StudyTask(model, settings, points, chosen, seed)


def _with_file(
    task: StudyTask, words: _Words, target: Path | None, run: Callable[[Journal], None]
) -> Study:
    """Run the points that neither the file nor the journal beside it holds, and label all."""
    attributes = _attributes(task, words)
    key, part = str(attributes["study"]), None
    if target is not None:
        check_netcdf()
        part = target.with_name(f"{target.name}.part")
        if target.exists():
            stored = _load_stored(target, key)
            with suppress(ExperimentError):  # of another study, or in use: it is kept
                if part.exists():  # a kill between the file and the end of its journal
                    Journal(part, key, len(task.points)).remove()
            _write_words(stored, words)
            return stored
        if not target.parent.is_dir():
            raise ExperimentError(f"{target}: there is no folder {str(target.parent)!r}")
    journal = Journal(part, key, len(task.points))
    try:
        run(journal)
        case = task.model if isinstance(task.model, SimulatedCase) else None
        by_axis = {n: case.unit(n) for n in task.points.names} if case else words.units
        result = label_outcomes(task.points, journal.outcomes, units=by_axis, attributes=attributes)
        _write_words(result, words)
        if target is not None:
            result.to_netcdf(target)
            journal.remove()
    finally:
        journal.close()
    return result


def _run(
    task: StudyTask,
    journal: Journal,
    *,
    workers: int | None,
    scheduler: str,
    progress: Callable[[Progress], object] | None,
) -> None:
    todo = (i for i in range(len(task.points)) if i not in journal.outcomes)
    clock = Clock(len(task.points), len(journal.outcomes), progress)

    def sink(outcome: PointOutcome) -> None:
        if outcome.point not in journal.outcomes:  # of a block that was done in part
            journal.add(outcome)
            clock.count(outcome)

    units = units_of(task, todo)
    if not units:  # all were kept by a run that was stopped before it wrote its file
        if progress is not None:
            progress(clock.now())
        return
    if scheduler:
        run_on_cluster(task, units, sink, scheduler)
    else:
        run_on_this_machine(task, units, sink, workers)


def _load_stored(target: Path, key: str) -> Study:
    """The study in an existing file; raises ExperimentError: the file holds another study."""
    stored = read_study(target)
    if stored.data.attrs["study"] != key:
        raise ExperimentError(
            f"{target}: holds another study (other model, axes, measures or version): choose "
            "another file, or remove it"
        )
    return stored


def _write_words(result: Study, words: _Words) -> None:
    """Add units of measures that a user's functions do not state, and labels.

    raises ModelError: a label or unit of an unknown measure or parameter
    """
    variables = without_reason(map(str, result.data.variables))
    names = [*variables, *json.loads(result.data.attrs["fixed"])]
    for name in {**words.units, **words.labels}:
        if name not in names and result.measures:
            raise ModelError(
                f"study: units, labels: {unknown('measure or parameter', name, names)}"
            )
    for name in variables:
        if name in words.units:
            stated = result.data[name].attrs.get("units", "1")
            if stated not in ("1", words.units[name]):
                raise ModelError(
                    f"study: units: {name} is in {stated}, found {quote(words.units[name])}: a "
                    "unit is a label, and no number is converted"
                )
            result.data[name].attrs["units"] = words.units[name]
        if name in words.labels:
            result.data[name].attrs["long_name"] = words.labels[name]


def _attributes(task: StudyTask, words: _Words) -> dict[str, Any]:
    """Attributes of the data set: enough to compute the numbers again."""
    points, model = task.points, task.model
    values: dict[str, Any] = dict(points.fixed)
    if isinstance(model, SimulatedCase):
        name, values = model.diagram.name, {**model.diagram.values, **values}
        settings = model.settings()
        values = {n: v for n, v in values.items() if n not in points.columns}
    else:
        name, settings = getattr(model, "__name__", "model"), dict(task.case)
    made_with = versions()
    model_hash = fingerprint(model, task.case)
    samples, contents = points.samples, _contents(points)
    return {
        "model": name,
        "model_hash": model_hash,
        "study": fingerprint(
            model_hash,
            points.sizes,
            [(n, c.dimension, c.values) for n, c in points.columns.items()],
            points.fixed,
            task.measures,
            task.seed,
            made_with,
            contents,
        ),
        "contents": json.dumps(contents),
        "axes": json.dumps(list(points.columns)),
        "fixed": json.dumps({n: v for n, v in values.items() if isinstance(v, int | float | str)}),
        "settings": json.dumps({k: str(v) for k, v in settings.items()}),
        "measures": json.dumps(
            {m.name: {k: str(v) for k, v in m.options.items()} for m in task.measures}
        ),
        "seed": task.seed,
        "sampling": samples.method if samples is not None else "",
        "sampling_seed": samples.seed if samples is not None else 0,
        "versions": json.dumps(made_with),
    }


def _contents(points: Points) -> dict[str, str]:
    """Digest of every experiment that a parameter names, so that a changed record is noticed."""
    texts = [v for v in points.fixed.values() if isinstance(v, str | PurePath)]
    for column in points.columns.values():
        if column.values.dtype.kind in "UO":
            texts += [v for v in column.values.tolist() if isinstance(v, str | PurePath)]
    folders = {str(t): Path(t) for t in texts if is_experiment(Path(t))}
    return {text: content_digest(folder) for text, folder in folders.items()}
