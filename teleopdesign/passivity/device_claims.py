"""The claims that matter for one identified device and one compensator, and the margins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from ..blocks import Body, Value
from ..controllers import Controller, controller
from ..diagrams import haptic_interface
from ..effects import EFFECTS
from ..errors import ModelError
from ..simulate import Sampling
from .claims.claim import Claim, Evidence, Refutation, Unknown
from .identified import IdentifiedDevice, of_whole_device
from .rate_independent import Coulomb, Cycle, Dahl
from .search.by_simulation import SimulatedMotion, confirmed_motion, search_counterexample
from .search.stroke_motion import Strokes
from .theorems.friction_compensation import bounded_compensation, dahl_compensation
from .theorems.lugre import beside_bristle_damping, lugre_passivity
from .theorems.quantised_spring import quantised_spring
from .theorems.sampled_compensation import sampled_compensation
from .theorems.sampled_data import Z, sampled_passivity

#: N/m; gives a scale of length to friction that was identified as ideal
_RIGID = 1e5


@dataclass(frozen=True)
class Compensator:
    """law: "dahl" or "smoothed_coulomb";  level: N;  second: stiffness (N/m), or smoothing (m/s)"""

    law: str
    level: float
    second: float

    @property
    def controller(self) -> Controller:
        """The control law with these values."""
        name = "stiffness" if self.law == "dahl" else "smoothing_velocity"
        return controller(self.law, {"level": self.level, name: self.second})


@dataclass(frozen=True)
class Settled:
    """A claim in its topic; replayed: energy (J) that its motion gave out in simulation, NaN where
    none was replayed; motion: that simulated motion.
    """

    topic: str
    claim: Claim
    replayed: float = float("nan")
    motion: SimulatedMotion | None = None


@dataclass(frozen=True)
class Margin:
    """A number that a designer asks for, and what it is; value: SI, in `unit`."""

    text: str
    value: float
    unit: str

    def __str__(self) -> str:
        return f"{self.text}: {self.value:.4g} {self.unit}".rstrip()


def compensation_claims(
    device: IdentifiedDevice,
    compensator: Compensator,
    *,
    computer: Sampling | None = None,
    rng: np.random.Generator,
    tries: int = 15,
) -> list[Settled]:
    """Claims about friction compensation, for every level in the 95 % interval at once.

    computer: period, delay (whole periods) and encoder of the compensator; None: continuous
    """
    found = [_replayed(s) for s in friction_claims(device, compensator, computer=computer)]
    return [*found, _searched(device, compensator, computer, rng, tries)]


def friction_claims(
    device: IdentifiedDevice, compensator: Compensator, *, computer: Sampling | None = None
) -> list[Settled]:
    """What theorems say of a device's friction with a compensator; nothing is simulated.

    computer: as in `compensation_claims`
    """
    found: list[Settled] = []
    if device.presliding is None:  # which no bound on the force alone covers
        acting = device.acting_force(compensator.level)
        actuation = () if math.isinf(acting) else device.actuation
        for topic, claim in (
            ("any law within the level", _bounded(device, acting)),
            ("the same, damping counted", _at_every_speed(device, acting)),
        ):
            found.append(Settled(topic, about_device(device, claim, besides=actuation)))
    covered = len(found)
    if compensator.law == "dahl":
        sampled = computer is not None and device.presliding is not None
        when = ", continuous time" if sampled else ""
        found.append(Settled(f"estimate{when}", _dahl(device, compensator, certain=False)))
        found.append(Settled(f"95 % interval{when}", _dahl(device, compensator, certain=True)))
        if computer is not None and device.presliding is not None:
            whole = round(computer.delay / computer.period)
            claim = sampled_passivity(
                -sp.Float(compensator.second) * Z**-whole,
                damping=device.damping.low,
                sample_time=computer.period,
                stiffness=device.presliding.low,
            )
            found.append(Settled("small motion, sampled", claim))
            found.append(Settled("any motion, sampled", _sampled(device, compensator, computer)))
    found[covered:] = [replace(s, claim=about_device(device, s.claim)) for s in found[covered:]]
    return found


def _bounded(device: IdentifiedDevice, acting: float) -> Claim:
    """Whether the friction level covers any law that acts with no more than that, N."""
    if math.isinf(acting):
        why = "no bound is known of the force that the actuation makes of a command"
        return Claim("no law within the friction level drives a motion", Unknown(why))
    return bounded_compensation(coulomb_level=device.lowest.low, bound=acting)


def _at_every_speed(device: IdentifiedDevice, acting: float) -> Claim:
    """Whether level and damping together cover a law that acts with no more than that, N."""
    least, unit = device.least_resistance.low, device.force_unit
    margin = least - acting
    statement = (
        f"ideal friction of the device and its viscous damping resist with more than "
        f"{acting:g} {unit} at every speed, so that no law within it drives a motion"
    )
    searched = (
        f"interval arithmetic: the resistance is at least {least:.4g} {unit} in the 95 % interval"
    )
    return Claim(statement, Evidence(margin >= 0, searched, margin, unit))


def about_device(device: IdentifiedDevice, claim: Claim, *, besides: Sequence[str] = ()) -> Claim:
    """A claim about friction as one about the device.

    besides: effects that its theorem is about, though no claim about friction alone is
    """
    left = [name for name in device.set_aside if name not in besides]
    return of_whole_device(claim, over=device.friction.over, left=left)


def _searched(
    device: IdentifiedDevice,
    compensator: Compensator,
    computer: Sampling | None,
    rng: np.random.Generator,
    tries: int,
) -> Settled:
    """The whole device with its compensator, as simulated."""
    topic, lengths = "search by simulation", [device.lowest.estimate / _RIGID]
    if device.presliding is not None:
        lengths = [device.lowest.estimate / device.presliding.estimate]
    if compensator.law == "dahl":
        lengths.append(compensator.level / compensator.second)
    stroke = 100 * max(lengths)
    try:
        claim = search_counterexample(
            haptic_interface(device.body, cancellation=compensator.controller),
            stroke=stroke,
            speed=10 * stroke,  # a stroke takes a third of a second, or up to a hundred times that
            rng=rng,
            computer=computer or "continuous",
            give=min(lengths) / 100,
            tries=tries,
        )
    except ModelError as problem:  # a body that this simulation does not take
        return Settled(topic, Claim("the device as simulated is passive", Unknown(str(problem))))
    record = claim.verdict.record if isinstance(claim.verdict, Refutation) else None
    if not isinstance(record, SimulatedMotion):
        return Settled(topic, claim)
    return Settled(topic, claim, record.replay(), record)


def _dahl(device: IdentifiedDevice, compensator: Compensator, *, certain: bool) -> Claim:
    """The pair at the estimates, or for all levels within the intervals."""
    return dahl_claim(device, compensator.level, compensator.second, certain=certain)


def dahl_claim(
    device: IdentifiedDevice, level: float, stiffness: float, *, certain: bool = True
) -> Claim:
    """Friction of the device, bristle damping counted, with a Dahl compensator (N, N/m).

    certain: for all levels within the intervals, else at the estimates
    """
    own = device.presliding
    low = device.lowest.low if certain else device.lowest.estimate
    high = device.highest.high if certain else device.highest.estimate
    given = dict(coulomb_level=low, compensator_level=level, compensator_stiffness=stiffness)
    if own is None:
        return dahl_compensation(**given)
    softest = own.low if certain else own.estimate
    pair = dahl_compensation(**given, presliding_stiffness=softest, highest_level=high)
    return beside_bristle_damping(
        pair,
        coulomb_level=low,
        highest_level=high,
        stiffness=softest,
        bristle_damping=device.bristle_damping.high if certain else device.bristle_damping.estimate,
        viscous_damping=device.damping.low if certain else device.damping.estimate,
    )


def _sampled(device: IdentifiedDevice, compensator: Compensator, computer: Sampling) -> Claim:
    """The pair at the estimates in a computer, whatever the motion."""
    if device.bristle_damping.high > 0:
        why = "no theorem here is about bristle damping beside a compensator in a computer"
        return Claim("the device's friction with its sampled compensator is passive", Unknown(why))
    return sampled_compensation(
        coulomb_level=device.highest.estimate,
        compensator_level=compensator.level,
        compensator_stiffness=compensator.second,
        sample_time=computer.period,
        presliding_stiffness=device.presliding and device.presliding.estimate,
        viscous_damping=device.damping.estimate,
        late=round(computer.delay / computer.period),
    )


def replay_cycle(cycle: Cycle) -> SimulatedMotion | None:
    """A refuting cycle of one friction element, replayed by the compiled simulation.

    None where simulation does not confirm it, as next to a limit, or for several elements.
    """
    if len(cycle.friction) != 1 or not isinstance(cycle.friction[0], Coulomb | Dahl):
        return None
    friction, helps = cycle.friction[0], cycle.compensator
    body = Body("prismatic", {"inertia": Value(1e-3)})
    body = body.with_effect(EFFECTS["coulomb"], {"level": friction.level})
    lengths = [helps.level / helps.stiffness]
    if isinstance(friction, Dahl):
        presliding = EFFECTS["presliding"].without("bristle_damping")
        body = body.with_effect(presliding, {"stiffness": friction.stiffness})
        lengths.append(friction.level / friction.stiffness)
    law = controller("dahl", {"level": helps.level, "stiffness": helps.stiffness})
    # friction does not depend on speed: a stroke takes about 10 ms
    strokes = Strokes(cycle.turning_points, speed=300 * max(map(abs, cycle.turning_points)))
    give = min(*lengths, *map(abs, cycle.turning_points)) / 1000
    return confirmed_motion(haptic_interface(body, cancellation=law), strokes, give=give)


def _replayed(settled: Settled) -> Settled:
    record = settled.claim.record if settled.claim.status == "refuted" else None
    motion = replay_cycle(record) if isinstance(record, Cycle) else None
    return settled if motion is None else replace(settled, replayed=motion.energy, motion=motion)


def device_claims(device: IdentifiedDevice) -> list[Settled]:
    """Claims about the device itself: LuGre friction, where all of its parts were identified."""
    values = {n: v.value for n, v in device.body.parameters.items()}
    if "stribeck.extra_static_level" not in values or device.presliding is None:
        return []
    given = dict(
        stiffness=device.presliding.estimate,
        bristle_damping=device.bristle_damping.estimate,
        viscous_damping=device.damping.estimate,
        stribeck_velocity=values["stribeck.stribeck_velocity"],
    )
    low, high = device.lowest.estimate, device.highest.estimate
    plain = sum((EFFECTS[n].expression() for n in ("coulomb", "stribeck")), sp.S(0))
    if device.body.level() == plain:
        low = values["coulomb.level"]
        high = low + values["stribeck.extra_static_level"]
    claim = lugre_passivity(coulomb_level=low, static_level=high, **given)
    if device.body.level() != plain and not claim.holds:
        why = "the condition fails, and no motion is sought where the level is not Stribeck's alone"
        claim = Claim(claim.statement, Unknown(why))
    # what acts on commands is no part of it
    claim = about_device(device, claim, besides=device.actuation)
    return [Settled("the device's own friction", claim)]


def wall_claims(
    device: IdentifiedDevice,
    *,
    stiffness: float,
    damping: float,
    computer: Sampling,
    cancelled: float = 0.0,
) -> list[Settled]:
    """Claims about a virtual wall: the sampled law, and its encoder steps beside friction.

    stiffness, damping: K, N/m, and B, N s/m;  cancelled: friction that a compensator takes, N
    """
    late = computer.period
    whole = round(computer.delay / late)
    law = (sp.Float(stiffness) + sp.Float(damping) * (Z - 1) / (late * Z)) * Z**-whole
    found = [
        Settled(
            "virtual wall, damping alone",
            sampled_passivity(law, damping=device.damping.low, sample_time=late),
        )
    ]
    if computer.encoder_step and not damping and not whole:
        found.append(
            Settled(
                "virtual wall, encoder steps",
                quantised_spring(
                    stiffness=stiffness,
                    damping=device.damping.low,
                    sample_time=late,
                    step=computer.encoder_step,
                    coulomb_level=device.lowest.low,
                    compensator_level=cancelled,
                ),
            )
        )
    return [replace(s, claim=about_device(device, s.claim)) for s in found]


def margins(device: IdentifiedDevice, compensator: Compensator | None = None) -> Sequence[Margin]:
    """What may be chosen so that it is passive for every value within the 95 % intervals."""
    force, stiff = device.force_unit, device.stiffness_unit
    alone = f", for friction without {', '.join(device.set_aside)}" if device.set_aside else ""
    found = [
        Margin(text + alone, level, force)
        for text, level in (
            ("largest f_D that is passive at the estimates", device.lowest.estimate),
            ("largest f_D that is passive for every level in the interval", device.lowest.low),
        )
    ]
    own = device.presliding
    if own is None:
        text = "largest f_D that drives no motion, viscous damping counted"
        return [*found, Margin(text + alone, device.least_resistance.low, force)]
    recoil = device.bristle_damping.high * (device.highest.high - device.lowest.low)
    if device.damping.low * device.lowest.low < recoil:
        return []  # no limit is known where the bristle's damping may give out energy
    if compensator is not None and compensator.law != "dahl":
        return []  # no limit is known for such a law on a contact that gives
    level = min(compensator.level if compensator else math.inf, device.lowest.low)
    softest = own.low * math.sqrt(level / device.highest.high)
    found.append(Margin(f"largest sigma_D at f_D = {level:.4g} {force}{alone}", softest, stiff))
    if compensator is not None:
        least = device.highest.high * (compensator.second / own.low) ** 2
        found.append(
            Margin(f"least f_D at sigma_D = {compensator.second:.4g} {stiff}{alone}", least, force)
        )
    return found
