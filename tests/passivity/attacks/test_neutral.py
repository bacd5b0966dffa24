"""Loops whose gain stays level at high frequency behind a dead time: chains of modes far out.

f(s) = p(s) + q(s) e^(-s T) with p and q of one degree has modes near r + j (2 pi k + phi)/T for
every k, r = log(|q|/|p| at infinity)/T. The attacker follows some of them by Newton's method, and
takes the others from its own collocation of the history.
"""

from collections import Counter

import control as ct
import numpy as np
import pytest
from devices import body
from passivity.attacks.budget import attacked
from passivity.attacks.late_modes import count_growing

from teleopdesign.base.errors import UnstableLoop
from teleopdesign.blocks import hand
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, haptic_interface
from teleopdesign.frequency import delay_margin, gain_margin, loop_gain
from teleopdesign.passivity import claim_over_intervals


def rightmost(p, q, time):
    """Largest real part of the zeros of p + q e^(-s T) that are found, chains far out included."""

    def newton(s):
        for _ in range(60):
            late = np.exp(-s * time)
            f = np.polyval(p, s) + np.polyval(q, s) * late
            slope = np.polyval(np.polyder(p), s)
            slope = slope + (np.polyval(np.polyder(q), s) - time * np.polyval(q, s)) * late
            s = s - f / slope
        size = np.polyval(np.abs(p), np.abs(s)) + np.polyval(np.abs(q), np.abs(s)) * np.abs(
            np.exp(-s * time)
        )
        f = np.polyval(p, s) + np.polyval(q, s) * np.exp(-s * time)
        return s[(np.abs(f) < 1e-9 * size) & np.isfinite(s)]

    lead = q[0] / p[0] if len(q) == len(p) else 0.0
    starts = [*np.roots(p), *np.roots(np.polyadd(p, q))]
    if lead:
        turns = 2 * np.pi * np.arange(0, 4000, 7) + np.angle(-lead)
        starts += list((np.log(abs(lead)) + 1j * turns) / time)
    w = np.geomspace(1e-2, 1e4, 200)
    starts += list(1j * w) + list(-0.3 * w + 1j * w)
    with np.errstate(all="ignore"):
        zeros = newton(np.array(starts, dtype=complex))
    real = zeros.real.max(initial=-np.inf)
    return max(real, np.log(abs(lead)) / time) if lead else real


def law_loop(rng):
    """y = g (s + z)/(s + a) e^(-s T) (x - y) pushes a mass back: f of the loop and the mass."""
    a, z = (round(float(x), 2) for x in 10 ** rng.uniform(0, 2, 2))
    near = 1 + float(rng.choice([-1, 1])) * 10 ** rng.uniform(-4, -0.3)
    g, time = (
        round(float(rng.choice([near, rng.uniform(0.2, 0.95)])), 5),
        round(10 ** rng.uniform(-3, -1), 5),
    )
    m, b, k = 1.0, 30.0, 400.0
    law = from_control(ct.tf([g, g * z], [1.0, a])).then(controller("delay", {"time": time}))
    blocks = (
        Moving("M", body(m, viscous__damping=b, spring__stiffness=k), "x", "u", {"f": 1.0}, "f"),
        Control("C", law, "e", "y"),
    )
    sums = (Junction("e", {"x": 1.0, "y": -1.0}), Junction("u", {"y": -1.0}))
    diagram = Diagram("loop", blocks, sums, {"f": "force"}, ("x",))
    # (m s^2 + b s + k) x = -y, y (1 + L) = L x: (Z + (Z + 1) L) = 0
    plant, lag, lead = np.array([m, b, k]), np.array([1.0, a]), np.array([g, g * z])
    return diagram, np.polymul(plant, lag), np.polymul(np.polyadd(plant, [1.0]), lead), time


def late_feedback(rng):
    """Force feedback behind a dead time, in a hand with mass: L -> g m_h/(m_h + m)."""
    m, held = round(float(rng.uniform(0.05, 0.3)), 3), round(float(rng.uniform(0.02, 0.3)), 3)
    limit = (m + held) / held
    near = 1 + float(rng.choice([-1, 1])) * 10 ** rng.uniform(-4, -0.3)
    g, time = round(limit * near, 4), round(10 ** rng.uniform(-4, -2), 6)
    law = controller("gain", {"gain": g}).then(controller("delay", {"time": time}))
    device = body(m, viscous__damping=1.0, spring__stiffness=100.0)
    grip = hand(mass=held, damping=2.0, stiffness=100.0)
    diagram = haptic_interface(device, hand=grip, force_feedback=law, analog=("H",))
    # (Z_M + (1 + H) Z_H) L = 0 with R_D = 0: R_A = -H R_M, R_M = Z_H L
    z_m, z_h = np.array([m, 1.0, 100.0]), np.array([held, 2.0, 100.0])
    return diagram, np.polyadd(z_m, z_h), g * z_h, time


@attacked(3, 60)
def test_no_margin_overlooks_a_chain_of_modes_far_out(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for k in range(number):
        diagram, p, q, time = (law_loop, late_feedback)[k % 2](rng)
        claim = claim_over_intervals(diagram, {}, claim="stable", points=0)
        true, growing = -rightmost(p, q, time), count_growing([(p, 0.0), (q, time)])
        chain = -np.log(abs(q[0] / p[0])) / time
        if chain < 0 or growing:
            assert claim.status != "proved", (diagram, true, claim)
        if claim.status == "proved":
            assert claim.margin <= true * 1.0011, (diagram, true, claim)
            assert claim.margin >= 0.998 * min(true, chain), (diagram, true, claim)
        loop = loop_gain(diagram, controller="C" if k % 2 == 0 else "H")
        try:
            factor, late = gain_margin(loop), delay_margin(loop)
        except UnstableLoop:
            assert growing != 0 or chain <= 0
            counts["unstable"] += 1
            continue
        assert growing == 0 and factor <= abs(p[0] / q[0]) * (1 + 1e-6) and late >= 0
        counts[claim.status] += 1
    print(dict(counts))
    assert counts["proved"] and counts["unstable"]


@pytest.mark.parametrize(("above", "below"), [([-1.0, 1.0], [1.0, 3.0]), ([-2.0, 5.0], [2.0, 9.0])])
def test_a_loop_of_gain_minus_one_at_high_frequency_is_proved_nothing(above, below):
    """1 + L = 4/(s + 3): no pole, until the gain is not exactly -1 at high frequency."""
    law = from_control(ct.tf(above, below))
    blocks = (
        Moving("M", body(1.0, viscous__damping=30.0, spring__stiffness=400.0), "x", "u",
               {"f": 1.0}, "f"),
        Control("C", law, "e", "y"),
    )  # fmt: skip
    sums = (Junction("e", {"x": 1.0, "y": -1.0}), Junction("u", {}))
    diagram = Diagram("loop", blocks, sums, {"f": "force"}, ("x",))
    claim = claim_over_intervals(diagram, {}, claim="stable")
    assert claim.status == "unknown" and "gain -1 at high frequency" in claim.how
    for margin in (gain_margin, delay_margin):
        with pytest.raises(UnstableLoop, match="-1 at high frequency"):
            margin(loop_gain(diagram, controller="C"))
    near = from_control(ct.tf([0.999 * above[0], above[1]], below))
    assert gain_margin(loop_gain(diagram.with_block("C", near), controller="C")) < 1.0011
