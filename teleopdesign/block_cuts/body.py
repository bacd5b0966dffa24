"""The cut of a body: a one-body experiment made of recorded signals, diagnosed like any other.

    Z_M L = R_A - R_M            a body that moves: command and loads as recorded
    Z_H L = R_M + R_V            a body that is held: the force at its cut, and what acts beside

Its forces, thresholds, candidates and probabilities are those of `diagnose`; nothing is computed
here. Where the command is not recorded, the one that the computer's laws give takes its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ..base.errors import ExperimentError, ModelError
from ..base.toml import Table
from ..blocks import Body
from ..diagnose import Diagnosis
from ..diagnose import find_missing as find_missing_in_body
from ..diagrams import Attached, Diagram, Moving
from ..effects import EFFECTS, Effect
from ..measurement.channel import channels_from
from ..measurement.description import BodyDescription
from ..measurement.experiment import Experiment
from ..measurement.record import record_of
from ..model import Model
from .cuts import Cut
from .diagram_experiment import DiagramExperiment

#: roles of effects that a body has which no actuator of its own moves: those of its force
_OF_A_HAND = ("force", "friction_level", "friction_shape", "friction_factor")


@dataclass(frozen=True)
class ForcesOnBody:
    """Signals that act on a body, each with its weight: along its motion, N or N m.

    command: held between rows;  others: read at the rows
    """

    motion: str
    command: tuple[str, float]
    others: tuple[tuple[str, float], ...]
    held: bool


def forces_on(diagram: Diagram, cut: Cut) -> ForcesOnBody:
    """The recorded forces that act on the body of a cut.

    raises ModelError: more forces than an experiment of one body holds
    """
    block = diagram.block(cut.name)
    if isinstance(block, Moving):
        loads = {s: float(w) for s, w in block.loads.items()}
        others = tuple((s, w) for s, w in loads.items() if s in cut.inputs)
        return ForcesOnBody(block.motion, (block.command, 1.0), others, False)
    assert isinstance(block, Attached)
    # signal = w force + others, force = sign Z motion
    junction = next((j for j in diagram.junctions if j.output == cut.signal), None)
    weights = {block.force: 1.0} if junction is None else dict(junction.terms)
    weight = float(weights.pop(block.force)) * block.sign
    others = tuple((s, -float(w) / weight) for s, w in weights.items() if s in cut.inputs)
    return ForcesOnBody(block.motion, (cut.signal, 1.0 / weight), others, True)


def body_experiment(experiment: DiagramExperiment, cut: Cut) -> Experiment:
    """The experiment of one body that a cut is, under the name of its block.

    raises ExperimentError, ModelError: a channel cannot be read as one of a body
    """
    terms, name = forces_on(experiment.diagram, cut), cut.name
    if len(terms.others) > 1 or any(abs(w) != 1.0 for _, w in (terms.command, *terms.others)):
        raise ModelError(f"{name}: several forces or levers act on it: only a sum of two is read")
    body = _body(experiment.diagram, name)
    described = {name: BodyDescription(name, body.axis, None, {}, f"diagram.{name}")}
    content: dict[str, Any] = {f"{name}.position": experiment.channels[terms.motion].content}
    content[f"{name}.actuator_force"] = _force(experiment, terms.command, measured=terms.held)
    for other in terms.others:
        content[f"{name}.interaction_force"] = _force(experiment, other)
    if experiment.sample_rate is None:
        content["time"] = experiment.channels["time"].content
    table = next(iter(experiment.channels.values()))
    channels = channels_from(Table(content, table.file, "channels"), described)
    # the rest position of a hand is free in each record
    rest = frozenset({"position_zero"}) if terms.held else frozenset()
    records = tuple(
        record_of(
            log.columns,
            f"{experiment.folder.name}/{log.file}",
            file=log.file,
            use=log.use,
            offset_names=log.offset_names | rest,
            channels=channels,
            bodies=described,
            sample_rate=experiment.sample_rate,
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


def diagnose_body(
    experiment: DiagramExperiment,
    cut: Cut,
    *,
    known: Mapping[str, Effect] = EFFECTS,
    report: Callable[[str], None],
    **options: Any,
) -> Diagnosis:
    """The diagnosis of the body of a cut.

    known: effects by name;  options: those of `diagnose.find_missing`
    """
    model = Model({cut.name: _body(experiment.diagram, cut.name)}, known)
    if forces_on(experiment.diagram, cut).held:
        among = options.pop("among", None)
        names = known if among is None else among
        options["among"] = [n for n in names if known[n].role in _OF_A_HAND]
    diagnosis = find_missing_in_body(
        body_experiment(experiment, cut),
        model,
        progress=lambda line: report(f"{cut.name}: {line}"),
        **options,
    )
    return replace(diagnosis, left_out=())


def _body(diagram: Diagram, name: str) -> Body:
    body = getattr(diagram.block(name), "body", None)
    assert isinstance(body, Body)
    return body


def _force(
    experiment: DiagramExperiment, term: tuple[str, float], *, measured: bool = False
) -> dict[str, Any]:
    """The table of a force's channel, with the sign with which it acts along the motion."""
    signal, weight = term
    if signal not in experiment.channels:
        raise ExperimentError(f"{experiment.title}: {signal} is not recorded")
    content = dict(experiment.channels[signal].content)
    content["sign"] = content.get("sign", 1) * (1 if weight > 0 else -1)
    return content | ({"measured": True} if measured else {})
