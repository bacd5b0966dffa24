"""Plausible parameters: whether a fitted effect deserves its name, by the rules in its file.

One rule holds for every force, also for a user's effects: a force of the position cannot be told
where a controller computes the command from the position.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial
from types import SimpleNamespace
from typing import Any

import numpy as np

from ..base.errors import ModelError
from ..blocks import Body
from ..check.computed_command import describe_computed
from ..effects import CONTACT_ROLES, SIGNALS, Effect, RecordFacts
from ..measurement.experiment import Experiment
from ..measurement.motion import Motion
from ..measurement.prepare import Prepared, Stretch
from ..measurement.repeated_rows import runs_of
from ..measurement.reversals import count_reversals
from ..model import Model
from ..realise.along_motion import friction_level_along


def implausible_effects(model: Model, prepared: Prepared) -> dict[tuple[str, str], str]:
    """(effect, place) -> a sentence on what the effect stands for, where its name is implausible.

    raises ModelError: the check in an effect's file fails, or returns neither None nor a sentence
    """
    meanings = {}
    for place, body in model.bodies.items():
        effects = [
            e
            for e in body.effects
            if e.role not in CONTACT_ROLES and (e.name, place) not in model.absent
        ]
        if not effects:
            continue
        numbers = {n: v.value for n, v in body.parameters.items()}
        facts = record_facts(model, place, prepared, numbers)
        for effect in effects:
            reason = _ask_effect(effect, "plausible", facts)
            if reason is None:
                reason = _explain_computed(effect, prepared.experiment, place)
            if reason is not None:
                meanings[effect.name, place] = reason
    return meanings


def undetermined_of(effect: Effect, at: str, model: Model, prepared: Prepared) -> str | None:
    """A sentence of an effect's file on parameters that these records do not determine; None: none.

    raises ModelError: as `implausible_effects`
    """
    place = model.holder(at)
    return _ask_effect(effect, "undetermined", record_facts(model, place, prepared))


@lru_cache(maxsize=256)
def is_of_place(effect: Effect) -> bool:
    """Whether an effect is a force that depends on the position at most."""
    signals = effect.expression().free_symbols & set(SIGNALS.values())
    return effect.role == "force" and not effect.states and signals <= {SIGNALS["position"]}


def _explain_computed(effect: Effect, experiment: Experiment, body: str) -> str | None:
    """A sentence where an effect only repeats the law of a controller; else None."""
    if not is_of_place(effect) or not (computed := describe_computed(experiment, body)):
        return None
    return f"the command is {computed}; a controller computes it, and the effect repeats this law"


def _force_of_motion(inertia: float, stretches: Sequence[Stretch]) -> float:
    """Largest sum of inertial force and force of an arm's links along the motion (N, N m)."""
    needed = 0.0
    for s in stretches:
        carried = 0.0 if s.motion.carried is None else np.abs(s.motion.carried[s.keep]).max()
        needed = max(needed, abs(inertia) * np.abs(s.motion.acceleration[s.keep]).max() + carried)
    return float(needed)


def _ask_effect(effect: Effect, hook: str, facts: RecordFacts) -> str | None:
    """The sentence of the effect's `plausible` or `undetermined`; None where it has none.

    hook: "plausible" or "undetermined"
    raises ModelError: it fails, or returns neither None nor a sentence
    """
    check: Callable[[Any, RecordFacts], str | None] | None = getattr(effect, hook)
    if check is None:
        return None
    values = {n: facts.body[f"{effect.name}.{n}"] for n in effect.parameters}
    try:
        reason = check(SimpleNamespace(**values), facts)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise ModelError(f"{effect.name}: {hook}: {type(error).__name__}: {error}") from error
    if reason is not None and not (isinstance(reason, str) and reason.strip()):
        raise ModelError(f"{effect.name}: {hook}: found {reason!r}, expected None or a sentence")
    return reason


def record_facts(
    model: Model, place: str, prepared: Prepared, numbers: Mapping[str, float] | None = None
) -> RecordFacts:
    """Facts of all records about the body at that place.

    numbers: parameters of the body by name; None: those of the model
    """
    stretches = [s for s in prepared.stretches if s.motion.body == place]
    motions = [s.motion for s in stretches]
    body = model.bodies[place]
    if numbers is None:
        numbers = {n: v.value for n, v in body.parameters.items()}
    measured = [np.abs(s.motion.command + s.motion.interaction).max() for s in stretches]
    speed = max(float(np.abs(s.motion.velocity[s.keep]).max()) for s in stretches)
    return RecordFacts(
        axis=body.axis,
        travel=max(float(np.ptp(x)) for x in _comparable_positions(stretches)),
        sweep=max(float(np.ptp(m.position)) for m in motions),
        step=min(float(s.motion.step) for s in stretches),
        stroke=_stroke(stretches),
        reversals=sum(count_reversals(s.motion.direction) for s in stretches),
        force=float(max(measured)),
        acting=float(max(measured)) + _force_of_motion(numbers["inertia"], stretches),
        speed=speed,
        film=_film(body, speed, numbers),
        levels=partial(_sliding_levels, body, motions),
        body=numbers,
        duration=max(float(np.ptp(m.time)) for m in motions),
        stuck=max(_longest_hold(m, numbers.get("coulomb.level", 0.0)) for m in motions),
        resolved=0.5 / prepared.bandwidth,
        places=np.concatenate([m.position[m.direction != 0] for m in motions]),
        speeds=np.concatenate([m.velocity[m.direction != 0] for m in motions]),
    )


def _sliding_levels(body: Body, motions: Sequence[Motion]) -> np.ndarray:
    """Friction levels (n,) where a body slides, whatever effects make them."""
    return np.concatenate([friction_level_along(body, m)[m.direction != 0] for m in motions])


def _longest_hold(motion: Motion, level: float) -> float:
    """Longest time (s) in which a force above a level acts and no direction of motion is sure."""
    held = (motion.direction == 0) & (np.abs(motion.command + motion.interaction) > level)
    first, past = runs_of(held)
    return float(np.max(past - first, initial=0)) * motion.sample_time


def _film(body: Body, speed: float, numbers: Mapping[str, float]) -> float:
    """Friction at a speed (SI) by those effects of a body that depend on the velocity alone."""
    at = {s: numbers[n] for n, s in body.symbols().items()} | {SIGNALS["velocity"]: speed}
    signals = set(SIGNALS.values())
    laws = (
        e.expression()
        for e in body.effects
        if e.role == "force" and e.energy == "dissipates" and not e.states
    )
    of_speed = (law for law in laws if law.free_symbols & signals == {SIGNALS["velocity"]})
    return sum(float(law.subs({s: at[s] for s in law.free_symbols})) for law in of_speed)


def _comparable_positions(stretches: Sequence[Stretch]) -> list[np.ndarray]:
    """Positions of all records together; a record with a separate encoder zero stands alone."""
    groups: dict[str, list[np.ndarray]] = {}
    for s in stretches:
        groups.setdefault(s.motion.file if s.has_zero_offset else "", []).append(s.motion.position)
    return [np.concatenate(positions) for positions in groups.values()]


def _stroke(stretches: Sequence[Stretch]) -> float:
    """Mean time of motion one way (s), over all stretches; inf where there is one direction."""
    moving, runs, ways = 0.0, 0, set()
    for s in stretches:
        directions = s.motion.direction[s.motion.direction != 0]
        if not len(directions):
            continue
        moving += len(directions) * s.motion.sample_time
        runs += 1 + count_reversals(s.motion.direction)
        ways |= set(directions.tolist())
    return moving / runs if len(ways) > 1 else float("inf")
