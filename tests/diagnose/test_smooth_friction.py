"""Friction that begins in proportion to the speed: no Coulomb friction and no damping beside it."""

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.effects import EFFECTS

TAKES = {
    "Eyring": lambda v: 0.6 * np.arcsinh(v / 0.1),
    "power law": lambda v: 1.2 * np.sign(v) * np.abs(v) ** 0.4,
}
AMONG = ("shear_thinning", "quadratic_drag", "bias", "spring", "viscous_asymmetry", "stribeck")


def path(seed):
    rng = np.random.default_rng(seed)
    size, rate, phase = rng.uniform(0.7, 1.3, (3, 4))
    size, rate = size * [0.6, 0.3, 0.2, 0.1], 2 * np.pi * rate * [0.3, 0.7, 1.3, 2.1]
    return lambda t: (size * np.sin(np.multiply.outer(t, rate) + 6 * phase)).sum(-1)


@pytest.mark.slow
@pytest.mark.parametrize("law", TAKES)
def test_a_power_law_has_all_the_force_of_coulomb_friction_and_damping(tmp_path, law):
    """They end at zero beside it. The search refused it: "drives to a bound what is needed"."""
    records = {"fit": [(12.0, path(1))], "check": [(12.0, path(2))]}
    take = TAKES[law]
    write_made(
        tmp_path / "made", records, lambda t, x, v: take(v),
        effects="coulomb = {}\nviscous = {}", step=1e-5, noise=0.05, rate=500,
    )  # fmt: skip
    experiment = load_experiment(tmp_path / "made")
    known = {n: EFFECTS[n] for n in (*AMONG, "coulomb", "viscous")}
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, known))
    assert [r.added.effect.name for r in diagnosis.rungs[1:]][:1] == ["shear_thinning"]
    assert diagnosis.after.check_error < 0.5 * diagnosis.before.check_error
