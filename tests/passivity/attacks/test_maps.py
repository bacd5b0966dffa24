"""Maps of margins against terminations and motions at each of their frequencies.

The attacker writes down the four channels' equations, solves them by numbers with exact delays, and
holds one port by reactances: what is then felt at the other one gives out energy or does not.
"""

from collections import Counter

import control as ct
import numpy as np
import pytest
from devices import body
from passivity.attacks.budget import attacked

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import four_channel
from teleopdesign.passivity import margin_map

#: Hz; few enough to hold a port by many reactances at each
F = np.geomspace(0.02, 200, 61)


def law(rng, kind, size):
    """(controller, its response to s) of about that size."""
    size = float(size)
    if kind == "gain":
        return controller("gain", {"gain": size}), lambda s: size + 0 * s
    corner = float(10 ** rng.uniform(0, 2))
    if kind == "low_pass":
        made = controller("low_pass", {"bandwidth": corner}).then(
            controller("gain", {"gain": size})
        )
        return made, lambda s: size / (1 + s / (2 * np.pi * corner))
    if kind == "integral":
        made = controller("proportional_integral", {"gain": size, "rate": corner})
        return made, lambda s: size * (1 + corner / s)
    if kind == "python-control":
        made = from_control(ct.tf([size, size * corner], [1, 3 * corner]), name="law")
        return made, lambda s: size * (s + corner) / (s + 3 * corner)
    damping = size * float(10 ** rng.uniform(-3, -1))
    values = {"stiffness": size, "damping": damping, "bandwidth": corner}
    made = controller("proportional_derivative", values)
    return made, lambda s: size + damping * s / (1 + s / (2 * np.pi * corner))


def random_device(rng, *, gentle):
    """A four-channel device, its impedance matrix (n, 2, 2) at s, and stiffness of its master.

    gentle: one spring both ways, delays that the dampers of the bodies bear
    """
    m = 10 ** rng.uniform(-2, 0.5, 2)
    b, k = 10 ** rng.uniform(-1, 1.5, 2), 10 ** rng.uniform(0, 2.5, 2) * rng.integers(0, 2, 2)
    bodies = [
        body(float(x), viscous__damping=float(y), **({"spring__stiffness": float(z)} if z else {}))
        for x, y, z in zip(m, b, k, strict=True)
    ]
    stiff = 10 ** rng.uniform(1, 3.5)
    laws = [law(rng, "proportional_derivative", stiff * 10 ** rng.uniform(-1, 0.5)) for _ in "ms"]
    kinds = ("gain", "proportional_derivative", "low_pass", "integral", "python-control")
    channels = {"C_1": law(rng, str(rng.choice(kinds)), stiff)}
    channels["C_2"] = law(rng, "gain", 0.5)
    if rng.random() < 0.7:
        channels["C_4"] = law(rng, str(rng.choice(kinds)), stiff)
    if rng.random() < 0.5:
        channels["C_3"] = law(rng, "low_pass", rng.uniform(0, 1))
    delays = {n: float(rng.choice([0, 10 ** rng.uniform(-3, -1)])) for n in channels}
    position, force = (float(10 ** rng.uniform(-0.5, 0.5)) for _ in range(2))
    if gentle:
        laws = [laws[0], laws[0]]
        channels |= {"C_1": laws[0], "C_4": laws[0]}
        channels.pop("C_3", None)
        longest = b.min() / laws[0][0].stages[0].values["stiffness"]
        delays = {n: float(longest * rng.uniform(0, 1.2)) for n in channels}
    diagram = four_channel(
        *bodies,
        master_control=laws[0][0],
        slave_control=laws[1][0],
        channels={n: c for n, (c, _) in channels.items()},
        delay=delays,
        position_scale=position,
        force_scale=force,
    )
    scales = {"C_1": position, "C_2": force, "C_3": 1 / force, "C_4": 1 / position}
    law_stiffness = diagram.values["C_m.proportional_derivative.stiffness"]

    def impedance(s, gain, stiffness):
        """(Z + C) x = F + late channels, solved for F, per velocity."""
        c = {n: scales[n] * np.exp(-s * delays[n]) * f(s) for n, (_, f) in channels.items()}
        c["C_2"] = c["C_2"] * gain / 0.5
        zm, zs = (m[i] * s**2 + b[i] * s + k[i] for i in range(2))
        zm = zm + laws[0][1](s) + stiffness - law_stiffness
        zs = zs + laws[1][1](s)
        nothing, one = 0 * s, 1 + 0 * s
        left = np.moveaxis(
            np.array([[zm, -c.get("C_4", nothing)], [-c["C_1"], zs]]), (0, 1), (-2, -1)
        )
        right = np.moveaxis(
            np.array([[one, c["C_2"]], [c.get("C_3", nothing), one]]), (0, 1), (-2, -1)
        )
        return np.linalg.solve(right, left) / s[:, None, None]

    return diagram, impedance, law_stiffness


def felt(z, reactance):
    """What port 1 feels with port 2 held by j reactance (..., n), its real part against its size.

    Held on the axis by less than nothing in turn: a large reactance clamps port 2
    """
    at = z[:, 0, 0] - z[:, 0, 1] * z[:, 1, 0] / (z[:, 1, 1] + 1j * reactance)
    return at.real / np.abs(z[:, 0, 0])


def least_felt(rng, z):
    """Over both ports and many reactances, refined about the worst of each: (n,), 1; < 0 active."""
    least = np.full(len(z), np.inf)
    for turned in (z, z[:, ::-1, ::-1]):
        size = np.abs(turned[:, 1, 1]) + np.abs(turned[:, 0, 1] * turned[:, 1, 0] / turned[:, 0, 0])
        spread = np.concatenate([np.tan(np.linspace(-1.57, 1.57, 801)), [1e12]])
        tries = size * spread[:, None] - turned[:, 1, 1].imag
        for _ in range(4):
            values = felt(turned, tries)
            best = np.argmin(values, axis=0)
            at = np.take_along_axis(tries, best[None], 0)[0]
            width = np.abs(np.gradient(tries, axis=0))
            beside = np.take_along_axis(width, best[None], 0)[0]
            least = np.minimum(least, values.min(axis=0))
            tries = at + beside * np.linspace(-2, 2, 201)[:, None]
    return least


@attacked(0, 12)
def test_each_point_of_a_map_is_what_terminations_and_motions_show(seed, number):
    """Sixteen systems in a map: negative where some reactance makes a port active, else nowhere."""
    rng, counts = np.random.default_rng(seed), Counter()
    for one in range(number):
        diagram, impedance, stiffness = random_device(rng, gentle=one % 2 == 0)
        gains = 10 ** rng.uniform(-6, 0, 4)
        springs = stiffness * 10 ** rng.uniform(-0.5, 1, 4)
        names = ("C_2.gain.gain", "C_m.proportional_derivative.stiffness")
        margins = margin_map(diagram, dict(zip(names, (gains, springs), strict=True)), frequency=F)
        for i, gain in enumerate(gains):
            for k, spring in enumerate(springs):
                z = impedance(2j * np.pi * F, gain, spring)
                point = margins.data.isel({names[0]: i, names[1]: k})
                case = diagram, gain, spring
                counts[contradiction(rng, z, point, case)] += 1
    print(dict(counts))
    assert counts["negative"] and counts["not negative"]


def contradiction(rng, z, point, case=()):
    """Attack a point of a map; which sign it has."""
    llewellyn, passive = float(point["llewellyn"]), float(point["passive"])
    at = int(np.argmin(np.abs(F - float(point["frequency"]))))
    least = least_felt(rng, z)
    if llewellyn < 0:
        assert least[at] < 1e-9, case  # at the frequency that the map names
    else:
        assert least.min() > -1e-9, case
    v = rng.standard_normal((2000, 1, 2)) + 1j * rng.standard_normal((2000, 1, 2))
    size = np.abs(z).max()
    for step in (1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001):
        power = np.einsum("afi,fij,afj->af", v.conj(), z, v).real / (np.abs(v) ** 2).sum(axis=2)
        assert power.min() > passive - 1e-9 * size, case
        best = np.unravel_index(np.argmin(power), power.shape)[0]
        turned = rng.standard_normal((2000, 1, 2)) + 1j * rng.standard_normal((2000, 1, 2))
        v = v[best] + step * turned
    # the eigenvector is found within the last step's square
    assert power.min() < passive + 1e-3 * max(abs(passive), size), case
    return "negative" if llewellyn < 0 else "not negative"


@pytest.mark.parametrize(
    ("name", "by"), [("llewellyn", -2.0), ("llewellyn", 2.0), ("passive", 1.0)]
)
def test_the_attack_beats_a_map_that_is_wrong(name, by):
    """Of a spring both ways: signs turned, or a margin higher than the least eigenvalue."""
    rng = np.random.default_rng(1)
    for kept in (20.0, 0.1):  # dampers about a spring that is late: one stable, one not
        s = 2j * np.pi * F
        late = 50 / s * np.exp(-0.02 * s)
        z = np.moveaxis(np.array([[kept + 50 / s, -late], [-late, kept + 50 / s]]), 2, 0)
        r, loop = z[:, 0, 0].real, late**2
        margin = (2 * r * r - loop.real) / np.abs(loop) - 1
        least = np.linalg.eigvalsh((z + z.conj().swapaxes(1, 2)) / 2)[:, 0].min()
        point = {"llewellyn": margin.min(), "passive": least, "frequency": F[np.argmin(margin)]}
        contradiction(rng, z, point)
        wrong = by * abs(point[name]) if name == "llewellyn" else point[name] + by
        if np.sign(wrong) != np.sign(point[name]) or name == "passive":
            with pytest.raises(AssertionError):
                contradiction(rng, z, {**point, name: wrong})
