"""Remedies where no motion separates two rivals: changes of the set-up, each one simulated.

The separation is computed again as if the limits were wider, a sensor finer, a mass of known
inertia attached, a pushing force measured, or a parameter known from elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.units import unit_of
from ..blocks.body import INERTIA
from ..diagnose.fit import fit_squares
from ..diagnose.least_squares import solve_normal
from ..diagnose.noise_floor import Sensor
from ..measurement.bandwidth import scales
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared
from .family import Setting, family
from .limits import Limits, course_of
from .rivals import Rival, Sums
from .search import try_parts
from .synthesis import Bench

#: factors of a remedy: a sensor that is finer by this, limits that are wider by this
FINER, WIDER = 10.0, 2.0
#: attached inertia over that of the body; pushing force over the rms force of the records
ATTACHED, PUSHING = 0.5, 0.5
#: noise of the sensor that measures a pushing force, over that force
SENSOR_NOISE = 0.01
#: a change is simulated on every third part of the family: neighbouring parts differ only in size
EVERY = 3


@dataclass(frozen=True)
class Remedy:
    """A change of the set-up, and the separation of a pair with this change (noise floors).

    change: a clause on the change
    separation: along the best part, for the truth that gives the smaller one
    """

    change: str
    separation: float


@dataclass(frozen=True)
class ChangedSetUp:
    """A set-up to simulate: the change in words, and the resulting bench, setting and limits."""

    change: str
    bench: Bench
    setting: Setting
    limits: Mapping[str, Limits]


def remedies(
    pair: tuple[Rival, Rival],
    prepared: Prepared,
    setups: Sequence[ChangedSetUp],
    along: Sums | None,
    back: Sums | None,
    *,
    seed: int,
) -> tuple[Remedy, ...]:
    """Every simulated change for a pair that no motion separates, best first.

    along, back: sums of the pair over the family, in both orders; None: not computed
    """
    rivals = [replace(r, question=0) for r in pair]
    listed = []
    for setup in setups:
        parts = family(setup.setting)[::EVERY]
        candidates = try_parts(
            parts, rivals, prepared, setup.bench, setup.limits, floor=setup.bench.floor, seed=seed
        )
        listed.append(Remedy(setup.change, candidates.best((0, 1)) if candidates.parts else 0.0))
    if along is not None and back is not None:
        listed += _remedies_by_knowledge(pair, along, back)
    return tuple(sorted(listed, key=lambda r: -r.separation))


def setups(
    places: Sequence[str],
    prepared: Prepared,
    bench: Bench,
    setting: Setting,
    limits: Mapping[str, Limits],
    inertia: Mapping[str, float],
) -> Iterator[ChangedSetUp]:
    """The set-ups to simulate; places: bodies of the rivals' effects."""
    wide = {b: limit.widen(WIDER) for b, limit in limits.items()}
    course = course_of(wide, prepared)
    yield ChangedSetUp(
        f"the stroke, speed, acceleration and force may be {WIDER:g} times larger",
        replace(bench, course=course),
        replace(setting, limits=course.limits),
        wide,
    )
    for place in places:
        yield _finer(place, bench, setting, limits)
        axis = bench.experiment.axis(place)
        mass = ATTACHED * inertia[place]
        interaction = f"{place}.interaction_force"
        yield ChangedSetUp(
            f"a known inertia of {mass:.2g} {unit_of(INERTIA.quantity, axis)} is attached to the "
            f"{place} for the new record",
            replace(
                bench,
                attached={place: mass},
                sensors={**bench.sensors, interaction: Sensor(0.0, 0.0)},
            ),
            setting,
            limits,
        )
        force = (
            PUSHING
            * scales(
                [s.motion for s in prepared.of("fit") if s.motion.body == place], prepared.bandwidth
            )["force"]
        )
        sensor = bench.sensors.get(interaction, Sensor(step=0.0, noise=SENSOR_NOISE * force))
        yield ChangedSetUp(
            f"a hand pushes the {place} with {force:.2g} {unit_of('force', axis)} (rms) and the "
            "force is measured",
            replace(bench, push={place: force}, sensors={**bench.sensors, interaction: sensor}),
            setting,
            limits,
        )


def _finer(
    place: str, bench: Bench, setting: Setting, limits: Mapping[str, Limits]
) -> ChangedSetUp:
    name = f"{place}.position"
    channel, sensor = bench.experiment.channels[name], bench.sensors[name]
    step = None if channel.resolution is None else channel.resolution / FINER
    channels = {**bench.experiment.channels, name: replace(channel, resolution=step)}
    return ChangedSetUp(
        f"the position sensor of the {place} is {FINER:g} times finer",
        replace(
            bench,
            experiment=replace(bench.experiment, channels=channels),
            sensors={**bench.sensors, name: Sensor(sensor.step / FINER, sensor.noise / FINER)},
            floor=0.0,  # the present records would be taken anew with it
        ),
        replace(setting, step=setting.step / FINER),
        limits,
    )


def _remedies_by_knowledge(pair: tuple[Rival, Rival], along: Sums, back: Sums) -> list[Remedy]:
    """Remedies by knowledge of each shared parameter, and of all of them, from another source."""
    places = {r.candidate.at for r in pair}
    here = [n for n in pair[0].fit.free if pair[0].model.locate(n)[0] in places]
    shared = [n for n in here if n in pair[1].fit.free]
    choices = [[n] for n in shared] + ([shared] if len(shared) > 1 else [])
    listed = []
    for names in choices:
        both = (
            _with_known(pair[0], pair[1], along, names),
            _with_known(pair[1], pair[0], back, names),
        )
        what = names[0] if len(names) == 1 else "every parameter that both models have"
        listed.append(Remedy(f"{what} is known from another source", min(both)))
    return listed


def _with_known(truth: Rival, other: Rival, sums: Sums, names: Sequence[str]) -> float:
    """Separation where some parameters of the other rival are held at the truth's values.

    The larger of two: along the best part, or on the present records alone.
    """
    held = np.array([n in names for n in other.fit.free])
    change = np.array(
        [
            truth.model.parameters[n].value - other.model.parameters[n].value if h else 0.0
            for n, h in zip(other.fit.free, held, strict=True)
        ]
    )
    best = 0.0
    for part in range(len(sums.squares)):
        step = _step(sums.present + sums.normal[part], sums.gradient[part], change, held)
        left = sums.squares[part] + 2 * sums.gradient[part] @ step
        left += step @ sums.normal[part] @ step
        best = max(best, float(np.sqrt(max(left, 0.0) / max(sums.noise[part], 1e-300))))
    step = _step(sums.present, np.zeros(len(held)), change, held)
    shown = float(step @ sums.present @ step) / max(fit_squares(truth.fit), 1e-300)
    return max(best, float(np.sqrt(max(shown, 0.0))))


def _step(normal: Array, gradient: Array, change: Array, held: Array) -> Array:
    """Least-squares step with the change of some parameters held."""
    step = change.copy()
    free = ~held.astype(bool)
    if free.any():
        rest = gradient[free] + normal[np.ix_(free, ~free)] @ change[~free]
        step[free] = -solve_normal(normal[np.ix_(free, free)], rest)
    return step
