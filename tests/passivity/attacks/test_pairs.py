"""Forces through sums, and friction beside what cancels it, against sums that the attacker solves.

Two bodies, one or two Dahl laws, and sums that share out their forces: to one body as they are, in
part, twice, to both, or round a loop of sums. The attacker writes how much of each force acts on
each body as fractions of its own, and moves both bodies at once along legs that are climbed.
"""

from collections import Counter
from fractions import Fraction

import numpy as np
from devices import body
from passivity.attacks.budget import attacked, climbed, near
from passivity.attacks.friction import bristle, drawn

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import ports
from teleopdesign.passivity.diagram_claims import composed_claim
from teleopdesign.passivity.friction_pairs import friction_pairs
from teleopdesign.passivity.ports import drives_alone, shares_of

#: of what is turned over, that rounding may leave
ROUNDING = 1e-9
MOTIONS, LEGS = 300, 10


def solved(sums, source):
    """Name -> how much of the source is in each sum, by elimination; None: no solution."""
    names = list(sums)
    rows = [
        [Fraction(int(n == m)) - sums[m].get(n, 0) for n in names] + [sums[m].get(source, 0)]
        for m in names
    ]
    for k in range(len(rows)):
        pivot = next((i for i in range(k, len(rows)) if rows[i][k]), None)
        if pivot is None:
            return None
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(len(rows)):
            if i != k and rows[i][k]:
                rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k], strict=True)]
    return {n: row[-1] for n, row in zip(names, rows, strict=True)} | {source: Fraction(1)}


def random_sums(rng, sources, ends):
    """Sums that end at the commands, through up to two others; some feed themselves."""
    inner = [f"s{k}" for k in range(int(rng.integers(0, 3)))]
    sums = {}
    for name in (*inner, *ends):
        others = [*sources, *(n for n in inner if n != name)]
        chosen = rng.choice(others, int(rng.integers(1, min(3, len(others)) + 1)), replace=False)
        sums[name] = {
            str(n): Fraction(str(rng.choice(["1", "1", "1", "1", "-1", "0.5", "2", "0.125"])))
            for n in chosen
        }
    return sums


class Pair:
    """Bodies A and B with friction or without, laws on their motions, sums of random weights."""

    def __init__(self, rng):
        self.levels = [float(10 ** rng.uniform(-1, 1)) * (rng.random() < 0.8) for _ in "AB"]
        self.stiff = [float(level * 10 ** rng.uniform(2, 4)) for level in self.levels]
        self.gives = [bool(level and rng.random() < 0.4) for level in self.levels]
        self.laws = []
        for k in range(int(rng.integers(1, 3))):
            place = int(rng.integers(2))
            level = self.levels[place] or 1.0
            f_d = near(rng, level) if rng.random() < 0.3 else level * float(rng.uniform(0.1, 0.9))
            soft = self.stiff[place] * np.sqrt(f_d / level) if self.gives[place] else f_d * 1e3
            self.laws.append(
                (place, f_d, float(soft * (1 if rng.random() < 0.7 else 0.5)), f"F{k}")
            )
        forces = [name for *_, name in self.laws]
        plain = rng.random() < 0.65  # each force on its own body, through one sum or two
        self.sums = random_sums(rng, forces, ("uA", "uB"))
        if plain:
            by_body = [[n for o, *_, n in self.laws if o == k] for k in range(2)]
            self.sums = {f"u{c}": {n: Fraction(1) for n in by_body[k]} for k, c in enumerate("AB")}
            self.sums = {n: terms for n, terms in self.sums.items() if terms}
        self.loads = [{}, {}]
        if rng.random() < 0.25:
            target = int(rng.integers(2))
            weight = Fraction(str(rng.choice(["1", "-1", "-2", "0.5"])))
            self.loads[target][str(rng.choice(list(self.sums)))] = weight

    def diagram(self):
        blocks = []
        for k, name in enumerate("AB"):
            friction = {"coulomb__level": self.levels[k]} if self.levels[k] else {}
            if self.gives[k]:
                friction["presliding__stiffness"] = self.stiff[k]
            loads = {f"f{name}": 1.0} | {n: float(w) for n, w in self.loads[k].items()}
            made = body(0.3, viscous__damping=1e-9, **friction)
            blocks.append(Moving(name, made, f"x{name}", f"u{name}", loads, f"f{name}"))
        for place, f_d, soft, name in self.laws:
            law = controller("dahl", {"level": f_d, "stiffness": soft})
            x = "x" + "AB"[place]
            blocks.append(Control("C" + name, law, x, name, x))
        sums = tuple(
            Junction(n, {m: float(w) for m, w in terms.items()}) for n, terms in self.sums.items()
        )
        outside = {"fA": "force", "fB": "force"}
        outside |= {u: "force" for u in ("uA", "uB") if u not in self.sums}
        return Diagram("pair", tuple(blocks), sums, outside, ())

    def acts(self, name):
        """How much of that force acts on each body; None: the sums have no solution."""
        share = solved(self.sums, name)
        if share is None:
            return None
        return [
            share.get(f"u{c}", Fraction(0))
            + sum(w * share.get(n, Fraction(0)) for n, w in self.loads[k].items())
            for k, c in enumerate("AB")
        ]

    def gain(self, rng, acting):
        """Most energy given out over what is turned over, along legs of both bodies at once."""

        def share(plans):
            motion = plans.reshape(len(plans), LEGS, 2)
            n = len(motion)
            rubs, helps = np.zeros((2, n)), np.zeros((len(self.laws), n))
            out, most, turned = np.zeros(n), np.full(n, -np.inf), np.full(n, 1e-300)
            for leg in range(LEGS):
                travel = motion[:, leg].T
                for k, level in enumerate(self.levels):
                    if self.gives[k]:
                        rubs[k], took = bristle(rubs[k], travel[k], level, self.stiff[k])
                    else:
                        took = level * np.abs(travel[k])
                    out = out - took
                for i, (place, f_d, soft, _) in enumerate(self.laws):
                    # a body that moves alone first: the force of the law stays while the other does
                    before = helps[i]
                    helps[i], gave = bristle(helps[i], travel[place], f_d, soft)
                    held = before if place else helps[i]
                    for k in range(2):
                        work = gave if k == place else held * travel[k]
                        out = out + float(acting[i][k]) * work
                        turned = turned + f_d * np.abs(travel[k])
                most = np.maximum(most, out)
            return most / turned

        lengths = [f_d / soft for _, f_d, soft, _ in self.laws]
        start = [drawn(rng, MOTIONS, LEGS, lengths)[:, :, 0] for _ in "AB"]
        start[1] *= rng.integers(0, 2, (MOTIONS, 1))
        return climbed(rng, share, np.stack(start, axis=2).reshape(MOTIONS, -1), rounds=25)[0]


def alone(pair, compensated, acting):
    """Whether a force acts on its body just as it is, and on nothing else."""
    return acting[compensated] == 1 and acting[1 - compensated] == 0


@attacked(8, 80)
def test_no_motion_of_two_bodies_beats_friction_that_is_proved_with_its_cancellation(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        pair = Pair(rng)
        acting = [pair.acts(name) for *_, name in pair.laws]
        try:
            diagram = pair.diagram()
            pairs = friction_pairs(diagram)
            claim = composed_claim(diagram, ports(diagram), pairs)
        except ModelError as problem:
            assert None in acting and "no solution" in str(problem), (vars(pair), problem)
            counts["refused"] += 1
            continue
        assert None not in acting, vars(pair)
        moving = {part.name: part for part in diagram.blocks if isinstance(part, Moving)}
        for (place, *_, name), each in zip(pair.laws, acting, strict=True):
            share = solved(pair.sums, name)
            shares = shares_of(diagram, name)
            assert {n: Fraction(str(x)) for n, x in shares.items()} == {
                n: x for n, x in share.items() if x
            }, (vars(pair), shares)
            single = drives_alone(diagram, name, moving["AB"[place]])
            # a force that cancels itself on another body reaches it all the same: nothing is said
            assert alone(pair, place, each) or not single, (vars(pair), each)
        for one in pairs:
            if one.cancellation is not None:
                place, *_ = pair.laws[int(one.cancellation.name[-1])]
                assert alone(pair, place, acting[int(one.cancellation.name[-1])]), vars(pair)
        proved = claim is not None and claim.claim.status == "proved"
        beaten = pair.gain(rng, acting) > ROUNDING
        assert not (proved and beaten), vars(pair)
        counts["proved" if proved else "open", beaten] += 1
    print(dict(counts))
    assert counts["proved", False] >= number / 12 and counts["open", True] >= number / 4


def test_the_attack_beats_a_force_that_pushes_the_other_body():
    pair = object.__new__(Pair)
    pair.levels, pair.stiff, pair.gives = [1.0, 1.0], [1e3, 1e3], [False, False]
    pair.laws = [(0, 0.5, 1e3, "F0")]
    assert pair.gain(np.random.default_rng(1), [[Fraction(1), Fraction(0)]]) <= ROUNDING
    assert pair.gain(np.random.default_rng(1), [[Fraction(1), Fraction(3)]]) > 1e-3
