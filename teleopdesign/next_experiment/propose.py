"""Find the motion that best separates the models that a diagnosis leaves open.

A proposal is tested with each rival in turn as the truth: the simulated records are diagnosed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.errors import ExperimentError, ModelError, unknown
from ..base.shown import Shown
from ..base.units import si_factor
from ..diagnose.diagnosis import Diagnosis
from ..diagnose.ladder import find_missing
from ..diagnose.noise_floor import sensors_of
from ..measurement.experiment import Experiment
from .family import PathPart, Setting, Show, family
from .limits import Limits, course_of, shown_limits
from .path import servo_of
from .prediction import find_least_determined, predict, run_twice, with_records
from .proposal import Proposal, Reference
from .remedies import Remedy, remedies, setups
from .rivals import Rival, depends_on_time, floor_force, pairs, present_separation, rivals_of
from .search import SafeParts, compose, join_paths, try_parts
from .synthesis import Bench, plan_motion

#: s: default of the longest duration of a proposal, and its shortest duration: a short one is
#: repeated, so that chance counts less
LONGEST, SHORTEST = 20.0, 10.0
#: duration of a repeated run, s, and over the longest record, where an effect depends on time: a
#: warm-up shows if a record lasts several of its time constants
REPEATED, TIMES = 60.0, 3.0
#: most pairs of models for which remedies are simulated
PAIRS = 2


def propose(
    diagnosis: Diagnosis,
    *,
    duration: float = LONGEST,
    limits: Mapping[str, Limits] | None = None,
    progress: Callable[[str], None] | None = None,
    seed: int = 0,
) -> Proposal:
    """The motion that best separates the models that a diagnosis leaves open.

    duration: s, longest motion (a warm-up is added to it)
    limits: body -> limits to keep; None: those that the records have shown to be safe
    progress: called with a line of text at each step;  seed: of the sensors' errors
    raises ModelError: limits of a body that is not in the experiment

        >>> proposal = td.propose_experiment(td.load_answer("demo/answer.json"))  # doctest: +SKIP
        >>> proposal.plot()  # doctest: +SKIP
    """
    _refuse_curve(diagnosis)
    say = progress or (lambda _: None)
    say("searching for effects that the records leave open")
    rivals = rivals_of(diagnosis)
    kept = _merge_limits(diagnosis, limits or {})
    bench = _bench(diagnosis, kept)
    without_motion = Proposal(diagnosis, rivals, None, (), (), (), {}, kept, bench)
    if not rivals:
        return without_motion
    setting = _make_setting(diagnosis, rivals, bench)
    parts = family(setting)
    say(f"simulating {len(parts)} motions")
    candidates = try_parts(
        parts, rivals, diagnosis.prepared, bench, kept, floor=bench.floor, seed=seed
    )
    if not candidates.parts:
        return without_motion
    chosen = compose(candidates, duration + setting.repeated, bench.sample_time)
    reference, path_parts = _reference([candidates.parts[k] for k in chosen], bench)
    plan = plan_motion(join_paths(path_parts), bench)
    present = {
        (i, j): present_separation(rivals[i], rivals[j], diagnosis.prepared, diagnosis.floor.value)
        for i, j in pairs(rivals)
    }
    predictions = []
    for i, rival in enumerate(rivals):
        say(f"predicting records with {rival} as the true effect")
        predictions.append(predict(i, rivals, plan, bench, present, seed=seed + 1))
    proposal = Proposal(
        diagnosis=diagnosis,
        rivals=rivals,
        reference=reference,
        separations=tuple(s for p in predictions for s in p.separations),
        determined=find_least_determined([d for p in predictions for d in p.determined]),
        curves=tuple(c for p in predictions for c in p.curves),
        remedies={},
        limits=kept,
        bench=bench,
        plan=plan,
    )
    say("simulating changes of the set-up")
    return replace(proposal, remedies=_remedies(proposal, candidates, setting, seed))


def _refuse_curve(diagnosis: Diagnosis) -> None:
    if diagnosis.kind:
        raise ExperimentError(
            "next: a friction curve has no time: points that are missing, such as slower runs, are "
            "listed by `teleopdesign check`"
        )


def _merge_limits(diagnosis: Diagnosis, stated: Mapping[str, Limits]) -> dict[str, Limits]:
    shown = shown_limits(diagnosis.prepared)
    for body in stated:
        if body not in shown:
            raise ModelError(f"limits: {unknown('body', body, shown)}")
    return {**shown, **stated}


def _bench(diagnosis: Diagnosis, limits: Mapping[str, Limits]) -> Bench:
    experiment = diagnosis.experiment
    return Bench(
        experiment=experiment,
        bandwidth=diagnosis.prepared.bandwidth,
        sample_time=experiment.fit_records[0].sample_time,
        sensors=sensors_of(experiment),
        course=course_of(limits, diagnosis.prepared),
        floor=floor_force(diagnosis.prepared, diagnosis.floor.value),
        servos={b: servo_of(diagnosis.model, diagnosis.prepared.stretches, b) for b in limits},
    )


def _make_setting(diagnosis: Diagnosis, rivals: Sequence[Rival], bench: Bench) -> Setting:
    stretches = diagnosis.prepared.stretches
    gain = bench.course.gain
    longest = max(r.duration for r in diagnosis.experiment.records)
    return Setting(
        limits=bench.course.limits,
        step=max(s.motion.step / abs(gain[s.motion.body]) for s in stretches),
        bandwidth=bench.bandwidth,
        sample_time=bench.sample_time,
        show=shows(diagnosis.experiment),
        repeated=max(REPEATED, TIMES * longest) if depends_on_time(rivals) else 0.0,
    )


def shows(experiment: Experiment) -> Show:
    """A function that writes values of the first body in the units of its position channel."""
    body = next(iter(experiment.bodies))
    unit = experiment.channels[f"{body}.position"].unit
    factor = si_factor(unit, quantity="position", axis=experiment.axis(body))
    units = {"position": (factor, unit), "velocity": (factor, f"{unit}/s")}

    def show(value: float, quantity: str) -> str:
        scale, name = units.get(quantity, (1.0, {"frequency": "Hz", "time": "s"}.get(quantity, "")))
        return f"{value / scale:.3g} {name}"

    return show


def _reference(parts: Sequence[PathPart], bench: Bench) -> tuple[Reference, list[PathPart]]:
    """The motion of these parts, repeated until it is long enough, and the parts in order."""
    once = sum(len(p.path) for p in parts) * bench.sample_time
    repeats = max(1, int(np.ceil(SHORTEST / once)))
    whole = list(parts) * repeats
    path = join_paths(whole)
    course = bench.course
    return (
        Reference(
            time=np.asarray(bench.sample_time * np.arange(len(path), dtype=np.float64)),
            position={b: course.middle[b] + g * path for b, g in course.gain.items()},
            parts=tuple(p.sentence for p in parts),
            repeats=repeats,
        ),
        whole,
    )


def _remedies(
    proposal: Proposal, candidates: SafeParts, setting: Setting, seed: int
) -> dict[tuple[int, int], tuple[Remedy, ...]]:
    """The remedies for the first pairs that the motion does not separate."""
    diagnosis, bench = proposal.diagnosis, proposal.bench
    inertia = {b: body.parameters["inertia"].value for b, body in diagnosis.model.bodies.items()}
    others = {}
    for i, j in [p for p in proposal.pairs if not proposal.decides(p)][:PAIRS]:
        a, b = proposal.rivals[i], proposal.rivals[j]
        places = list(dict.fromkeys((a.candidate.at, b.candidate.at)))
        changed = setups(places, diagnosis.prepared, bench, setting, proposal.limits, inertia)
        others[i, j] = remedies(
            (a, b),
            diagnosis.prepared,
            tuple(changed),
            candidates.sums.get((i, j)),
            candidates.sums.get((j, i)),
            seed=seed,
        )
    return others


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
