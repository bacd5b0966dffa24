"""Many random devices: claims, refuting motions and a search in simulation must agree."""

from collections import Counter

import numpy as np
import pytest
from passivity.friction_systems import (
    FrictionSystem,
    confirmed,
    random_system,
    search_motion,
    theory_motion,
    verdict,
)

SEED, SYSTEMS = 20261, 400
#: of them, those that a search in simulation takes on: half a second each
SEARCHED = 150


def one(**changed):
    """A device in plain units: 1 N, bristle 0.1 mm, no Stribeck effect, continuous time."""
    plain = {
        "level": 1.0,
        "extra": 0.0,
        "stribeck_velocity": 0.01,
        "stiffness": 1e4,
        "damping": 0.0,
        "law": "dahl",
        "compensator_level": 0.8,
        "second": 8e3,
        "period": 0.0,
        "late": 0,
        "length": 1e-4,
        "time": 1e-2,
    }
    return FrictionSystem(**plain | changed)


def test_the_family_has_every_part_alone_and_together():
    rng = np.random.default_rng(SEED)
    systems = [random_system(rng) for _ in range(SYSTEMS)]
    parts = {
        (s.law, bool(s.extra), s.stiffness is None, bool(s.damping), bool(s.period))
        for s in systems
    }
    assert len(parts) == 48  # 3 laws, each of four parts there or not
    assert {s.late for s in systems} == {0, 1, 2}
    levels = np.array([s.level for s in systems])
    assert levels.max() / levels.min() > 1e5


@pytest.mark.parametrize(
    ("system", "expected"),
    [
        (one(), "proved"),
        (one(compensator_level=0.5), "refuted"),
        (one(compensator_level=1.1), "refuted"),
        (one(stiffness=None, compensator_level=1.0, period=1e-3, late=2), "proved"),
        (one(period=1e-3), "refuted"),
        (one(period=1e-3, late=1), "refuted"),
        (one(law="coulomb", compensator_level=0.1), "refuted"),
        (one(law="smoothed_coulomb", compensator_level=0.1, second=0.01, damping=10.0), "proved"),
        (one(stiffness=None, extra=0.5, compensator_level=1.2), "refuted"),
    ],
    ids=str,
)
def test_claims_join_to_one_verdict(system, expected):
    assert verdict(system)[0] == expected


@pytest.mark.slow
def test_theorems_refutations_and_search_never_contradict_each_other():
    """No motion where a proof says that there is none; every refuting motion gives out energy."""
    rng, counts, contradictions = np.random.default_rng(SEED), Counter(), []
    for _ in range(SEARCHED):
        system = random_system(rng)
        status, by, record = verdict(system)
        motion = search_motion(system, rng, number=8)
        if status == "proved" and motion is not None:
            contradictions.append((system, by, motion))
        if record is not None:
            assert record.replay() > 0, (system, by)
            if motion is None:
                motion = confirmed(system, theory_motion(system, record))
        counts[status, motion is not None] += 1
    assert not contradictions
    assert counts["proved", False] > SEARCHED / 5
    assert counts["refuted", True] > 0.4 * SEARCHED
    # the search sees what there is to see: where it is silent, that means something. What it misses
    # are motions far slower, or of far more rounds, than a simulation of 30 000 steps holds
    assert counts["refuted", True] > 4 * counts["refuted", False]
