"""Which effects a record can show, which only if they are large, and which not at all, and why."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from itertools import combinations, zip_longest

import numpy as np

from ..base.finding import Finding
from ..base.sentences import percent, round_near, with_standard_error
from ..base.units import unit_after_number, unit_of
from ..check import CheckedRecording, RecordingCheck
from ..diagnose.candidates import Candidate, bodies_with_measured_force, candidates
from ..diagnose.criteria import CRITERIA
from ..diagnose.fit import Fit, estimate
from ..diagnose.noise_floor import noise_floor
from ..diagnose.repeats import Repeatability, repeatability
from ..diagnose.search_plan import EFFORTS
from ..effects import CONTACT_ROLES, SIGNALS, Effect
from ..measurement.motion import RARE
from ..measurement.prepare import Prepared
from ..model import Model
from ._motion import describe_motion, missing_excitation
from ._visibility import Visibility, visibilities

#: an effect that shows only with more than this part of the measured force shows "only if large"
LARGE = 0.1
#: two effects look alike if the cosine between their marks is at least this: only at seven times
#: the least visible size is their difference visible
ALIKE = 0.99
#: most letters in a row of effects: a terminal of 100 columns, less the margin of a finding
ROW = 88


def find_visible_effects(recording: CheckedRecording) -> Iterator[Finding]:
    """Findings on the motion of each body and the effects that it shows, from fit records."""
    model, prepared = recording.compared
    base = estimate(model, _drop_folds(prepared), effort=EFFORTS.rough)
    generator = np.random.default_rng(recording.seed)
    floor = noise_floor(base.model, prepared, generator, use="fit").value
    motions = [s.motion for s in prepared.of("fit")]
    measured = bodies_with_measured_force(prepared.experiment)
    judged = candidates(base.model, motions, measured=measured)
    every = [c for c in candidates(base.model, measured=measured) if c not in judged]
    visible_effects = visibilities(base, prepared, judged, floor)
    for place in base.model.places:
        body = base.model.holder(place)
        body_motions = [m for m in motions if m.body == body]
        if not body_motions:
            continue
        poor = missing_excitation(body_motions, base.model, body)
        if place == body:
            yield describe_motion(body_motions, place, poor, base.model.body(place).axis)
            yield from _open_parameters(base, place)
        never = [c for c in every if c.at == place]
        mine = [v for v in visible_effects if v.candidate.at == place]
        if mine or never:
            yield _summary(mine, never, poor, base, floor, place)
            yield from _look_alikes(mine, place)
    if (repeats := repeatability(base.model, prepared)) is not None:
        yield _describe_passes(repeats)


CHECK = RecordingCheck(
    order=30,
    find=find_visible_effects,
    unless=dict.fromkeys(
        ("work", "signs", "units", "swapped columns"), "make signs, units and columns agree"
    ),
)


def _describe_passes(repeats: Repeatability) -> Finding:
    """A finding on what no model can explain, because it differs over the same motion."""
    return Finding(
        "what repeats",
        "fine",
        f"a motion is made again in {100 * repeats.share:.0f} % of the rows. There "
        f"{percent(repeats.error, '.2g')} of the force differs from pass to pass, which no model "
        f"of the motion explains; your model leaves {percent(repeats.left, '.2g')}.",
        asdict(repeats),
    )


def _drop_folds(prepared: Prepared) -> Prepared:
    """Records with check records; without these the fit records, to save held-out blocks."""
    if prepared.of("check"):
        return prepared
    again = tuple(replace(s, use="check") for s in prepared.of("fit"))
    return replace(prepared, stretches=(*prepared.stretches, *again))


def _summary(
    visible_effects: Sequence[Visibility],
    never: Sequence[Candidate],
    poor: Mapping[str, str],
    base: Fit,
    floor: float,
    place: str,
) -> Finding:
    """A finding with the effects that the records can show, only if large, or not, with reasons."""
    # to six digits: two that are the same force stay in the order of the catalogue, on any machine
    in_order = sorted(visible_effects, key=lambda v: round_near(v.size, digits=6))
    shown = [v for v in in_order if v.size <= LARGE]
    large = [v for v in in_order if LARGE < v.size <= 1.0]
    hidden = [v for v in visible_effects if v.size > 1.0]
    numbers = {v.candidate.effect.name: v.size for v in visible_effects}
    numbers |= {c.effect.name: math.inf for c in never} | {"noise_floor": floor}
    reasons: dict[str, list[str]] = {}
    for v in hidden:
        reasons.setdefault(_reason(v, poor, base.model), []).append(v.candidate.effect.name)
    for c in never:
        reasons.setdefault(
            poor.get("position", "the model has no place for such an effect"), []
        ).append(c.effect.name)
    parts = []
    if shown:
        parts.append("can show\n" + _rows([_describe_smallest(v, base.model) for v in shown]))
    if large:
        parts.append(
            "only if large\n" + _rows([_describe_smallest(v, base.model, v.size) for v in large])
        )
    if reasons:
        text = "; ".join(f"{', '.join(names)} ({why})" for why, names in reasons.items())
        parts.append(f"cannot show {text}.")
    if waiting := _list_waiting_effects(base.model, place):
        parts.append(
            "not checked, because the model lacks the effect that they change: "
            + ", ".join(waiting)
            + "."
        )
    if base.fit_error > CRITERIA.adequate * floor:
        parts.append(_describe_floor(base.fit_error, floor))
    return Finding(
        "what the record can show",
        "note" if hidden or never or large else "fine",
        "\n".join(p[0].upper() + p[1:] for p in parts),
        numbers,
        place,
    )


def _describe_floor(left: float, floor: float) -> str:
    """What the limits mean beside a part `left` of the force that the model leaves unexplained."""
    lacks = left > CRITERIA.countable * floor
    return (
        f"these limits hold above the noise floor, {percent(floor, '.2g')} of the force"
        f"{', which contains no noise of the force: state `noise` at the channel' * lacks}; "
        f"{percent(left, '.2g')} of the force is unexplained, and small effects may be hidden in "
        "this part."
    )


def _rows(items: Sequence[str]) -> str:
    """Items in two columns, or in one where they are long; each row is indented."""
    ended = [f"{item}," for item in items[:-1]] + [f"{item}." for item in items[-1:]]
    half = (len(ended) + 1) // 2
    left, right = ended[:half], ended[half:]
    width = max(map(len, left)) + 2
    if width + max(map(len, right), default=0) > ROW:
        return "\n".join(f"  {item}" for item in ended)
    pairs = zip_longest(left, right, fillvalue="")
    return "\n".join(f"  {a:<{width}}{b}".rstrip() for a, b in pairs)


def _list_waiting_effects(model: Model, place: str) -> list[str]:
    """Effects that need another effect which the model lacks."""
    body = model.body(place)
    return [
        f"{e.name} ({', '.join(body.lacks(e))})"
        for e in model.known.values()
        if not body.has(e.name)
        and (place in model.bodies) != (e.role in CONTACT_ROLES)
        and body.lacks(e)
    ]


def _describe_smallest(v: Visibility, model: Model, share: float | None = None) -> str:
    """An effect with its strength parameter, the least visible value, and the force there."""
    effect = v.candidate.effect
    name, value = next(iter(v.strength.items()))
    unit = unit_of(effect.parameters[name].quantity, model.body(v.candidate.at).axis)
    off = effect.absent[name]
    word, size = ("below", value) if math.isinf(off) else ("from", abs(value - off))
    number = f"{size:.2g}{'' if unit == '1' else ' ' + unit}"
    force = "" if share is None else f", {percent(share, '.2g')} of the force"
    return f"{effect.name} ({name} {word} {number}{force})"


def _reason(v: Visibility, poor: Mapping[str, str], model: Model) -> str:
    """Why an effect is invisible: its numbers, and the signals that the motion lacks."""
    signals = list(_needed_signals(v.candidate.effect))
    if v.silent:
        why = "no force in this motion"
    elif v.unique_share < RARE and v.imitated:
        imitated = [n.partition(".")[2] for n in v.imitated]
        why = "same force as " + " with ".join(imitated)
        body = model.body(v.candidate.at)
        for effect in body.effects:
            if any(n.startswith(f"{effect.name}.") for n in imitated):
                signals += _needed_signals(effect)
    elif math.isinf(v.size):
        why = "below the noise"
    else:
        why = f"visible only from {100 * v.size:.0f} % of the force"
    facts = dict.fromkeys(poor[s] for s in signals if s in poor)
    return ": ".join([why, "; ".join(facts)] if facts else [why])


def _needed_signals(effect: Effect) -> tuple[str, ...]:
    """Signals that an effect's law and hidden states depend on.

    Friction always depends on the velocity. An effect of the actuation shows where another force
    acts that does not pass the actuator.
    """
    laws = [effect.expression(), *effect.rates().values()]
    names = [n for n, s in SIGNALS.items() if any(law.has(s) for law in laws)]
    follows = effect.role.startswith("friction") or "direction" in names
    more = ["velocity"] if follows else ["interaction_force"] * (effect.role == "actuation")
    return tuple(dict.fromkeys([*more, *names]))


def _look_alikes(visible_effects: Sequence[Visibility], place: str) -> Iterator[Finding]:
    """Effects whose changes of the residual have the same shape on these records."""
    visible = [v for v in visible_effects if v.size <= 1.0]
    groups: list[set[str]] = []
    for a, b in combinations(visible, 2):
        if abs(float(a.mark @ b.mark)) < ALIKE:
            continue
        pair = {a.candidate.effect.name, b.candidate.effect.name}
        touching = [g for g in groups if g & pair]
        groups = [g for g in groups if not g & pair] + [pair.union(*touching)]
    if groups:
        text = "; ".join(" and ".join(sorted(g)) for g in groups)
        sentence = f"these effects look alike on the records, unless they are large: {text}."
        yield Finding("look-alikes", "note", sentence, {"groups": float(len(groups))}, place)


def _open_parameters(base: Fit, place: str) -> Iterator[Finding]:
    """Parameters of the user's model that the record does not determine."""
    model = base.model
    free = {n: model.parameters[n] for n in base.free if model.locate(n)[0] == place}
    errors = {n: v.stderr for n, v in free.items() if not v.stderr < abs(v.value)}
    if errors:
        text = ", ".join(
            f"{n} ({with_standard_error(free[n].value, error)}{unit_after_number(model.unit(n))})"
            for n, error in errors.items()
        )
        sentence = f"the record does not determine {text}: fix the values that are known."
        yield Finding("own parameters", "note", sentence, errors, place)
