"""Claims over boxes of a law's values, of either sign: each proof against the modes at points.

z' = a z + b input, output c z + d input, with one or two of a, b, c, d within intervals that may
pass through zero: what the law shows, what it hides, and its output beside the port.
"""

from collections import Counter

import numpy as np
import pytest
from passivity.attacks.budget import attacked
from passivity.attacks.test_wirings import Wiring, growth, least_power, pick, sign

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import claim_over_intervals

NAME = "CL.law_with_a_state"


def wired(shape, values):
    """A body with a law on its position, or one whose output only another law hears."""
    w = Wiring("box")
    w.body("1", *shape["body"])
    w.system("L", [[values["a"]]], [values["b"]], [values["c"]], values["d"], "x1", "y", kind="law")
    w.junction("u1", y=shape["share"], x1=-shape["spring"])
    return w


def random_case(rng):
    shape = {
        "body": (pick(rng, -2, 0), pick(rng), pick(rng, 0, 2) * rng.integers(0, 2)),
        "share": -float(rng.choice([0.0, 1.0, 0.5])),
        "spring": pick(rng, 0, 2) * int(rng.integers(0, 2)),
    }
    values = {"a": -pick(rng), "b": pick(rng), "c": sign(rng) * pick(rng), "d": pick(rng)}
    values["b"] *= float(rng.integers(0, 3) > 0)
    values["d"] *= float(rng.integers(0, 3) > 0)
    if rng.random() < 0.6:  # a lossy spring: d + c b/(s - a), from softer to stiffer with s
        values["c"] = -abs(values["c"])
        values["d"] = float(f"{abs(values['c'] * values['b'] / values['a']) * 1.5:.3g}")
    box = {}
    for n in rng.choice(list("abcd"), int(rng.integers(1, 3)), replace=False):
        spread = 10 ** rng.uniform(-1.5, 0.3) * (abs(values[n]) or 1.0)
        low, high = values[n] - spread * rng.random(), values[n] + spread * rng.random()
        box[str(n)] = (float(f"{low:.3g}"), float(f"{high + 0.01 * spread:.3g}"))
    return shape, values, {n: ends for n, ends in box.items() if ends[0] < ends[1]}


def fails_at(rng, shape, values, box, claim):
    """A point of the box at which a mode grows, or energy comes out; None where none is seen."""
    for k in range(12):
        share = rng.random(len(box)) if k % 2 else rng.integers(0, 2, len(box)).astype(float)
        ends = zip(box.items(), share, strict=True)
        point = {n: float(f"{low + (high - low) * u:.9g}") for n, (low, high), u in
                 ((n, pair, u) for (n, pair), u in ends)}  # fmt: skip
        w = wired(shape, {**values, **point})
        if growth(w) > 1e-20:
            return point
        if claim == "passive" and least_power(w, w.diagram())[0] < -1e-9:
            return point
    return None


@pytest.mark.slow
@attacked(1, 10)
def test_no_box_is_proved_in_which_a_mode_grows_or_energy_comes_out(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for k in range(number):
        shape, values, box = random_case(rng)
        claim = ("passive", "stable")[k % 2]
        diagram = wired(shape, values).diagram()
        named = {f"{NAME}.{n}": ends for n, ends in box.items()}
        try:
            verdict = claim_over_intervals(diagram, named, claim=claim, points=4)
        except ModelError:
            counts["refused"] += 1
            continue
        if verdict.status == "proved":
            assert all(one.check() for one in verdict.certificates)
            point = fails_at(rng, shape, values, box, claim)
            assert point is None, (claim, shape, values, box, point)
        counts[claim, verdict.status] += 1
    print(dict(counts))
