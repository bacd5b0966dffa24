"""Small diagrams, and how far their claims are from failing by plain polynomials of numpy."""

import numpy as np
from devices import body

import teleopdesign as td

HAND = td.hand(mass=0.1, damping=5.0, stiffness=300.0)


def interface():
    law = td.controller("low_pass", {"bandwidth": 20.0})
    law = law.then(td.controller("gain", {"gain": 1.0}))
    device = body(0.15, viscous__damping=4.0, spring__stiffness=100.0)
    return td.haptic_interface(device, force_feedback=law, hand=HAND)


def teleoperator():
    numbers = {"stiffness": 300.0, "damping": 2.0, "bandwidth": 50.0}
    side = body(0.15, viscous__damping=2.0)
    coupling = td.controller("proportional_derivative", numbers)
    return td.teleoperator(side, side, coupling=coupling, hand=HAND)


DIAGRAMS = {"interface": interface(), "teleoperator": teleoperator()}


def failure(name, values, claim):
    """How far the claim is from failing there, by its own formulas: < 0 where it fails."""
    v = values
    w = np.geomspace(1e-3, 1e5, 4001)
    s = 1j * w
    if name == "interface":
        a = 2 * np.pi * v["H.low_pass.bandwidth"]
        device = [v["Z_M.inertia"], v["Z_M.viscous.damping"], v["Z_M.spring.stiffness"]]
        with_force = [1 / a, 1 + v["H.gain.gain"]]  # 1 + g/(1 + s/a), times 1 + s/a
        if claim == "stable":
            hand = [v["Z_H.inertia"], v["Z_H.viscous.damping"], v["Z_H.spring.stiffness"]]
            polynomial = np.polyadd(np.polymul(device, [1 / a, 1]), np.polymul(hand, with_force))
            return -np.roots(polynomial).real.max()
        z = np.polyval(device, s) / s * (1 + s / a) / np.polyval(with_force, s)
        return z.real.min()  # its poles are 0 and -a (1 + g)
    tau = 1 / (2 * np.pi * v["P.proportional_derivative.bandwidth"])
    k, b = (v[f"P.proportional_derivative.{n}"] for n in ("stiffness", "damping"))
    law, lag = [k * tau + b, k], [tau, 1]  # K + B s/(1 + tau s)
    master, slave = ([v[f"Z_{i}.inertia"], v[f"Z_{i}.viscous.damping"], 0] for i in "ms")
    if claim == "stable":
        hand = [v["Z_H.inertia"], v["Z_H.viscous.damping"], v["Z_H.spring.stiffness"]]
        held = np.polyadd(master, hand)
        both = np.polymul(np.polymul(held, slave), lag)
        return -np.roots(np.polyadd(both, np.polymul(np.polyadd(held, slave), law))).real.max()
    c = np.polyval(law, s) / np.polyval(lag, s) / s
    z1, z2 = (np.polyval(one, s) / s + c for one in (master, slave))
    if claim == "passive":
        z = np.array([[z1, -c], [-c, z2]]).transpose(2, 0, 1)
        return np.linalg.eigvalsh((z + z.conj().transpose(0, 2, 1)) / 2)[:, 0].min()
    loop = c * c
    if min(z1.real.min(), z2.real.min()) < 0:
        return -np.inf
    return ((2 * z1.real * z2.real - loop.real) / np.abs(loop) - 1).min()
