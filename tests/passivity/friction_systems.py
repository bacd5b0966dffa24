"""Random devices with friction and a compensator, what the theorems say, and what a search finds.

A verdict joins the claims of the package to one for the whole device; the search knows the lengths
and speeds of the device, but no theorem.
"""

import math
from dataclasses import dataclass

import numpy as np
import sympy as sp

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    Coulomb,
    SteadyStrokes,
    Strokes,
    Trembling,
    bounded_compensation,
    confirmed_motion,
    dahl_compensation,
    released_energy,
    sampled_compensation,
    sampled_passivity,
    velocity_compensation,
)
from teleopdesign.simulate import Sampling

LAWS = ("dahl", "smoothed_coulomb", "coulomb")
MOST_STEPS = 30_000  # of one simulated motion


@dataclass(frozen=True)
class FrictionSystem:
    """A device and its compensator, SI; 0 or None where a part is not there.

    level: f_C;  extra: f_S - f_C, over stribeck_velocity;  stiffness: presliding;  damping: B
    compensator_level: f_D;  second: sigma_D of `dahl`, a of `smoothed_coulomb`
    period: of the computer, 0 in continuous time;  late: whole periods;  time: a scale, s
    """

    level: float
    extra: float
    stribeck_velocity: float
    stiffness: float | None
    damping: float
    law: str
    compensator_level: float
    second: float
    period: float
    late: int
    length: float
    time: float

    @property
    def computer(self):
        if not self.period:
            return "continuous"
        return Sampling(period=self.period, delay=self.late * self.period)

    def level_at(self, speed):
        """Friction level at that speed, N."""
        if not self.extra:
            return self.level
        return self.level + self.extra * math.exp(-((speed / self.stribeck_velocity) ** 2))

    def diagram(self):
        body = td.Body("prismatic", {"inertia": td.Value(1e-6 * self.level)})
        body = body.with_effect(td.EFFECTS["coulomb"], {"level": self.level})
        if self.stiffness is not None:
            presliding = td.EFFECTS["presliding"].without("bristle_damping")
            body = body.with_effect(presliding, {"stiffness": self.stiffness})
        if self.damping:
            body = body.with_effect(td.EFFECTS["viscous"], {"damping": self.damping})
        if self.extra:
            values = {
                "extra_static_level": self.extra,
                "stribeck_velocity": self.stribeck_velocity,
            }
            body = body.with_effect(td.EFFECTS["stribeck"], values)
        values = {"level": self.compensator_level}
        if self.law != "coulomb":
            second = {"dahl": "stiffness", "smoothed_coulomb": "smoothing_velocity"}[self.law]
            values[second] = self.second
        return haptic_interface(body, cancellation=controller(self.law, values))


def random_system(rng):
    """Force, length and time each over six decades; half of the compensators near their limit."""
    force = 10 ** rng.uniform(-3, 3)
    length = 1e-4 * 10 ** rng.uniform(-3, 3)
    time = 1e-2 * 10 ** rng.uniform(-3, 3)
    speed = length / time
    there = rng.random(4) < (0.4, 0.6, 0.5, 0.5)  # Stribeck, presliding, viscous, computer
    law = LAWS[rng.integers(3)]
    stiffness = force / length if there[1] else None
    damping = force / speed * 10 ** rng.uniform(-2, 2) if there[2] else 0.0
    smoothing = speed * 10 ** rng.uniform(-2, 2)
    spread = 0.3 if rng.random() < 0.5 else 3.0  # decades beside the limit
    level_of_law = force * 10 ** rng.uniform(-spread, spread)
    if rng.random() < 0.1:
        level_of_law = force  # the limit itself
    if law == "smoothed_coulomb" and damping and rng.random() < 0.7:
        least = 0.0 if there[1] else force
        level_of_law = (math.sqrt(least) + math.sqrt(smoothing * damping)) ** 2
        level_of_law *= 10 ** rng.uniform(-spread, spread)
    stiff = force / length * math.sqrt(level_of_law / force) * 10 ** rng.uniform(-spread, spread)
    return FrictionSystem(
        level=force,
        extra=force * 10 ** rng.uniform(-1.5, 0) if there[0] else 0.0,
        stribeck_velocity=speed * 10 ** rng.uniform(-1, 1),
        stiffness=stiffness,
        damping=damping,
        law=law,
        compensator_level=level_of_law,
        second=stiff if law == "dahl" else smoothing,
        period=time * 10 ** rng.uniform(-2, 0.5) if there[3] else 0.0,
        late=int(rng.integers(3)) if there[3] else 0,
        length=length,
        time=time,
    )


def verdict(system):
    """("proved" | "refuted" | "unknown", by what, record that refutes or None), whole device."""
    claims = _dahl_claims(system) if system.law == "dahl" else _velocity_claims(system)
    for name, claim in claims:
        if claim.status == "refuted":
            return "refuted", name, claim.record
    sufficient = [c for name, c in claims if name == "every level"]
    if sufficient and sufficient[0].status == "proved":
        return "proved", "every level", None
    steady = _steady_excess(system)
    if steady is not None:
        return "refuted", "one speed", steady
    return "unknown", "between the conditions", None


def _dahl_claims(system):
    """Slow motion meets the static level; every level that occurs; small motion as sampled."""
    pair = {
        "compensator_level": system.compensator_level,
        "compensator_stiffness": system.second,
        "presliding_stiffness": system.stiffness,
    }
    static = system.level + system.extra
    claims = [("slow", dahl_compensation(coulomb_level=static, **pair))]
    if system.stiffness is None:
        every = bounded_compensation(coulomb_level=system.level, bound=system.compensator_level)
        if every.status == "proved":
            claims.append(("every level", every))
        return claims
    if not system.period:
        every = dahl_compensation(coulomb_level=system.level, highest_level=static, **pair)
        if every.status == "proved":
            claims.append(("every level", every))
        return claims
    small = sampled_passivity(
        -system.second * sp.Symbol("z") ** -system.late,
        damping=system.damping,
        sample_time=system.period,
        stiffness=system.stiffness,
    )
    trembling = sampled_compensation(
        coulomb_level=static,
        sample_time=system.period,
        viscous_damping=system.damping,
        late=system.late,
        **pair,
    )
    return [*claims, ("small", small), ("trembling", trembling)]


def _velocity_claims(system):
    """The lowest level, which is necessary too where the level is constant or the contact gives."""
    claim = velocity_compensation(
        coulomb_level=system.level,
        compensator_level=system.compensator_level,
        smoothing_velocity=system.second if system.law == "smoothed_coulomb" else 0,
        viscous_damping=system.damping,
        presliding_stiffness=system.stiffness,
        sample_time=system.period or None,
        late=system.late,
    )
    if claim.status == "refuted" and system.extra and system.stiffness is None:
        return []  # refuted for a level that need not occur at that speed
    return [("every level" if claim.status == "proved" else "velocity", claim)]


def _steady_excess(system):
    """Strokes at the speed at which most is given out, if any is.

    They are eight times as long as what is lost at a reversal asks for: bristles that load anew,
    which this record leaves out, and a force that is late.
    """
    smoothing = system.second if system.law == "smoothed_coulomb" else 0.0
    scale = system.length / system.time
    best = None
    for speed in scale * np.geomspace(1e-5, 1e5, 200):
        helped = system.compensator_level * speed / (smoothing + speed)
        gain = helped - system.level_at(speed) - system.damping * speed
        if best is None or gain > best[0]:
            best = gain, float(speed), helped
    gain, speed, helped = best
    if gain <= 1e-3 * helped:
        return None
    lost = (1 + system.late) * system.period * speed
    if system.law == "dahl":
        lost += system.compensator_level / system.second
    if system.stiffness is not None:
        lost += system.length
    return SteadyStrokes(
        system.compensator_level,
        smoothing,
        Coulomb(system.level_at(speed)),
        system.damping,
        speed,
        8 * helped / gain * lost or system.length,
        system.period,
        system.late,
    )


def theory_motion(system, record):
    """The refuting record as a smooth motion for simulation; None where it is far too long."""
    if isinstance(record, SteadyStrokes):
        half = record.travel / 2
        return Strokes((half, -half), record.speed * 1.2)
    if isinstance(record, Trembling):
        return record.strokes() if record.samples < 1000 else None
    if hasattr(record, "turning_points"):
        a = max(record.turning_points)
        slow = a / system.time
        if system.damping:
            slow = min(slow, 1e-2 * system.level / system.damping)
        if system.extra:
            slow = min(slow, 1e-2 * system.stribeck_velocity)
        if system.period:
            slow = min(slow, a / (30 * (1 + system.late) * system.period))
        return Strokes(tuple(record.turning_points), slow)
    return None


def searched_motions(system, rng, number):
    """Sinusoids, and the same with a step back, over the lengths and speeds of the device."""
    scale = system.length / system.time
    lengths = [system.length]
    if system.law == "dahl":
        lengths.append(system.compensator_level / system.second)
    speeds = [scale]
    if system.law == "smoothed_coulomb":
        speeds.append(system.second)
    if system.damping:
        speeds.append(system.level / system.damping)
    for k in range(number):
        a = float(rng.choice(lengths)) * 10 ** rng.uniform(-2, 2.5)
        v = float(rng.choice(speeds)) * 10 ** rng.uniform(-2, 1)
        points = (a, -a) if k % 2 else (a, 0.9 * a, a, -a, -0.9 * a, -a)
        yield Strokes(points, v)


def affordable(system, strokes):
    """Whether a simulation of it is short enough, and long against one sample."""
    shortest = float(np.diff(strokes.times).min())
    period = system.period or 1e-3
    steps = strokes.duration / min(shortest / 100, period)
    return steps < MOST_STEPS and (shortest > 1e-6 if not system.period else True)


def give_of(system, strokes):
    """Give of ideal friction: small against the motion and the compensator's bristle."""
    lengths = [max(map(abs, strokes.points))]
    if system.law == "dahl":
        lengths.append(system.compensator_level / system.second)
    return min(lengths) / 300


def search_motion(system, rng, *, number):
    """A motion that gives out energy beyond doubt in simulation, or None."""
    diagram, good = system.diagram(), []
    for strokes in searched_motions(system, rng, number):
        if not affordable(system, strokes):
            continue
        width = give_of(system, strokes)
        try:
            energy = released_energy(diagram, strokes, computer=system.computer, give=width)
        except ModelError:  # a contact too stiff for steps that this search can afford
            continue
        if energy.last_round > 0:
            good.append((energy.last_round / energy.turned, strokes))
    for _, strokes in sorted(good, key=lambda x: -x[0])[:2]:
        motion = confirmed(system, strokes)
        if motion is not None:
            return motion
    return None


def confirmed(system, strokes):
    """The strokes as a motion of the whole device that gives out energy beyond doubt, or None."""
    if strokes is None or not affordable(system, strokes):
        return None
    try:
        return confirmed_motion(
            system.diagram(), strokes, computer=system.computer, give=give_of(system, strokes)
        )
    except ModelError:
        return None
