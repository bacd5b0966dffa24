"""Claims and margins on systems of python-control with states that their transfer functions lack.

Each system is drawn with up to three states that no input reaches or that no output shows, exactly
or but for a share of 1e-2 to 1e-12, behind a change of coordinates in whole numbers. The attacker
has the full state matrix: its eigenvalues, held by springs and dampers of its own, are the truth.
"""

from collections import Counter

import control as ct
import numpy as np
from devices import body
from passivity.attacks.budget import attacked

from teleopdesign.base.errors import ModelError, UnstableLoop
from teleopdesign.controllers import from_control
from teleopdesign.diagrams import (
    Control,
    Diagram,
    Junction,
    Moving,
    coupled_plant_parts,
    plant_parts,
)
from teleopdesign.frequency import delay_margin, gain_margin, loop_gain, phase_margin
from teleopdesign.passivity import (
    absolutely_stable,
    claim_over_intervals,
    passive,
    ports,
    positive_real,
    two_port,
)
from teleopdesign.passivity.linear_diagrams import linear_claims

POLES = (-2.0, -0.5, -0.5, 0.0, 0.5, 1.0)
#: real part of a pole beyond which it is not rounding of a multiple pole on the axis
GROWS = 1e-5


def hidden_states(rng, n, inputs, outputs):
    """A, B, C of hidden states beside n others, and the blocks that couple them; halves alone."""
    m = int(rng.integers(0, 4))
    a = np.diag(rng.choice(POLES, m)) + np.triu(rng.integers(-1, 2, (m, m)) / 2.0, 1)
    reached = rng.random(m) < 0.5
    share = 0.0 if rng.random() < 0.6 else 10.0 ** -int(rng.integers(2, 13))
    b = rng.integers(-2, 3, (m, inputs)) / 2.0
    c = rng.integers(-2, 3, (outputs, m)) / 2.0
    for i in range(m):  # upper triangular: what is reached must come after what is shown
        reached[i] = reached[i] and not any(not r for r in reached[:i])
    b[~reached] *= share
    c[:, reached] *= share
    return a, b, c, share


def scrambled(rng, a, b, c):
    """The system in other coordinates, by elementary steps in whole numbers: exactly the same."""
    n = len(a)
    t, back = np.eye(n), np.eye(n)
    for _ in range(n if n > 1 else 0):
        i, j = rng.choice(n, 2, replace=False)
        step, undo = np.eye(n), np.eye(n)
        w = float(rng.integers(-1, 2))
        step[i, j], undo[i, j] = w, -w
        t, back = step @ t, back @ undo
    return t @ a @ back, t @ b, c @ back


def beside(rng, a, b, c):
    """The system with hidden states, scrambled; and the poles and the share of these."""
    h, bh, ch, share = hidden_states(rng, len(a), b.shape[1], c.shape[0])
    whole = np.block([[a, np.zeros((len(a), len(h)))], [np.zeros((len(h), len(a))), h]])
    made = scrambled(rng, whole, np.vstack([b, bh]), np.hstack([c, ch]))
    return *made, np.linalg.eigvals(h) if len(h) else np.zeros(0), share


def masses(rng, axes):
    """Force to position of masses on springs and dampers: A, B, C."""
    m = np.diag(rng.choice([0.5, 1.0, 2.0], axes))
    root = rng.integers(0, 3, (axes, axes)) / 1.0
    k, d = root @ root.T + np.eye(axes), np.diag(rng.choice([0.5, 1.0, 4.0], axes))
    zero, one = np.zeros((axes, axes)), np.eye(axes)
    inverse = np.linalg.inv(m)
    a = np.block([[zero, one], [-inverse @ k, -inverse @ d]])
    return a, np.vstack([zero, inverse]), np.hstack([one, zero])


def fastest(rng, a, b, c, tries=60):
    """Largest real part of the poles, free and between springs and dampers of every size."""
    n, axes = len(a), b.shape[1]
    worst = np.linalg.eigvals(a).real.max()
    for _ in range(tries):
        spring, damper = 10 ** rng.uniform(-2, 2, (2, axes))
        # y' = C A x + C B u, with C B = 0 up to what is hidden: the damper acts on C A x
        back = np.diag(spring) @ c + np.diag(damper) @ (c @ a)
        worst = max(worst, np.linalg.eigvals(a - b @ back).real.max())
    assert n == len(a)
    return worst


def plant(a, b, c):
    axes = b.shape[1]
    system = ct.ss(a, b, c, np.zeros((axes, axes)))
    names = [[f"{x}{i}" for i in range(axes)] for x in ("x", "u", "f")]
    if axes == 1:
        motion, command, driver = (x[0] for x in names)
        parts, sums = plant_parts(system, name="P", motion=motion, command=command, driver=driver)
    else:
        parts, sums = coupled_plant_parts(
            system, name="P", motions=names[0], commands=names[1], drivers=names[2]
        )
    nothing = tuple(Junction(u, {}) for u in names[1])
    outside = dict.fromkeys(names[2], "force")
    return Diagram("plant", tuple(parts), (*sums, *nothing), outside, tuple(names[0]))


def expected(poles, share):
    """Whether the hidden states decay; None where they are not quite hidden."""
    return None if share else bool((poles.real < -GROWS).all())


def rests(a, c, poles):
    """Whether all hidden states that do not decay only displace the ports, which then stand still.

    The bodies are held by springs, so all poles at 0 are hidden.
    """
    _, sizes, rows = np.linalg.svd(a)
    still = rows[np.append(sizes, np.zeros(len(rows) - len(sizes))) < 1e-9].T
    slow = poles[poles.real >= -GROWS]
    return bool((np.abs(slow) < GROWS).all()) and len(slow) == np.linalg.matrix_rank(c @ still)


@attacked(10, 25)
def test_no_hidden_state_of_a_plant_is_forgotten(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for k in range(number):
        a, b, c, poles, share = beside(rng, *masses(rng, 1 + k % 2))
        try:
            diagram = plant(a, b, c)
        except ModelError as problem:  # a force that moves a position at once, or no mass
            counts["refused"] += 1
            assert share or "no state space of decimals" in str(problem)
            continue
        claims = [one.claim.status for one in linear_claims(diagram, ports(diagram))]
        stable = claim_over_intervals(diagram, {}, claim="stable", points=0).status
        truth, decays = fastest(rng, a, b, c), expected(poles, share)
        if truth > GROWS:
            assert "proved" not in claims and stable != "proved", (a, b, c)
        if decays is False:
            assert stable != "proved", (a, b, c)
            assert ("proved" in claims) <= rests(a, c, poles), (a, b, c)
        if decays:
            assert set(claims) == {"proved"} == {stable}, (a, b, c)
        counts[decays, claims[0], stable] += 1
    print(dict(counts))
    assert counts[True, "proved", "proved"] and counts[False, "unknown", "refuted"]


@attacked(8, 60)
def test_no_hidden_state_of_an_impedance_is_forgotten(seed, number):
    """Dampers with states of their own, one port or two: Z = D + C (s I - A)^-1 C^T is passive."""
    rng, counts = np.random.default_rng(seed), Counter()
    for k in range(number):
        axes, n = 1 + k % 2, int(rng.integers(1, 3))
        root, c = rng.integers(-2, 3, (n, n)) / 2.0, rng.integers(-2, 3, (axes, n)) / 2.0
        a, b, c, poles, share = beside(rng, -(root @ root.T) - np.eye(n), c.T, c)
        system = ct.ss(a, b, c, np.eye(axes))
        claims = [positive_real(system)] if axes == 1 else [passive(two_port(system))]
        claims += [absolutely_stable(two_port(system))] if axes == 2 else []
        statuses, decays = {claim.status for claim in claims}, expected(poles, share)
        grows = np.linalg.eigvals(a - b @ np.linalg.inv(np.eye(axes) * 2) @ c).real.max() > GROWS
        if grows or decays is False:
            assert "proved" not in statuses, (a, b, c)
        if decays:
            assert statuses == {"proved"}, (a, b, c)
        counts[decays, claims[0].status] += 1
    print(dict(counts))
    assert counts[True, "proved"] and counts[False, "unknown"]


def looped(rng, discrete):
    """A mass on a spring, a law with hidden states, and its loop; the matrix of all states."""
    (a, b, c), h = masses(rng, 1), 0.1
    d = float(rng.choice([0.25, 0.5]))
    law = (np.array([[-1.0]]), np.array([[1.0]]), np.array([[d]]))
    if discrete:
        law = (np.array([[0.5]]), np.array([[1.0]]), np.array([[d]]))
    la, lb, lc, poles, share = beside(rng, *law)
    made = ct.ss(la, lb, lc, 0.0, h) if discrete else ct.ss(la, lb, lc, 0.0)
    mass = body(
        1 / b[1, 0], viscous__damping=-a[1, 1] / b[1, 0], spring__stiffness=-a[1, 0] / b[1, 0]
    )
    blocks = (
        Moving("M", mass, "x", "u", {"f": 1.0}, "f"),
        Control("C", from_control(made), "x", "p"),
    )
    diagram = Diagram("loop", blocks, (Junction("u", {"p": -1.0}),), {"f": "force"}, ("x",))
    if discrete:
        held = ct.sample_system(ct.ss(a, b, c, 0.0), h)
        a, b, c = held.A, held.B, held.C
    whole = np.block([[a, -b @ lc], [lb @ c, la]])
    modes = np.linalg.eigvals(whole)
    # a sample is as good a unit as any: three equal poles on the circle come out 1e-5 beside it
    return diagram, np.abs(modes).max() - 1 if discrete else modes.real.max(), poles, share


@attacked(4, 40)
def test_a_loop_with_a_hidden_mode_that_grows_has_no_margin(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for k in range(number):
        diagram, fastest_mode, _, share = looped(rng, discrete=bool(k % 2))
        loop = loop_gain(diagram, controller="C")
        margins = []
        for margin in (delay_margin, gain_margin, phase_margin):
            try:
                margins.append(margin(loop))
            except UnstableLoop:
                margins.append(None)
        if fastest_mode > GROWS:
            assert margins == [None] * 3, (diagram, fastest_mode, margins)
        elif fastest_mode < -GROWS and not share:
            assert None not in margins, (diagram, fastest_mode, margins)
        counts[bool(fastest_mode > GROWS), margins[0] is None] += 1
    print(dict(counts))
    assert counts[True, True] and counts[False, False]
