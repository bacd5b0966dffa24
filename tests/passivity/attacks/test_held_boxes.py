"""Boxes of a teleoperator with hand and environment: margins that are proved, against eigenvalues.

    master, slave, hand, environment: m s^2 + b s + k;  coupling: (d + c b/(s - a)) (x_m - x_s)

The attacker writes the polynomials and impedances itself and samples the box: its corners, its
edges and points inside. No pole is nearer to the axis than the proved margin, no least eigenvalue
of Z is below it, and a teleoperator that is absolutely stable has no growing pole between hands and
environments of its box.
"""

from collections import Counter

import numpy as np
import pytest
from devices import body
from passivity.attacks.budget import attacked
from passivity.attacks.test_wirings import STATE_LAW, sign

from teleopdesign.blocks import hand
from teleopdesign.controllers import Controller, Stage
from teleopdesign.diagrams import teleoperator
from teleopdesign.passivity import claim_over_intervals

PARTS = ("inertia", "viscous.damping", "spring.stiffness")
LAW = f"P.{STATE_LAW.name}"
SIDES = {"Z_m": 0, "Z_s": 1, "Z_H": 0, "Z_E": 1}


def draw(rng):
    """Values of all blocks, in units of mass 10^u and time 10^v."""
    unit, rate = 10 ** rng.uniform(-3, 3), 10 ** rng.uniform(-2, 3)
    scale = (unit, unit * rate, unit * rate**2)
    values = {}
    for block in SIDES:
        for part, size in zip(PARTS, scale, strict=True):
            values[f"{block}.{part}"] = float(f"{size * 10 ** rng.uniform(-1, 1):.3g}")
    # a spring that grows softer or stiffer with s, by a share that the dampers may pay for
    a, d = -rate * 10 ** rng.uniform(-1, 1), scale[2] * 10 ** rng.uniform(-1, 1)
    paid = min(values[f"{block}.viscous.damping"] for block in ("Z_m", "Z_s")) * abs(a)
    c = sign(rng) * (paid * 10 ** rng.uniform(-2, 0.5) if rng.random() < 0.7 else d)
    for n, x in zip("abcd", (a, -a, c, d), strict=True):
        values[f"{LAW}.{n}"] = float(f"{x:.3g}")
    for block in ("Z_m", "Z_s"):  # springs of devices are absent as often as not
        if rng.random() < 0.5:
            values[f"{block}.spring.stiffness"] = 0.0
    return values


def made(values):
    def device(block):
        m, b, k = (values[f"{block}.{part}"] for part in PARTS)
        return body(m, viscous__damping=b, **({"spring__stiffness": k} if k else {}))

    sides = {
        name: hand(mass=m, damping=b, stiffness=k)
        for name, (m, b, k) in (
            (name, [values[f"{block}.{part}"] for part in PARTS])
            for name, block in (("hand", "Z_H"), ("environment", "Z_E"))
        )
    }
    law = Controller((Stage(STATE_LAW, {n: values[f"{LAW}.{n}"] for n in "abcd"}),))
    return teleoperator(device("Z_m"), device("Z_s"), coupling=law, **sides)


def matrices(values, *, held):
    """Mass, damping and stiffness of both sides, with hand and environment or without."""
    m, b, k = (np.zeros((2, 2)) for _ in range(3))
    for block, i in SIDES.items():
        if held or block in ("Z_m", "Z_s"):
            for matrix, part in zip((m, b, k), PARTS, strict=True):
                matrix[i, i] += values[f"{block}.{part}"]
    return m, b, k


LINK = np.array([1.0, -1.0])


def slowest(values):
    """Largest real part of a pole with hand and environment, 1/s."""
    m, b, k = matrices(values, held=True)
    la, lb, lc, ld = (values[f"{LAW}.{n}"] for n in "abcd")
    inverse, link = np.linalg.inv(m), np.outer(LINK, LINK)
    whole = np.zeros((5, 5))
    whole[:2, 2:4] = np.eye(2)
    whole[2:4, :2], whole[2:4, 2:4] = -inverse @ (k + ld * link), -inverse @ b
    whole[2:4, 4], whole[4, :2], whole[4, 4] = -inverse @ LINK * lc, lb * LINK, la
    return np.linalg.eigvals(whole).real.max()


def least_loss(values):
    """Least eigenvalue of Re Z over frequency, N s/m."""
    la, lb, lc, ld = (values[f"{LAW}.{n}"] for n in "abcd")
    b = matrices(values, held=False)[1]
    w = np.append(np.abs(la) * np.geomspace(1e-4, 1e4, 161), np.abs(la) * 1e9)
    link = ((ld + lc * lb / (1j * w - la)) / (1j * w)).real
    return min(np.linalg.eigvalsh(b + x * np.outer(LINK, LINK))[0] for x in link)


def at_rest(values):
    """Least static stiffness between the ports, over the largest: below 0 a displacement grows."""
    la, lb, lc, ld = (values[f"{LAW}.{n}"] for n in "abcd")
    k = matrices(values, held=False)[2] + (ld - lc * lb / la) * np.outer(LINK, LINK)
    return np.linalg.eigvalsh(k)[0] / np.abs(k).max()


def sampled(rng, box, number=60):
    for k in range(number):
        share = rng.random(len(box)) if k % 3 == 0 else rng.integers(0, 2, len(box)).astype(float)
        if k % 3 == 1 and len(box):
            share[rng.integers(0, len(box))] = rng.random()
        yield {
            n: low + (high - low) * u
            for (n, (low, high)), u in zip(box.items(), share, strict=True)
        }


@pytest.mark.slow
@attacked(2, 20)
def test_no_point_of_a_box_has_less_than_the_margin_that_is_proved(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for index in range(number):
        values = draw(rng)
        claim = ("stable", "passive", "absolutely stable")[index % 3]
        names = [n for n in values if values[n] and (claim == "stable" or n[2] not in "HE")]
        box = {}
        for n in map(str, rng.choice(names, int(rng.integers(1, 4)), replace=False)):
            spread = 10 ** rng.uniform(-9, 0.5)  # down to ends that almost coincide
            ends = sorted((values[n] * (1 - spread), values[n] * (1 + spread)))
            box[n] = (max(ends[0], 0.0), ends[1]) if n[0] == "Z" else tuple(ends)
            if n.endswith("inertia"):
                box[n] = (values[n], ends[1])
        verdict = claim_over_intervals(made(values), box, claim=claim, points=4)
        counts[claim, verdict.status] += 1
        if verdict.status == "refuted" and claim != "absolutely stable":
            worst = {**values, **verdict.worst}
            size = max(abs(x) for n, x in worst.items() if n.endswith("damping"))
            out = -slowest(worst) / abs(worst[f"{LAW}.a"])
            if claim == "passive":
                out = min(least_loss(worst) / size, at_rest(worst))
            assert out < 1e-6, (values, box, verdict)
        for point in sampled(rng, box):
            here = {**values, **point}
            pole, loss = slowest(here), least_loss(here)
            scale = abs(pole) if claim == "stable" else abs(loss)
            if verdict.status == "proved" and claim == "stable":
                assert pole <= -verdict.proved_margin + 1e-9 * scale, (values, box, point, verdict)
                assert verdict.margin <= -slowest({**values, **verdict.worst}) * (1 + 1e-6)
            if verdict.status == "proved" and claim == "passive":
                assert loss >= verdict.proved_margin - 1e-9 * scale, (values, box, point, verdict)
                assert at_rest(here) >= -1e-12, (values, box, point, verdict)
            if verdict.holds and claim == "absolutely stable":
                assert pole < 0, (values, box, point, verdict)
    print(dict(counts))
