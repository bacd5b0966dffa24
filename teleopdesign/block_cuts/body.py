"""The cut of a body: a one-body experiment made of recorded signals, diagnosed like any other.

    Z_M L = R_A - R_M            a body that moves: command and loads as recorded
    Z_H L = R_M + R_V            a body that is held: the force at its cut, and what acts beside

Its forces, thresholds, candidates and probabilities are those of `diagnose`; nothing is computed
here. Where the command is not recorded, the one that the computer's laws give takes its place.
Forces between bodies are taken at half of the step that the command puts into them (`half_steps`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..base.errors import ExperimentError, ModelError
from ..base.toml import Table
from ..base.units import unit_of
from ..blocks import Body
from ..diagnose import Diagnosis
from ..diagnose import find_missing as find_missing_in_body
from ..diagrams import Attached, Diagram, Moving
from ..effects import EFFECTS, Effect
from ..measurement.channel import Channel, LogLayout, channels_from
from ..measurement.description import BodyDescription
from ..measurement.experiment import Experiment
from ..measurement.record import RecordEntry, record_of
from ..measurement.tables import LogColumns
from ..model import Model
from .computer import Placed
from .cuts import OF_A_HAND, Cut
from .diagram_experiment import DiagramExperiment, RecordedLog
from .half_steps import command_of, force_at_half_step, share_of_step


@dataclass(frozen=True)
class ForcesOnBody:
    """Signals that act on a body, each with its weight: along its motion, N or N m.

    command: held between rows;  others: read at the rows
    """

    motion: str
    command: tuple[str, float]
    others: tuple[tuple[str, float], ...]
    held: bool  # something holds the motion: a hand, whose rest position differs by record


def forces_on(diagram: Diagram, cut: Cut) -> ForcesOnBody:
    """The recorded forces that act on the body of a cut.

    raises ModelError: more forces than an experiment of one body holds
    """
    block = diagram.block(cut.name)
    if isinstance(block, Moving):
        loads: dict[str, float] = {}
        for signal, weight in block.loads.items():
            _add_up(loads, _known_terms(diagram, signal, float(weight), cut))
        held = len(_bodies(diagram, cut)) > 1
        return ForcesOnBody(block.motion, (block.command, 1.0), tuple(loads.items()), held)
    assert isinstance(block, Attached)
    # signal = w force + others, force = sign Z motion
    junction = next((j for j in diagram.junctions if j.output == cut.signal), None)
    weights = {block.force: 1.0} if junction is None else dict(junction.terms)
    if block.force not in weights:
        raise ModelError(f"{cut.name}: {cut.signal} is no sum with its force, {block.force}")
    weight = float(weights.pop(block.force)) * block.sign
    others = tuple((s, -float(w) / weight) for s, w in weights.items() if s in cut.inputs)
    return ForcesOnBody(block.motion, (cut.signal, 1.0 / weight), others, True)


def _known_terms(diagram: Diagram, signal: str, weight: float, cut: Cut) -> dict[str, float]:
    """A force as a sum of recorded ones; a body that holds the motion is none of them."""
    if signal in cut.inputs:
        return {signal: weight}
    terms: dict[str, float] = {}
    junction = next((j for j in diagram.junctions if j.output == signal), None)
    for name, w in () if junction is None else junction.terms.items():
        _add_up(terms, _known_terms(diagram, name, weight * float(w), cut))
    return terms


def _add_up(terms: dict[str, float], more: Mapping[str, float]) -> None:
    """Add weights to those of the same signals."""
    for name, weight in more.items():
        terms[name] = terms.get(name, 0.0) + weight


def body_experiment(
    experiment: DiagramExperiment, cut: Cut, placed: Sequence[Placed] = ()
) -> Experiment:
    """The experiment of one body that a cut is, under the name of its block.

    placed: effects in the laws of a command that is not recorded
    raises ExperimentError, ModelError: a channel cannot be read as one of a body
    """
    terms, name = forces_on(experiment.diagram, cut), cut.name
    if len(terms.others) > 1 or any(abs(w) != 1.0 for _, w in (terms.command, *terms.others)):
        raise ModelError(f"{name}: several forces or levers act on it: only a sum of two is read")
    body = _joined_body(experiment.diagram, cut)
    described = {name: BodyDescription(name, body.axis, None, {}, f"diagram.{name}")}
    content: dict[str, Any] = {f"{name}.position": experiment.channels[terms.motion].content}
    command = terms.command[0]
    entry: dict[str, Any] = {"column": f"predicted {command}", "unit": unit_of("force", body.axis)}
    if command in experiment.channels:
        entry = _force(experiment, terms.command, measured=command == cut.signal)
    content[f"{name}.actuator_force"] = entry
    for other in terms.others:
        content[f"{name}.interaction_force"] = _force(experiment, other)
    if experiment.sample_rate is None:
        content["time"] = experiment.channels["time"].content
    table = next(iter(experiment.channels.values()))
    channels = channels_from(Table(content, table.file, "channels"), described)
    force, beside = f"{name}.actuator_force", f"{name}.interaction_force"
    one_pass = experiment.computer.one_pass
    channels[force] = replace(channels[force], one_pass=one_pass)
    # the error of a hand is relative to its cut, that of a body to what was recorded
    if beside in channels and command == cut.signal:
        channels[beside] = replace(channels[beside], beside=True)
    elif beside in channels and command not in experiment.channels:
        channels[force] = replace(channels[force], beside=True)
    # the rest position of a hand is free in each record
    rest = frozenset({"position_zero"}) if terms.held else frozenset()
    _count_last_digits(experiment, terms, channels, name)
    layout = LogLayout(channels, described, experiment.sample_rate)
    records = tuple(
        record_of(
            _columns(experiment, name, log, placed),
            f"{experiment.folder.name}/{log.file}",
            RecordEntry(log.file, log.use, log.offset_names | rest),
            layout,
        )
        for log in experiment.logs
    )
    return Experiment(
        experiment.folder,
        f"{experiment.title}: {name}",
        described,
        None,
        channels,
        experiment.bandwidth,
        records,
    )


def _count_last_digits(
    experiment: DiagramExperiment, terms: ForcesOnBody, channels: dict[str, Channel], body: str
) -> None:
    """Steps of forces are at least the last digit of their columns, where a noise is stated."""
    both = ("actuator_force", "interaction_force")
    signals = dict(zip(both, (terms.command, *terms.others), strict=False))
    for quantity, (signal, _) in signals.items():
        one = channels[f"{body}.{quantity}"]
        if signal in experiment.channels and one.noise is not None:
            digit = max(experiment.digit(signal, log) for log in experiment.logs)
            step = max(digit, one.resolution or 0.0)
            channels[f"{body}.{quantity}"] = replace(one, resolution=step or None)


def diagnose_body(
    experiment: DiagramExperiment,
    cut: Cut,
    *,
    known: Mapping[str, Effect] = EFFECTS,
    placed: Sequence[Placed] = (),
    report: Callable[[str], None],
    **options: Any,
) -> Diagnosis:
    """The diagnosis of the body of a cut.

    known: effects by name;  options: those of `diagnose.find_missing`
    placed: effects in the laws of a command that is not recorded
    """
    model = model_of_body(experiment.diagram, cut, known)
    if isinstance(experiment.diagram.block(cut.name), Attached):
        among = options.pop("among", None)
        names = known if among is None else among
        options["among"] = [n for n in names if known[n].role in OF_A_HAND]
    diagnosis = find_missing_in_body(
        body_experiment(experiment, cut, placed),
        model,
        progress=lambda line: report(f"{cut.name}: {line}"),
        **options,
    )
    return replace(diagnosis, left_out=())


def model_of_body(diagram: Diagram, cut: Cut, known: Mapping[str, Effect] = EFFECTS) -> Model:
    """The model of the body of a cut, as the diagram states it."""
    return Model({cut.name: _joined_body(diagram, cut)}, known)


def _bodies(diagram: Diagram, cut: Cut) -> list[Body]:
    """The bodies of a cut, the one that gives it its name first."""
    names = sorted(cut.blocks, key=lambda name: name != cut.name)
    contents = [getattr(diagram.block(n), "body", None) for n in names if diagram.has(n)]
    return [body for body in contents if isinstance(body, Body)]


def _joined_body(diagram: Diagram, cut: Cut) -> Body:
    """The body of a cut; of bodies that move together their sum, as a start of its estimation."""
    whole, *others = _bodies(diagram, cut)
    for body in others:
        values = {"inertia": _value(whole, "inertia") + _value(body, "inertia")}
        for effect in body.effects:
            here = {n: _value(body, f"{effect.name}.{n}") for n in effect.parameters}
            if not whole.has(effect.name):
                whole = whole.with_effect(effect, here)
                continue
            names = {f"{effect.name}.{n}": v for n, v in here.items()}
            values |= {n: _value(whole, n) + v for n, v in names.items()}
        whole = whole.with_values(values)
    return whole


def _value(body: Body, name: str) -> float:
    return body.parameters[name].value


def _columns(
    experiment: DiagramExperiment, moving: str, log: RecordedLog, placed: Sequence[Placed]
) -> LogColumns:
    """The columns of a log, with forces at half of their steps and a predicted command."""
    half = {
        f"{name} at half of its step": force_at_half_step(experiment, name, log, placed)
        for name in experiment.recorded
        if share_of_step(experiment, name) is not None
    }
    block = experiment.diagram.block(moving)
    if isinstance(block, Moving) and block.command not in experiment.channels:
        half[f"predicted {block.command}"] = command_of(experiment, block, log, placed)
    return replace(log.columns, values={**log.columns.values, **half})


def _force(
    experiment: DiagramExperiment, term: tuple[str, float], *, measured: bool = False
) -> dict[str, Any]:
    """The table of a force's channel, with the sign with which it acts along the motion."""
    signal, weight = term
    if signal not in experiment.channels:
        raise ExperimentError(f"{experiment.title}: {signal} is not recorded")
    content = dict(experiment.channels[signal].content)
    if share_of_step(experiment, signal) is not None:
        channel, unit = experiment.channel[signal], unit_of("force", experiment.axis(signal))
        sensor = {"resolution": channel.resolution, "noise": channel.noise}
        content = {"column": f"{signal} at half of its step", "unit": unit}
        content |= {key: value for key, value in sensor.items() if value is not None}
    content["sign"] = content.get("sign", 1) * (1 if weight > 0 else -1)
    return content | ({"measured": True} if measured else {})
