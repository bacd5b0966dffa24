"""Claims on friction extended to devices with other effects, against motions of all their forces.

A body has friction whose level may fall with speed, differ by direction or vary along the way, and
forces that dissipate, store, or supply energy; its parameters have standard errors. The attacker
writes each law itself, at values anywhere in the 95 % intervals. What stores is left out of its
sums: over all of a motion from rest to rest it gives nothing.
"""

from collections import Counter

import numpy as np
from passivity.attacks.budget import attacked, near
from passivity.attacks.friction import bristle
from passivity.attacks.test_friction import ROUNDING, coulomb, dahl, gain, velocity_law

from teleopdesign import EFFECTS, Body, Value
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.passivity.identified import identify_device
from teleopdesign.passivity.theorems import Question, settle

#: half of a 95 % interval in standard errors, a hair within it
WITHIN = 1.959
#: claims at the estimate are about measured numbers of four digits: half a unit of the last, twice
DIGITS = 1e-3
#: second parameter of each law
SECOND = {"dahl": "stiffness", "smoothed_coulomb": "smoothing_velocity"}
ANY_LAW = ("any law within the level", "the same, with damping")


def uncertain(rng, value, share=None):
    """A value that is exact, or known to some per cent."""
    stderr = abs(value) * 10 ** rng.uniform(-3, -1.3) if rng.random() < 0.5 else 0.0
    return Value(float(value), stderr=float(stderr))


def random_device(rng):
    """(effect -> parameter -> value, sizes of force, length and speed), half with bristles."""
    force, length, time = 10.0 ** rng.uniform(-4, 4, 3)
    speed = length / time

    def about(size, low=-1.0, high=0.0):
        return uncertain(rng, size * 10 ** rng.uniform(low, high))

    effects = {"coulomb": {"level": uncertain(rng, force)}}
    bristles = rng.random() < 0.4
    if bristles:
        effects["presliding"] = {"stiffness": about(force / length, 0, 1)}
    if rng.random() < 0.35:
        effects["stribeck"] = {"extra_static_level": about(force, -2),
                               "stribeck_velocity": about(speed, -1, 1)}  # fmt: skip
    if rng.random() < 0.6:
        effects["viscous"] = {"damping": about(force / speed, -1, 1)}
        if rng.random() < 0.4:
            half = effects["viscous"]["damping"].value * near(rng, 1.0) * rng.choice([1, -1])
            effects["viscous_asymmetry"] = {"half_difference": uncertain(rng, half)}
    if not bristles and rng.random() < 0.3:
        effects["position_dependent_friction"] = {
            "amplitude": uncertain(rng, rng.uniform(0.05, 0.6)),
            "period": Value(float(length * 10 ** rng.uniform(-1, 1)), fixed=True, stderr=0.0),
            "phase": Value(float(rng.uniform(0, 6)), fixed=True, stderr=0.0),
        }
    if rng.random() < 0.2:
        effects["quadratic_drag"] = {"drag": about(force / speed**2)}
    if rng.random() < 0.2:
        effects["spring"] = {"stiffness": about(force / length)}
    if rng.random() < 0.15:
        effects["bias"] = {"force": about(force)}
    if rng.random() < 0.15:
        effects["coulomb_asymmetry"] = {"half_difference": about(force, -2, -0.5)}
    return effects, (force, length, speed)


def as_body(effects, inertia):
    made = Body("prismatic", {"inertia": Value(float(inertia))})
    for name, values in effects.items():
        effect = EFFECTS[name]
        if name == "presliding":
            effect = effect.without("bristle_damping")
        made = made.with_effect(effect, {n: v.value for n, v in values.items()})
    return made.with_values({f"{e}.{n}": v for e, one in effects.items() for n, v in one.items()})


def drawn_values(rng, effects, *, spread, low=False):
    """Each parameter at an end of its interval, or anywhere in it; spread: 0 for the estimate.

    low: the least friction that they allow, but for a level that differs by direction
    """

    def one(value):
        share = -1.0 if low else rng.choice([-1.0, 1.0, rng.uniform(-1, 1)])
        return value.value + spread * WITHIN * share * value.stderr

    return {(e, p): one(v) for e, values in effects.items() for p, v in values.items()}


def friction_of(at):
    """State, travel, speed, share -> (state, work): the bristle's force, or without one the way."""

    def value(effect, name):
        return at.get((effect, name), 0.0)

    f_c, soft = value("coulomb", "level"), value("presliding", "stiffness")
    extra, v_s = value("stribeck", "extra_static_level"), value("stribeck", "stribeck_velocity")
    half, drag = value("viscous_asymmetry", "half_difference"), value("quadratic_drag", "drag")
    share, period = (value("position_dependent_friction", n) for n in ("amplitude", "period"))
    phase = value("position_dependent_friction", "phase")

    def resisted(state, x, v, _):
        level = f_c + (extra * np.exp(-((v / v_s) ** 2)) if extra else 0.0)
        damped = (value("viscous", "damping") + half * np.sign(x)) * v + drag * v**2
        if soft:
            state, work = bristle(state, x, level, soft)
            return state, work + damped * np.abs(x)
        work = (level + damped) * np.abs(x)
        if share:  # the integral of the sine along the way
            turn = 2 * np.pi / period
            ends = np.cos(turn * state + phase) - np.cos(turn * (state + x) + phase)
            work = work + f_c * share * np.sign(x) * ends / turn
        return state + x, work

    return resisted


def interval_claim(rng):
    effects, (force, length, speed) = random_device(rng)
    level = near(rng, force) if rng.random() < 0.4 else force * float(rng.uniform(0.2, 1))
    name = "dahl" if rng.random() < 0.7 else "smoothed_coulomb"
    second = speed * 10 ** rng.uniform(-1, 1)
    if name == "dahl":
        soft = effects.get("presliding", {}).get("stiffness", Value(force / length)).value
        second = soft * np.sqrt(level / force) * rng.choice([0.5, 0.9, 1.0, 1.2])
    try:
        device = identify_device(as_body(effects, force / speed * length / speed))
    except ModelError as problem:
        assert "nothing can be compensated" in str(problem), (effects, problem)
        return [("refused", False)]
    values = {"level": float(level), SECOND[name]: float(second)}
    (stage,) = controller(name, values).stages
    claims = settle(Question(device, stage), simulated=False)
    law = dahl(level, level, second) if name == "dahl" else velocity_law(level, second)
    lengths, speeds = [length, level / second if name == "dahl" else length], [speed]
    if period := effects.get("position_dependent_friction", {}).get("period"):
        lengths.append(period.value)
    outcomes = []
    for one in claims:
        helped = law
        if one.topic in ANY_LAW:  # a force along the motion in each leg is the worst of them
            helped = coulomb(level, level)
        elif one.topic == "estimate":
            helped = dahl(level * (1 - DIGITS), level * (1 - DIGITS), second * (1 - 2 * DIGITS))
        beaten = False
        for k in range(3 if one.topic != "estimate" else 1):
            at = drawn_values(rng, effects, spread=float(one.topic != "estimate"), low=k == 0)
            out = gain(rng, helped, friction_of(at), level, lengths, speeds, rounds=15)
            beaten = beaten or out > ROUNDING
            assert not (one.claim.holds and beaten), (one, effects, name, level, second, at)
        outcomes.append((one.claim.status, bool(beaten)))
    return outcomes


@attacked(0, 20)
def test_no_motion_beats_a_claim_that_is_extended_to_a_device(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        counts.update(interval_claim(rng))
    print(dict(counts))
    assert counts["proved", False] >= number / 10
    assert number < 40 or counts["unknown", True] + counts["refuted", True] >= number / 10


def test_the_attack_beats_friction_that_is_weaker_on_part_of_the_way():
    """A level of 1 N that falls to 0.5 N along 10 mm; 0.8 N are cancelled."""
    rng = np.random.default_rng(1)
    at = {("coulomb", "level"): 1.0, ("position_dependent_friction", "amplitude"): 0.5,
          ("position_dependent_friction", "period"): 1e-2,
          ("position_dependent_friction", "phase"): 0.0}  # fmt: skip
    assert gain(rng, coulomb(0.8, 0.8), friction_of(at), 0.8, [1e-2]) > 1e-3
    assert gain(rng, coulomb(0.49, 0.49), friction_of(at), 0.49, [1e-2]) <= ROUNDING
