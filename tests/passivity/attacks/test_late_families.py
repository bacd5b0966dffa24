"""Stability over boxes with dead times, of loops of other kinds, against a count of their poles.

The attacker writes f(s) = sum p_k(s) e^(-s T_k) by hand and counts its zeros with Re s > 0 by the
turns of f round the right half plane. Half of the boxes end a hair before or behind a limit that it
finds itself.
"""

from collections import Counter
from functools import reduce

import control as ct
import numpy as np
import pytest
from devices import body
from passivity.attacks.budget import attacked
from passivity.attacks.late_modes import count_growing

from teleopdesign.base.errors import UnstableLoop
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.frequency import delay_margin, gain_margin, loop_gain
from teleopdesign.passivity import claim_over_intervals

TIME, LAW = "T_1.delay.time", "P.proportional_derivative"


def pick(rng, low, high):
    return float(f"{10 ** rng.uniform(low, high):.3g}")


def times(*polynomials):
    return reduce(np.polymul, polynomials)


def device(values, name="M"):
    terms = {
        f"{effect}__{parameter}": values[f"{name}.{effect}.{parameter}"]
        for effect, parameter in (("viscous", "damping"), ("spring", "stiffness"))
        if values[f"{name}.{effect}.{parameter}"]
    }
    return body(values[f"{name}.inertia"], **terms)


def impedance(values, name="M"):
    return [values[f"{name}.inertia"], values[f"{name}.viscous.damping"],
            values[f"{name}.spring.stiffness"]]  # fmt: skip


def mass(rng, name="M"):
    return {
        f"{name}.inertia": pick(rng, -2, 1),
        f"{name}.viscous.damping": pick(rng, -1, 1.5),
        f"{name}.spring.stiffness": pick(rng, -1, 2),
    }


def delay(name, values, signals):
    law = controller("delay", {"time": values[f"{name}.delay.time"]})
    return Control(name, law, *signals, analog=True)


class Neutral:
    """u = -k x(t - T_1) - a u(t - T_2): what acts is fed back late, and stays as strong."""

    def draw(self, rng):
        return {**mass(rng), "K.gain.gain": pick(rng, -1, 2.5), TIME: pick(rng, -2.5, 0.3),
                "A.gain.gain": float(f"{rng.uniform(-1.1, 1.1):.3g}"),
                "T_2.delay.time": pick(rng, -2.5, 0.3)}  # fmt: skip

    def diagram(self, v):
        blocks = (
            Moving("M", device(v), "x", "u", {"f": 1}, "f"),
            delay("T_1", v, ("x", "heard")),
            Control("K", controller("gain", {"gain": v["K.gain.gain"]}), "heard", "p", analog=True),
            delay("T_2", v, ("u", "again")),
            Control("A", controller("gain", {"gain": v["A.gain.gain"]}), "again", "e", analog=True),
        )
        return Diagram("neutral", blocks, (Junction("u", {"p": -1, "e": -1}),), {"f": "force"},
                       ("x",))  # fmt: skip

    def terms(self, v):
        z = impedance(v)
        return [(z, 0.0), (np.multiply(v["A.gain.gain"], z), v["T_2.delay.time"]),
                ([v["K.gain.gain"]], v[TIME])]  # fmt: skip


class Hidden:
    """A late law k/(s - p) behind (s - p)/(s + q): the mode p is in no transfer function."""

    names = ("M.inertia", "M.viscous.damping", "M.spring.stiffness")

    def draw(self, rng):
        p = pick(rng, -2, 1) * float(rng.choice([1, -1, -1, 0]))
        return {**mass(rng), "p": p, "q": pick(rng, -1, 1), "k": pick(rng, -1, 1.5),
                TIME: pick(rng, -2.5, 0.3), "one": float(rng.integers(0, 2))}  # fmt: skip

    def diagram(self, v):
        first = from_control(ct.tf([1, -v["p"]], [1, v["q"]]), name="first")
        second = from_control(ct.tf([v["k"]], [1, -v["p"]]), name="second")
        blocks = (
            Moving("M", device(v), "x", "u", {"f": 1}, "f"),
            delay("T_1", v, ("x", "heard")),
            *(
                (Control("C", first.then(second), "heard", "p", analog=True),)
                if v["one"]
                else (
                    Control("C", first, "heard", "c", analog=True),
                    Control("D", second, "c", "p", analog=True),
                )
            ),
        )
        return Diagram("hidden", blocks, (Junction("u", {"p": -1}),), {"f": "force"}, ("x",))

    def terms(self, v):
        mode, lag = [1, -v["p"]], [1, v["q"]]
        return [(times(impedance(v), mode, lag), 0.0), (times([v["k"]], mode), v[TIME])]


class Unheard:
    """Beside a late spring a law with its own pole p that nothing hears."""

    names = ("M.inertia", "K.gain.gain")

    def draw(self, rng):
        p = pick(rng, -3, 1) * float(rng.choice([1, -1, -1, -1, 0]))
        return {**mass(rng), "p": p, "K.gain.gain": pick(rng, -1, 2), TIME: pick(rng, -2.5, 0.3)}

    def diagram(self, v):
        law = from_control(ct.tf([1.0], [1, -v["p"]]), name="own")
        blocks = (
            Moving("M", device(v), "x", "u", {"f": 1}, "f"),
            delay("T_1", v, ("x", "heard")),
            Control("K", controller("gain", {"gain": v["K.gain.gain"]}), "heard", "p", analog=True),
            Control("C", law, "heard", "shown", analog=True),
        )
        return Diagram("unheard", blocks, (Junction("u", {"p": -1}),), {"f": "force"}, ("x",))

    def terms(self, v):
        mode = [1, -v["p"]]
        return [(times(impedance(v), mode), 0.0), (times([v["K.gain.gain"]], mode), v[TIME])]


class Origin:
    """Velocity alone is fed back, by a high-pass of the late position: a pole at 0 where no spring
    holds the mass, and near to it where a weak one does.
    """

    names = ("M.inertia", "M.viscous.damping")

    def draw(self, rng):
        spring = float(rng.choice([0.0, 1e-9, pick(rng, -3, 1)]))
        return {**mass(rng), "M.spring.stiffness": spring, "b": pick(rng, -1, 1),
                "c": pick(rng, 0, 2), TIME: pick(rng, -3, 0)}  # fmt: skip

    def diagram(self, v):
        law = from_control(ct.tf([v["b"] * v["c"], 0], [1, v["c"]]), name="high")
        blocks = (
            Moving("M", device(v), "x", "u", {"f": 1}, "f"),
            delay("T_1", v, ("x", "heard")),
            Control("H", law, "heard", "p", analog=True),
        )
        return Diagram("origin", blocks, (Junction("u", {"p": -1}),), {"f": "force"}, ("x",))

    def terms(self, v):
        return [(times(impedance(v), [1, v["c"]]), 0.0), ([v["b"] * v["c"], 0], v[TIME])]


class Coupled:
    """Two masses, each held to where the other one was."""

    def draw(self, rng):
        return {**mass(rng), **mass(rng, "S"), "K.gain.gain": pick(rng, -1, 2),
                "L.gain.gain": pick(rng, -1, 2), TIME: pick(rng, -2.5, 0.3),
                "T_2.delay.time": pick(rng, -2.5, 0.3)}  # fmt: skip

    def diagram(self, v):
        blocks = (
            Moving("M", device(v), "x", "u", {"f": 1}, "f"),
            Moving("S", device(v, "S"), "y", "w", {"g": 1}, "g"),
            delay("T_1", v, ("x", "x_late")),
            delay("T_2", v, ("y", "y_late")),
            Control("K", controller("gain", {"gain": v["K.gain.gain"]}), "e", "u", analog=True),
            Control("L", controller("gain", {"gain": v["L.gain.gain"]}), "d", "w", analog=True),
        )
        sums = Junction("e", {"y_late": 1, "x": -1}), Junction("d", {"x_late": 1, "y": -1})
        return Diagram("coupled", blocks, sums, {"f": "force", "g": "force"}, ("x", "y"))

    def terms(self, v):
        k, h = v["K.gain.gain"], v["L.gain.gain"]
        first = np.polyadd(impedance(v), [k])
        second = np.polyadd(impedance(v, "S"), [h])
        return [(times(first, second), 0.0), ([-k * h], v[TIME] + v["T_2.delay.time"])]


class Filtered:
    """A law K + B s/(1 + s/c) of the position that hears it late and acts late, and a second way
    back without the law.
    """

    def draw(self, rng):
        return {**mass(rng), f"{LAW}.stiffness": pick(rng, -1, 2.5),
                f"{LAW}.damping": pick(rng, -2, 1), f"{LAW}.bandwidth": pick(rng, -1, 1.5),
                "G.gain.gain": pick(rng, -1, 1.5) * float(rng.choice([-1, 0, 1])),
                TIME: pick(rng, -3, 0.5), "T_2.delay.time": pick(rng, -3, 0.5)}  # fmt: skip

    def diagram(self, v):
        terms = {n: v[f"{LAW}.{n}"] for n in ("stiffness", "damping", "bandwidth")}
        blocks = (
            Moving("M", device(v), "x", "u", {"f": 1}, "f"),
            delay("T_1", v, ("x", "heard")),
            Control("P", controller("proportional_derivative", terms), "heard", "p", analog=True),
            Control("G", controller("gain", {"gain": v["G.gain.gain"]}), "heard", "g", analog=True),
            delay("T_2", v, ("p", "acts")),
        )
        back = (Junction("u", {"acts": -1, "g": -1}),)
        return Diagram("filtered", blocks, back, {"f": "force"}, ("x",))

    def terms(self, v):
        k, b, c = (v[f"{LAW}.{n}"] for n in ("stiffness", "damping", "bandwidth"))
        lag = [1, 2 * np.pi * c]
        law = np.polyadd(np.multiply(k, lag), [b * 2 * np.pi * c, 0])
        return [(times(impedance(v), lag), 0.0), (np.multiply(v["G.gain.gain"], lag), v[TIME]),
                (law, v[TIME] + v["T_2.delay.time"])]  # fmt: skip


FAMILIES = [Neutral(), Hidden(), Unheard(), Origin(), Coupled(), Filtered()]


def random_box(rng, family, values):
    """A dead time, from near 0 or not, and up to two other values."""
    known = getattr(family, "names", tuple(n for n in values if n != TIME))
    others = [n for n in known if values[n]]
    box = {}
    for n in map(str, rng.choice(others, int(rng.integers(0, 3)), replace=False)):
        spread = 10 ** rng.uniform(-2, 0)
        low, high = sorted((values[n] * (1 - 0.9 * spread * rng.random()), values[n]))
        high += abs(values[n]) * spread * rng.random()
        box[n] = (float(f"{low:.4g}"), float(f"{high:.4g}"))
    box = {n: ends for n, ends in box.items() if ends[0] < ends[1]}
    high = values[TIME]
    if rng.random() < 0.6:
        high = near_limit(rng, family, {**values, **{n: high for n, (_, high) in box.items()}})
    box[TIME] = (float(f"{high * rng.random():.4g}"), float(f"{high:.10g}"))
    return box


def near_limit(rng, family, values):
    """A dead time a hair or some per cent beside the first at which a pole grows."""

    def grows(time):
        return count_growing(family.terms({**values, TIME: time})) != 0

    steps = values[TIME] * np.geomspace(0.01, 20, 40)
    beyond = next((k for k, t in enumerate(steps) if grows(t)), None)
    if not beyond:
        return values[TIME]
    low, high = steps[beyond - 1], steps[beyond]
    for _ in range(45):
        middle = (low + high) / 2
        low, high = (low, middle) if grows(middle) else (middle, high)
    return float(low * (1 + float(rng.choice([-1, -1, 1])) * 10 ** rng.uniform(-6, -1)))


def points(rng, box):
    for k in range(24):
        share = rng.random(len(box)) if k % 2 else rng.integers(0, 2, len(box))
        ends = zip(box.items(), share, strict=True)
        yield {n: low + (high - low) * u for (n, (low, high)), u in ends}
    yield {n: high for n, (_, high) in box.items()}


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: type(f).__name__.lower())
@attacked(0, 4)
def test_no_late_loop_of_this_kind_is_proved_stable_that_has_a_growing_pole(family, seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        values = family.draw(rng)
        box = random_box(rng, family, values)
        claim = claim_over_intervals(family.diagram(values), box, claim="stable", points=4)
        counts[claim.status] += 1
        if claim.status == "refuted":
            at = count_growing(family.terms({**values, **claim.worst}))
            assert at is None or at > 0, (values, box, claim)
        if claim.status == "proved":
            for point in points(rng, box):
                growing = count_growing(family.terms({**values, **point}))
                assert not growing, (values, box, point)
    print(type(family).__name__, dict(counts))
    # of few draws of a kind all may be stable
    assert 0 < counts["proved"] and (counts["proved"] < number or number < 40)


@pytest.mark.parametrize(("above", "below"), [([-1.0, 1.0], [1.0, 3.0]), ([-2.0, 5.0], [2.0, 9.0])])
def test_a_loop_of_gain_minus_one_at_high_frequency_is_proved_nothing(above, below):
    """1 + L = 4/(s + 3): no pole, until the gain is not exactly -1 at high frequency."""
    held = {"M.inertia": 1.0, "M.viscous.damping": 30.0, "M.spring.stiffness": 400.0}
    blocks = (
        Moving("M", device(held), "x", "u", {"f": 1.0}, "f"),
        Control("C", from_control(ct.tf(above, below)), "e", "y"),
    )
    sums = (Junction("e", {"x": 1.0, "y": -1.0}), Junction("u", {}))
    diagram = Diagram("loop", blocks, sums, {"f": "force"}, ("x",))
    assert claim_over_intervals(diagram, {}, claim="stable").status == "unknown"
    for margin in (gain_margin, delay_margin):
        with pytest.raises(UnstableLoop, match="-1 at high frequency"):
            margin(loop_gain(diagram, controller="C"))
    near = from_control(ct.tf([0.999 * above[0], above[1]], below))
    assert gain_margin(loop_gain(diagram.with_block("C", near), controller="C")) < 1.0011
