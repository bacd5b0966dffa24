"""The impedance that a hand feels against equations that the attacker solves by numbers.

    motor   (m - m_t) s^2 x + (b s + k) x + (K + C s)(x - y) = H F + G x
    tip     m_t s^2 y + (K + C s)(y - x) = F

F is the hand's force on the device, H the force feedback, G the cancellation; without a tip both
sides are one. What the equations leave out is to be named as left out.
"""

from collections import Counter

import control as ct
import numpy as np
from devices import body
from passivity.attacks.budget import attacked

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import hand_port, positive_real

NO_LINEAR_FORM = {
    "coulomb": {"level": 0.4},
    "quadratic_drag": {"drag": 2.0},
    "cogging": {"amplitude": 0.1, "period": 0.01, "phase": 0.3},
}


def pick(rng, low, high):
    return float(f"{10 ** rng.uniform(low, high):.4g}")


def polynomial(rng, degree):
    """A random one whose roots decay."""
    roots = -(10 ** rng.uniform(-1, 2, degree))
    return [float(f"{c:.5g}") for c in np.atleast_1d(np.poly(roots)) * 10 ** rng.uniform(-1, 1)]


def law(rng):
    """(controller, its response to s)."""
    kind = rng.choice(["gain", "low-pass", "spring and damper", "python-control", "in series"])
    g, corner = pick(rng, -1, 1), pick(rng, -1, 2)
    low = controller("low_pass", {"bandwidth": corner})
    if kind == "gain":
        return controller("gain", {"gain": g}), lambda s: g + 0 * s
    if kind == "low-pass":
        made = low.then(controller("gain", {"gain": g}))
        return made, lambda s: g / (1 + s / (2 * np.pi * corner))
    if kind == "spring and damper":
        c = pick(rng, -3, 0)
        values = {"stiffness": g, "damping": c, "bandwidth": corner}
        made = controller("proportional_derivative", values)
        return made, lambda s: g + c * s / (1 + s / (2 * np.pi * corner))
    n = int(rng.integers(1, 4))
    p, q = polynomial(rng, int(rng.integers(0, n + 1))), polynomial(rng, n)
    p = [float(rng.choice([1, 1, -1])) * c for c in p]
    made = from_control(ct.tf(p, q), name="law")
    if kind == "in series":
        return made.then(
            low
        ), lambda s: np.polyval(p, s) / np.polyval(q, s) / (1 + s / (2 * np.pi * corner))
    return made, lambda s: np.polyval(p, s) / np.polyval(q, s)


def random_port(rng):
    """(diagram, force over velocity at s, names of what has no linear form)."""
    m, b, k = pick(rng, -3, 1), pick(rng, -2, 2), pick(rng, -1, 3) * int(rng.integers(0, 2))
    device = {"viscous__damping": b} | ({"spring__stiffness": k} if k else {})
    bent = [n for n in NO_LINEAR_FORM if rng.random() < 0.2]
    device |= {f"{n}__{p}": x for n in bent for p, x in NO_LINEAR_FORM[n].items()}
    tip = None
    if rng.random() < 0.4:
        tip = m * float(f"{rng.uniform(0.01, 0.9):.3g}"), pick(rng, 1, 5), pick(rng, -2, 2)
        names = ("tip_inertia", "stiffness", "damping")
        device |= {f"transmission_compliance__{n}": x for n, x in zip(names, tip, strict=True)}
    values, feedback, cancels = {}, (lambda s: 0 * s), (lambda s: 0 * s)
    if rng.random() < 0.7:
        values["force_feedback"], feedback = law(rng)
    if rng.random() < 0.5:
        values["cancellation"], cancels = law(rng)
    diagram = haptic_interface(body(m, **device), **values, analog=("C", "H"))

    def z(s):
        rest, drive = b * s + k - cancels(s), feedback(s)
        if tip is None:
            return (m * s**2 + rest) / (1 + drive) / s
        m_t, stiff, damp = tip
        joint = stiff + damp * s
        motor = (m - m_t) * s**2 + rest + joint
        # the motor's motion per force: x (motor - joint^2/(m_t s^2 + joint)) = drive + joint/(...)
        held = m_t * s**2 + joint
        x = (drive + joint / held) / (motor - joint**2 / held)
        y = (1 + joint * x) / held
        return 1 / y / s

    return diagram, z, {f"Z_M.{n}" for n in bent}


@attacked(4, 40)
def test_a_hand_feels_the_impedance_that_the_equations_have(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        diagram, z, bent = random_port(rng)
        impedance, left_out = hand_port(diagram)
        assert set(left_out) == bent, (diagram, left_out)
        w = 10 ** rng.uniform(-3, 5, 60)
        s = w * np.exp(1j * rng.uniform(-np.pi / 2, np.pi / 2, 60))
        expected = z(s)
        # sums of terms of opposite sign leave less: eight digits of sixteen
        assert np.abs(impedance(s) - expected).max() <= 1e-8 * np.abs(expected).max()
        assert (np.abs(impedance(s) - expected) <= 1e-6 * np.abs(expected)).all(), diagram
        claim = positive_real(impedance)
        active = expected.real < -1e-9 * np.abs(expected)
        assert not (claim.status == "proved" and active.any()), (diagram, s[active])
        counts[claim.status, bool(active.any())] += 1
    print(dict(counts))
    assert counts["proved", False] and (counts["refuted", True] or number < 40)
