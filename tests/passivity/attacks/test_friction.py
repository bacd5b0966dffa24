"""Claims on friction and its cancellation against motions that are drawn, and climbed from there.

Each attacker starts from rest without preload, where a passive device can give out nothing at all:
every motion that gives out more than rounding contradicts a proof.
"""

from collections import Counter

import numpy as np
from passivity.attacks.budget import attacked, climbed, near
from passivity.attacks.friction import bristle, drawn, largest

from teleopdesign.passivity import (
    any_environment,
    dahl_compensation,
    free_motion,
    largest_one_off_energy,
    largest_passive_level,
    largest_ratio,
    lugre_passivity,
    onset_amplitude,
    sampled_compensation,
    velocity_compensation,
)

MOTIONS, LEGS = 400, 12
#: share of the energy turned over, at most level times travel, that rounding may leave
ROUNDING = 1e-9


def coulomb(low, high):
    return lambda f, x, v, share: (f, (low + share * (high - low)) * np.abs(x))


def dahl(low, high, stiffness):
    return lambda f, x, v, share: bristle(f, x, low + share * (high - low), stiffness)


def with_damping(part, b):
    def both(f, x, v, share):
        f, work = part(f, x, v, share)
        return f, work + b * v * np.abs(x)

    return both


def gain(rng, helped, resisted, level, lengths, speeds=(1.0,), rounds=40):
    """Largest energy given out over level times the longest path, dimensionless; the motion."""

    def share(motions):
        turned = level * np.abs(motions[:, :, 0]).sum(axis=1)
        return largest(motions, helped, resisted) / turned

    return climbed(rng, share, drawn(rng, MOTIONS, LEGS, lengths, speeds), rounds=rounds)[0]


def counted(number, judge, rng, *, least_ratio=2.0):
    """Statuses with whether the attack found energy; fails where the attack is blind.

    least_ratio: of refuted systems that the attack refutes too to those that it does not: those a
    hair beyond their limit need motions that are longer, or more exact, than it draws
    """
    counts = Counter()
    for _ in range(number):
        status, counterexample = judge(rng)
        counts[status, bool(counterexample > ROUNDING)] += 1
        assert status != "proved" or counterexample <= ROUNDING
    print(dict(counts))
    assert counts["proved", False] >= number / 8
    # of so many as are refuted, less three standard deviations of what chance makes of that share
    refuted = counts["refuted", True] + counts["refuted", False]
    expected = refuted * least_ratio / (1 + least_ratio)
    assert counts["refuted", True] >= expected - 3 * np.sqrt(expected)


def dahl_pair(rng):
    force, length = 10.0 ** rng.uniform(-6, 6, 2)
    f_c = force
    top = f_c * (1 + (rng.random() < 0.5) * 10 ** rng.uniform(-3, 0.3))
    gives = rng.random() < 0.7
    f_d = near(rng, f_c) if rng.random() < 0.5 else f_c * rng.uniform(0.1, 1)
    sigma_p = force / length
    sigma_d = near(rng, sigma_p * np.sqrt(f_d / top))
    claim = dahl_compensation(
        coulomb_level=f_c, compensator_level=f_d, compensator_stiffness=sigma_d,
        presliding_stiffness=sigma_p if gives else None, highest_level=top if gives else None,
    )  # fmt: skip
    resisted = dahl(f_c, top, sigma_p) if gives else coulomb(f_c, f_c)
    lengths = [f_d / sigma_d, *([f_c / sigma_p] if gives else [])]
    return claim.status, gain(rng, dahl(f_d, f_d, sigma_d), resisted, f_d, lengths)


@attacked(4, 30)
def test_no_motion_beats_a_dahl_compensator_that_is_proved_passive(seed, number):
    counted(number, dahl_pair, np.random.default_rng(seed), least_ratio=1.0)


def velocity_law(f_d, a):
    def helped(f, x, v, share):
        return f, (f_d * v / (a + v) if a else f_d) * np.abs(x)

    return helped


def velocity_pair(rng):
    force, length, time = 10.0 ** rng.uniform(-6, 6, 3)
    speed = length / time
    gives = rng.random() < 0.5
    a = speed * 10 ** rng.uniform(-1, 1) * (rng.random() < 0.8)
    b = force / speed * 10 ** rng.uniform(-1, 1) * (rng.random() < 0.8)
    limit = (np.sqrt(0 if gives else force) + np.sqrt(a * b)) ** 2
    f_d = near(rng, limit) if limit else force
    stiffness = force / length if gives else None
    claim = velocity_compensation(
        coulomb_level=force, compensator_level=f_d, smoothing_velocity=a, viscous_damping=b,
        presliding_stiffness=stiffness,
    )  # fmt: skip
    friction = dahl(force, force, stiffness) if gives else coulomb(force, force)
    speeds = [speed, *([np.sqrt(a * f_d / b)] if a and b else []), *([a] if a else [])]
    ratio = gain(rng, velocity_law(f_d, a), with_damping(friction, b), f_d, [length], speeds)
    return claim.status, ratio


@attacked(4, 30)
def test_no_motion_beats_a_law_of_velocity_that_is_proved_passive(seed, number):
    counted(number, velocity_pair, np.random.default_rng(seed), least_ratio=1.0)


def sampled_velocity_pair(rng):
    """In a computer: the command of an earlier sample's travel, T = 1; each travel of one sign."""
    force, length = 10.0 ** rng.uniform(-6, 6, 2)
    gives, late = rng.random() < 0.5, int(rng.integers(3))
    a, b = length * 10 ** rng.uniform(-1, 1), force / length * 10 ** rng.uniform(-1, 1)
    f_d = near(rng, (np.sqrt(0 if gives else force) + np.sqrt(a * b)) ** 2)
    stiffness = force / length if gives else None
    claim = velocity_compensation(
        coulomb_level=force, compensator_level=f_d, smoothing_velocity=a, viscous_damping=b,
        presliding_stiffness=stiffness, sample_time=1, late=late,
    )  # fmt: skip
    friction = dahl(force, force, stiffness) if gives else coulomb(force, force)

    def share(travels):
        x = travels.reshape(len(travels), -1)
        state, out, most = np.zeros(len(x)), np.zeros(len(x)), np.full(len(x), -np.inf)
        for k in range(x.shape[1]):
            e = x[:, k - 1 - late] if k > late else np.zeros(len(x))
            state, took = friction(state, x[:, k], 1.0, 0.0)
            out = out + f_d * e / (a + np.abs(e)) * x[:, k] - took - b * x[:, k] ** 2
            most = np.maximum(most, out)
        return most / (f_d * np.abs(x).sum(axis=1))

    start = drawn(rng, MOTIONS, 24, [length, np.sqrt(a * f_d / b)])[:, :, 0]
    start[: MOTIONS // 3] = np.abs(start[: MOTIONS // 3, :1])  # at one speed
    return claim.status, climbed(rng, share, start, rounds=25)[0]


@attacked(4, 30)
def test_no_samples_beat_a_law_of_velocity_that_is_proved_in_a_computer(seed, number):
    counted(number, sampled_velocity_pair, np.random.default_rng(seed), least_ratio=0.05)


def lugre(rng):
    force, length, time = 10.0 ** rng.uniform(-6, 6, 3)
    f_s = force * (1 + 10 ** rng.uniform(-2, 0.3))
    sigma, s1 = force / length, force * time / length * 10 ** rng.uniform(-1, 1)
    v_s = length / time * 10 ** rng.uniform(-1, 1)
    s2 = near(rng, s1 * (f_s / force - 1))
    if rng.random() < 0.3:
        s2 = s2 * 0.3
    claim = lugre_passivity(
        coulomb_level=force, static_level=f_s, stiffness=sigma, bristle_damping=s1,
        viscous_damping=s2, stribeck_velocity=v_s,
    )  # fmt: skip

    def resisted(y, x, v, share):
        level = force + (f_s - force) * np.exp(-((v / v_s) ** 2))
        after, work = bristle(y, x, level, sigma)
        work = work + s1 * v * np.sign(x) * (after - y) / sigma + s2 * v * np.abs(x)
        return after, work

    def helped(f, x, v, share):
        return f, 0.0

    # energy once, from what was stored: more than one recoil
    speeds = [v_s * x for x in (1e-3, 0.1, 10, 1e3)]
    ratio = gain(rng, helped, resisted, f_s, [f_s / sigma, 0.1 * f_s / sigma], speeds)
    return claim.status, ratio


@attacked(4, 25)
def test_no_motion_takes_energy_out_of_lugre_friction_that_is_proved_passive(seed, number):
    counted(number, lugre, np.random.default_rng(seed), least_ratio=0.0)


def joint(rng):
    """Motor and link moved from outside; T of each leg from the motor's speed."""
    force, length, time = 10.0 ** rng.uniform(-6, 6, 3)
    f_1, f_2 = force, force * 10 ** rng.uniform(-1, 1)
    f_d = near(rng, f_1)
    sigma, k = (force / length * 10 ** rng.uniform(-1, 1) for _ in range(2))
    m_1, m_2 = (force / length * time**2 * 10 ** rng.uniform(-1, 1) for _ in range(2))
    c = force / length * time * 10 ** rng.uniform(-2, 0)
    claim = any_environment(
        motor_level=f_1, link_level=f_2, transmission_stiffness=k, compensator_level=f_d,
        compensator_stiffness=sigma, motor_inertia=m_1, link_inertia=m_2, transmission_damping=c,
    )  # fmt: skip

    def share(motions):
        """Energy from both hands: what masses and spring store, and what is lost less given."""
        n = len(motions)
        d, x, out, most = np.zeros(n), np.zeros((2, n)), np.zeros(n), np.full(n, -np.inf)
        turned = np.full(n, 1e-300)
        for leg in range(motions.shape[1]):
            travel, speed, other = motions[:, leg].T
            speed = np.abs(speed)
            link = travel * (np.abs(other) % 1.0) * 2
            d, gave = bristle(d, travel, f_d, sigma)
            duration = np.abs(travel) / speed
            lost = f_1 * np.abs(travel) + f_2 * np.abs(link)
            lost = lost + c * (travel - link) ** 2 / np.maximum(duration, 1e-300)
            out = out + gave - lost
            x = x + np.array([travel, link])
            v = np.array([travel, link]) / np.maximum(duration, 1e-300)
            held = m_1 * v[0] ** 2 / 2 + m_2 * v[1] ** 2 / 2 + k * (x[0] - x[1]) ** 2 / 2
            turned = turned + f_d * np.abs(travel)
            most = np.maximum(most, (out - held) / turned)
        return most

    lengths = [f_d / sigma, 30 * f_d / sigma, 1e3 * f_d / sigma]
    start = drawn(rng, MOTIONS, LEGS, lengths, [length / time * 1e-3])
    start[: MOTIONS // 3, :, 2] = 1e-9  # the link is held
    return claim.status, climbed(rng, share, start, rounds=30)[0]


@attacked(4, 30)
def test_no_two_hands_beat_a_compliant_joint_that_is_proved_passive(seed, number):
    counted(number, joint, np.random.default_rng(seed), least_ratio=0.5)


def round_of(points, helped, resisted, rounds=40, pieces=1):
    """Energy given out in the last of many rounds through turning points, J."""
    states, out = [0.0, 0.0], 0.0
    here = points[-1]
    for _ in range(rounds):
        out = 0.0
        for point in points:
            travel = np.array([point - here])
            for part, sign in ((0, 1), (1, -1)):
                states[part], work = (helped, resisted)[part](states[part], travel, 1.0, 0.0)
                out += sign * float(np.squeeze(work))
            here = point
    return out


@attacked(6, 25)
def test_the_cycle_that_refutes_free_motion_gives_out_energy_and_margins_are_not_beaten(
    seed, number
):
    rng = np.random.default_rng(seed)
    counts = Counter()
    for _ in range(number):
        force, length = 10.0 ** rng.uniform(-3, 3, 2)
        f_1, f_2 = force, force * 10 ** rng.uniform(-0.5, 0.5)
        k, sigma = (force / length * 10 ** rng.uniform(-1, 1) for _ in range(2))
        f_d = f_1 * 10 ** rng.uniform(-0.1, 0.3)
        claim = free_motion(
            motor_level=f_1, link_level=f_2, transmission_stiffness=k, compensator_level=f_d,
            compensator_stiffness=sigma, rng=rng, paths=30,
        )  # fmt: skip
        assert claim.status in ("refuted", "evidence")
        counts[claim.status, bool(claim.holds)] += 1
        if claim.status != "refuted":
            continue

        def resisted(f, x, v, share, f_1=f_1, f_2=f_2, k=k):
            after, work, pieces = f, f_1 * abs(float(x[0])), 2000
            for part in np.full(
                pieces, float(x[0]) / pieces
            ):  # a spring that slides, in small steps
                before, after = after, float(np.clip(after + k * part, -f_2, f_2))
                work += (before + after) / 2 * part
            return after, work

        points = claim.record.turning_points
        out = round_of(points, dahl(f_d, f_d, sigma), resisted, rounds=6)
        turned = f_d * sum(
            abs(a - b) for a, b in zip(points, [*points[1:], points[0]], strict=True)
        )
        assert out > -1e-5 * turned, claim  # of 2000 pieces
    print(dict(counts))
    assert counts["refuted", False]


def tremble(record, pieces=1):
    """The trembling motion by its own loop: energy given out, J."""
    helps, friction, period = record.compensator, record.friction, record.sample_time
    p, d, out = 0.0, [0.0] * (record.late + 1), 0.0
    read = 0.0
    for way in (1, -1):
        for _ in range(record.samples):
            command = d[-1 - record.late]
            for stroke in (way * record.forth, -way * record.back):
                p, work = bristle(p, np.array([stroke]), friction.level, friction.stiffness)
                p = float(p[0])
                out += command * stroke - float(work[0])
            out -= record.damping * (record.forth + record.back) ** 2 / period
            net = way * (record.forth - record.back)
            read = float(bristle(read, np.array([net]), helps.level, helps.stiffness)[0][0])
            d.append(read)
    return out


@attacked(4, 25)
def test_the_motion_that_refutes_a_compensator_in_a_computer_gives_out_energy(seed, number):
    rng = np.random.default_rng(seed)
    confirmed = 0
    for _ in range(number):
        force, length, time = 10.0 ** rng.uniform(-3, 3, 3)
        claim = sampled_compensation(
            coulomb_level=force,
            compensator_level=force * 10 ** rng.uniform(-1, 0.5),
            compensator_stiffness=force / length * 10 ** rng.uniform(-1, 1),
            sample_time=time,
            presliding_stiffness=force / length * 10 ** rng.uniform(-1, 1),
            viscous_damping=force / length * time * 10 ** rng.uniform(-4, 0),
            late=int(rng.integers(3)),
        )
        assert claim.status in ("refuted", "unknown")
        if claim.status == "refuted" and claim.record.samples < 3000:
            assert tremble(claim.record) > 0, claim
            confirmed += 1
    print(confirmed)
    assert confirmed >= number / 6


@attacked(4, 25)
def test_closed_forms_of_cycles_are_those_of_motions_that_are_travelled(seed, number):
    rng = np.random.default_rng(seed)
    for _ in range(number):
        f_c, length = 10.0 ** rng.uniform(-3, 3, 2)
        sigma, amplitude = f_c / length, length * 10 ** rng.uniform(-0.3, 1)
        level = largest_passive_level(coulomb_level=f_c, stiffness=sigma, amplitude=amplitude)
        if np.isfinite(level):
            for share, sign in ((0.999, -1), (1.001, 1)):
                compensator_level = level * share
                out = round_of(
                    (amplitude, -amplitude),
                    dahl(compensator_level, compensator_level, sigma),
                    coulomb(f_c, f_c),
                )
                assert sign * out > 0, (f_c, sigma, amplitude)
        f_d = f_c * (1 + 10 ** rng.uniform(-1, 1))
        onset = onset_amplitude(
            coulomb_level=f_c, compensator_level=f_d, compensator_stiffness=sigma
        )
        for share, sign in ((0.99, -1), (1.01, 1)):
            points = (onset * share, -onset * share)
            assert sign * round_of(points, dahl(f_d, f_d, sigma), coulomb(f_c, f_c)) > 0
        # within u bristle lengths no closed path gives, and once no more than the bristle holds
        u = 10 ** rng.uniform(-0.5, 0.5)
        compensator_level = f_c * largest_ratio(u, motion="closed paths")
        most = largest_one_off_energy(level=compensator_level, stiffness=sigma, u=u)

        def inside(motions, compensator_level=compensator_level, sigma=sigma, u=u, f_c=f_c):
            x = np.clip(
                np.cumsum(motions[:, :, 0], axis=1),
                -u * compensator_level / sigma,
                u * compensator_level / sigma,
            )
            travels = np.diff(np.concatenate([np.zeros((len(x), 1)), x], axis=1), axis=1)
            again = np.concatenate([travels[:, :, None], motions[:, :, 1:]], axis=2)
            return largest(
                again, dahl(compensator_level, compensator_level, sigma), coulomb(f_c, f_c)
            )

        ratio = climbed(
            rng, inside, drawn(rng, MOTIONS, LEGS, [compensator_level / sigma]), rounds=15
        )[0]
        assert ratio <= most * (1 + 1e-9), (f_c, sigma, u)
